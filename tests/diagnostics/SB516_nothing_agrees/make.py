"""A solid on whose volume no two integration methods agree."""

from pathlib import Path

from msgspec.structs import force_setattr

from stepbot.diagnostics import Diagnostics
from tests.unit.assemble.test_overlaps import ONE
from tests.unit.assemble.workshop import Workshop, build


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    shop = Workshop()
    shop.box("a", density=1000)
    force_setattr(shop.bodies[0], "exact_error", 0.4)
    force_setattr(shop.bodies[0], "defect", "its mass properties do not converge")
    build(shop, Path(), ONE, diagnostics)
