"""Two overlapping blocks, one of them with an open mesh."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from tests.unit.assemble.test_overlaps import ONE, WATER, overlap_with_an_open_mesh
from tests.unit.assemble.workshop import build


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    build(overlap_with_an_open_mesh(), Path(), WATER + ONE, diagnostics)
