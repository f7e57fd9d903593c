"""A mesh whose triangles face inwards."""

import re
from pathlib import Path

import pytest

from tests import parts

STEP = Path("robot.step")


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    parts.write_tessellated(STEP)
    text = re.sub(r"\n\s*", "", STEP.read_text(encoding="utf-8")).replace(";", ";\n")
    turned = re.sub(r"\((\d+),(\d+),(\d+)\)", r"(\1,\3,\2)", text)
    assert turned != text
    STEP.write_text(turned, encoding="utf-8", newline="\n")
