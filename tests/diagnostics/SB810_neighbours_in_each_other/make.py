"""A base that carries two blocks, one halfway in the other."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    blocks = [
        (parts.drawn(name, solids.box(40, 10, 10)), x) for name, x in (("base", -100), ("left", 0), ("right", 20))
    ]
    children = [Occurrence(block, f"{block.name}:1", pose((x, 0, 0))) for block, x in blocks]
    parts.write_step(STEP, Assembly("row", children))
