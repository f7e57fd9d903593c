"""A robot renamed after its lock was written."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_locked_lever()
    Path("lever.robot.yaml").write_text(LEVER.replace("robot: lever", "robot: rocker"), encoding="utf-8")
