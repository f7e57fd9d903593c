"""Hulls of a solid above planes, against manifold3d's Booleans."""

import manifold3d
import numpy as np
import pytest

from stepbot.geometry.solids.cut_surfaces import CutSurface, Plane
from stepbot.geometry.solids.manifolds import hull_volume, mesh_arrays


def _plane(normal: tuple[float, float, float], offset: float) -> Plane:
    return Plane(np.array(normal) / np.linalg.norm(normal), offset)


def _hulls(solid: manifold3d.Manifold, planes: list[Plane]) -> tuple[float, float]:
    """Volume of the hull of what is above all planes: by cuts of the surface, and by Booleans."""
    surface = CutSurface.of(*mesh_arrays(solid))
    for plane in planes:
        surface, _ = surface.split(plane)
        x, y, z = plane.normal.tolist()
        solid = solid.trim_by_plane((x, y, z), plane.offset)
    return hull_volume(surface.corners()), float(solid.hull().volume())


def _block() -> manifold3d.Manifold:
    return manifold3d.Manifold.cube((0.2, 0.2, 0.2), True) - manifold3d.Manifold.cylinder(0.3, 0.05, 0.05, 48, True)


@pytest.mark.parametrize("seed", range(8))
def test_oblique_planes(seed: int) -> None:
    """The hull of a block with a bore above one to five planes is that of the exact intersection."""
    random = np.random.default_rng(seed)
    planes = [_plane(tuple(random.normal(size=3)), random.uniform(-0.05, 0.0)) for _ in range(1 + seed % 5)]
    made, exact = _hulls(_block(), planes)
    assert exact > 0.0
    assert made == pytest.approx(exact, rel=1e-9)


def test_region_inside_the_solid() -> None:
    """A region that the surface does not reach is filled: its corners are where three planes meet."""
    directions = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    planes = [_plane(direction, -0.06) for direction in directions]
    made, exact = _hulls(manifold3d.Manifold.cube((0.2, 0.2, 0.2), True), planes)
    assert exact == pytest.approx(0.12**3, rel=1e-9)
    assert made == pytest.approx(exact, rel=1e-9)


def test_planes_of_faces() -> None:
    """A cut at a face leaves no film of the part below it, and keeps the face for later cuts."""
    foot, wall = manifold3d.Manifold.cube((0.05, 0.04, 0.005)), manifold3d.Manifold.cube((0.005, 0.04, 0.04))
    bracket = foot + wall
    for planes, volume in (
        ([_plane((0, 0, 1), 0.005)], 0.005 * 0.04 * 0.035),
        ([_plane((0, 0, -1), -0.005)], 0.05 * 0.04 * 0.005),
        ([_plane((0, 0, 1), 0.0), _plane((-1, 0, 0), -0.004), _plane((0, 1, 0), 0.01)], 0.004 * 0.03 * 0.04),
    ):
        assert _hulls(bracket, planes)[0] == pytest.approx(volume, rel=1e-6)


def test_corner_that_the_solid_touches_from_outside() -> None:
    """A corner of the region that only touches solids in other regions is not one of its points."""
    solid = manifold3d.Manifold.cube((0.1, 0.1, 0.1), False).translate((-0.1, 0.0, 0.0))
    solid += manifold3d.Manifold.cube((0.1, 0.1, 0.1), False).translate((0.0, 0.05, 0.05))
    planes = [_plane((1, 0, 0), 0.0), _plane((0, 1, 0), 0.0), _plane((0, 0, 1), 0.0)]
    assert _hulls(solid, planes)[0] == pytest.approx(1e-3, rel=1e-6)
