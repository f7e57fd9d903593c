"""Two files that refer to each other."""

from pathlib import Path

import pytest

from tests.separate_files import Component, write_structure


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_structure(Path("robot.step"), "robot", [Component("arm", "arm.step")])
    write_structure(Path("arm.step"), "arm", [Component("robot", "robot.step")])
