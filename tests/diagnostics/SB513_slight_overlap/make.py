"""Two blocks, one 0.06 mm in the other."""

from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    blocks = [parts.drawn(name, solids.box(40, 10, 10)) for name in ("a", "b")]
    children = [Occurrence(block, f"{block.name}:1", pose((39.94 * i, 0, 0))) for i, block in enumerate(blocks)]
    parts.write_step(STEP, Assembly("row", children))
