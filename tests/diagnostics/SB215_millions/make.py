"""A small file of subassemblies that contain each other ten times, eight levels deep."""

from pathlib import Path

import pytest

from tests.hostile.trees import write_tree

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    write_tree(STEP, 8, 10)
