"""A row of different parts, all of the CAD program's default steel."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    blocks = [parts.drawn(f"part {i}", solids.box(10, 10, 10 * i), density=7850.0) for i in (1, 2)]
    children = [Occurrence(block, f"{block.name}:1", pose((20 * i, 0, 0))) for i, block in enumerate(blocks)]
    parts.write_step(STEP, Assembly("row", children))
