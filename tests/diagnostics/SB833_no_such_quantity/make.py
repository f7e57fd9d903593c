"""A misspelt quantity."""

from pathlib import Path

import pytest

from tests.unit.driving.workbench import VERTICAL, one_joint, written

OUT = Path("out")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    written(one_joint(VERTICAL, 100.0, 10.0), OUT)
    Path("limits.json").write_text('{"drive": {"limits": {"step": {"overshot": [20, "soft"]}}}}', encoding="utf-8")
