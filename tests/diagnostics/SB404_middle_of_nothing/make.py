"""An assembly with an empty subassembly."""

from pathlib import Path

import pytest

from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    block = parts.drawn("block", solids.box(10, 20, 30))
    children = [Occurrence(block, "block:1"), Occurrence(Assembly("nothing", []), "nothing:1")]
    parts.write_step(STEP, Assembly("root", children))
