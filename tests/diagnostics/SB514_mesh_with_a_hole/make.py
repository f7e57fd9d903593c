"""Two blocks that overlap, one of them with a mesh that is not closed."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mesh import TriMesh
from tests.unit.assemble.test_overlaps import ONE, WATER
from tests.unit.assemble.workshop import Workshop, at, build


def find(found: Diagnostics) -> None:
    """Ask the library."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(5, 0, 0))
    mesh = shop.bodies[0].mesh
    object.__setattr__(shop.bodies[0], "mesh", TriMesh.of(mesh.vertices, mesh.faces[1:]))
    shop.measures[0] = None
    build(shop, Path(), WATER + ONE, found)
