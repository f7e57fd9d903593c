"""An MJCF that was edited by hand."""

from pathlib import Path

import pytest

from tests.unit.driving.workbench import VERTICAL, one_joint, written

OUT = Path("out")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    written(one_joint(VERTICAL, 100.0, 10.0), OUT)
    path = OUT / "one_joint.xml"
    path.write_text(path.read_text(encoding="utf-8").replace("<position ", "<posision "), encoding="utf-8")
