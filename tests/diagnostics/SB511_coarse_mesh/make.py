"""A pin measured on a coarse mesh, as set by the sidecar."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from tests.unit.assemble.test_overlaps import ONE
from tests.unit.assemble.workshop import Workshop, build


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    shop = Workshop()
    shop.rod("pin", sides=24, density=1000)
    build(shop, Path(), "    mass: mesh\n" + ONE, diagnostics)
