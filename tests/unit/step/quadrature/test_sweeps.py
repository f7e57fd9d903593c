"""Mass properties of threads, swept splines and offset surfaces built by the kernel, against closed forms."""

from math import cos, hypot, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robot_library.moments import Array
from stepbot.diagnostics import Diagnostics
from stepbot.step.quadrature.solids import Boundary
from stepbot.step.quadrature.splines import is_rational
from stepbot.step.shapes.exact import integrate, volume_properties
from tests.unit.step.in_process import read_here, read_quietly
from tests.unit.step.quadrature.test_solids import Outline, area_moments, assert_same, extruded, prism
from tests.unit.step.shapes.test_bodies import only, write_with_parameter_curves

MAJOR, LEAD, TURNS = 10.0, 4.0, 3
"""Thread: radius of the helix, rise per turn [mm], number of turns."""
TOOTH = ((9.0, -1.0), (11.0, -0.6), (11.0, 0.6), (9.0, 1.0))
"""Trapezoid: distance from the axis and height [mm]."""


def helix() -> Any:
    """The wire of the thread's helix."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepLib import BRepLib
    from OCP.Geom import Geom_CylindricalSurface
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d

    cylinder = Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), MAJOR)
    line = Geom2d_Line(gp_Pnt2d(0, 0), gp_Dir2d(2 * pi, LEAD))
    edge = BRepBuilderAPI_MakeEdge(line, cylinder, 0.0, TURNS * hypot(2 * pi, LEAD)).Edge()
    BRepLib.BuildCurves3d_s(edge)
    return BRepBuilderAPI_MakeWire(edge).Wire()


def swept_about_the_axis(profile: Any) -> Any:
    """The solid swept by a wire in the x-z plane along the helix."""
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipeShell
    from OCP.gp import gp_Dir

    sweep = BRepOffsetAPI_MakePipeShell(helix())
    sweep.SetMode(gp_Dir(0, 0, 1))
    sweep.Add(profile)
    sweep.Build()
    assert sweep.MakeSolid()
    return sweep.Shape()


def thread(points: Array, tangents: Array, weights: Array) -> Array:
    """The ten integrals over such a solid, by Pappus' theorem.

    In coordinates (r, t, h) with x = r cos t, y = r sin t, z = h + c t the element of volume is r dr dh dt.

    Args:
        points: Distance from the axis and height along the outline of the profile (n, 2).
        tangents: Their derivatives (n, 2).
        weights: Quadrature weights along the outline (n,).
    """
    r, h = points.T
    dh = tangents[:, 1] * weights

    def of(i: int, j: int) -> float:
        """Integral of r^i h^j over the profile."""
        return float((r ** (i + 1) * h**j * dh).sum() / (i + 1))

    turn, c = 2 * pi * TURNS, LEAD / (2 * pi)
    along = turn * of(1, 1) + c * turn**2 / 2 * of(1, 0)
    across = turn / 2 * of(3, 0)
    upwards = turn * of(1, 2) + c * turn**2 * of(1, 1) + c**2 * turn**3 / 3 * of(1, 0)
    return np.array([turn * of(1, 0), 0, 0, along, across, 0, 0, across, -c * turn * of(2, 0), upwards])


def trapezoid() -> tuple[Array, Array, Array]:
    """Gauss points, tangents and weights along the outline of :data:`TOOTH`."""
    corners = np.array(TOOTH)
    way = np.roll(corners, -1, axis=0) - corners
    x, w = np.polynomial.legendre.leggauss(6)
    points = corners[:, None] + 0.5 * (x[:, None] + 1) * way[:, None]
    return points.reshape(-1, 2), np.repeat(way, len(x), axis=0), np.tile(0.5 * w, len(corners))


def shifted(integrals: Array, height: float) -> Array:
    """The ten integrals with respect to a point on the z axis."""
    volume, x, y, z, xx, xy, xz, yy, yz, zz = integrals
    return np.array(
        [
            *(volume, x, y, z - height * volume, xx, xy, xz - height * x, yy, yz - height * y),
            zz - 2 * height * z + height**2 * volume,
        ]
    )


def test_weights_make_a_spline_rational() -> None:
    """Homogeneous poles (w x, w y, w): a quarter of a circle, and a parabola, also where coordinates or all are one."""
    parabola, half = np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), np.sqrt(0.5)
    circle = np.array([[1.0, 1.0, 1.0], [half, 1.0, half], [0.0, 1.0, 1.0]])
    assert [is_rational(poles) for poles in (parabola, 0.5 * parabola, circle)] == [False, True, True]
    assert not is_rational(np.array([[0.0, 2.0, 1.0], [1.0, 3.0, 1.0]]))


def test_a_thread(tmp_path: Path) -> None:
    """A trapezoidal thread of three turns, read from STEP; the kernel's sweep itself is 1e-6 off the helix."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakePolygon
    from OCP.gp import gp_Pnt

    corners = [gp_Pnt(x, 0, z) for x, z in TOOTH]
    shape = swept_about_the_axis(BRepBuilderAPI_MakePolygon(*corners, True).Wire())
    expected = thread(*trapezoid())
    assert_same(Boundary(shape, np.array([0.0, 0.0, 6.0])).integrals(1), shifted(expected, 6.0), 3e-6)
    diagnostics = Diagnostics()
    assembly = read_here(write_with_parameter_curves(tmp_path / "thread.step", shape), diagnostics)
    assert assembly is not None
    body = only(assembly)
    assert_same(body.exact, expected, 3e-6)
    assert body.exact_error < 1e-3


def test_a_splined_thread() -> None:
    """A closed spline swept along the helix: a knurled round thread."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Vec

    outline = Outline(12, lambda t: 1.0 + 0.1 * cos(3 * t))
    points, tangents, weights = outline.nodes()
    curve = outline.curve.Rotated(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), pi / 2)  # y becomes z
    curve = curve.Translated(gp_Vec(MAJOR, 0, 0))
    shape = swept_about_the_axis(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(curve).Edge()).Wire())
    expected = thread(points + np.array([MAJOR, 0.0]), tangents, weights)
    assert_same(Boundary(shape, np.array([0.0, 0.0, 6.0])).integrals(1), shifted(expected, 6.0), 3e-6)


def test_a_rod_along_a_spline() -> None:
    """A round rod along a plane spline; the volume element is 1 - curvature * distance across the bend."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipe
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec

    spine, radius = Outline(16, lambda t: 40 + 4 * cos(3 * t)).curve, 3.0
    last = 0.4 * spine.LastParameter()
    point, first, second = gp_Pnt(), gp_Vec(), gp_Vec()
    spine.D1(0.0, point, first)
    circle = BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(point, gp_Dir(first)), radius)).Edge()
    disc = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(circle).Wire()).Face()
    path = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(spine, 0.0, last).Edge()).Wire()
    shape = BRepOffsetAPI_MakePipe(path, disc).Shape()

    knots = np.array([k for k in spine.Knots() if k < last] + [last])
    x, w = np.polynomial.legendre.leggauss(12)
    t = (knots[:-1, None] + 0.5 * (x + 1) * np.diff(knots)[:, None]).reshape(-1)
    area, quarter = pi * radius**2, pi * radius**4 / 4
    expected = np.zeros(10)
    for parameter, weight in zip(t, (0.5 * w * np.diff(knots)[:, None]).reshape(-1), strict=True):
        spine.D2(parameter, point, first, second)
        c, d, dd = (np.array([v.X(), v.Y(), v.Z()]) for v in (point, first, second))
        speed = float(np.linalg.norm(d))
        n = np.cross([0.0, 0.0, 1.0], d / speed)
        curvature = float(n @ dd) / speed**2
        # The section's integrals of 1, a, a^2, b^2 times (1 - curvature a), a along n and b along z.
        com = area * c - curvature * quarter * n
        products = area * np.outer(c, c) + quarter * (np.outer(n, n) + np.diag([0.0, 0.0, 1.0]))
        products -= curvature * quarter * (np.outer(c, n) + np.outer(n, c))
        expected += weight * speed * np.array([area, *com, *products[np.triu_indices(3)]])
    origin = np.zeros(3)
    assert_same(Boundary(shape, origin).integrals(1), expected, 1e-5)
    assert_same(Boundary(shape, origin).integrals(2), expected, 1e-5)


def parallel(outline: Outline, distance: float) -> tuple[Array, Array, Array]:
    """Points, tangents and weights of a curve at a distance outside an outline."""
    from OCP.gp import gp_Pnt, gp_Vec

    knots = np.array(list(outline.curve.Knots()))
    x, w = np.polynomial.legendre.leggauss(12)
    t = (knots[:-1, None] + 0.5 * (x + 1) * np.diff(knots)[:, None]).reshape(-1)
    at, first, second = gp_Pnt(), gp_Vec(), gp_Vec()
    points, tangents = [], []
    for parameter in t.tolist():
        outline.curve.D2(parameter, at, first, second)
        speed = hypot(first.X(), first.Y())
        curvature = (first.X() * second.Y() - first.Y() * second.X()) / speed**3
        points.append((at.X() + distance * first.Y() / speed, at.Y() - distance * first.X() / speed))
        tangents.append([(1 + distance * curvature) * each for each in (first.X(), first.Y())])
    return np.array(points), np.array(tangents), (0.5 * w * np.diff(knots)[:, None]).reshape(-1)


def test_offset_surfaces(tmp_path: Path) -> None:
    """The wall of a splined prism offset outwards, read from STEP, is an offset surface."""
    from OCP.BRepOffset import BRepOffset_Mode
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
    from OCP.GeomAbs import GeomAbs_JoinType

    outline, distance, height = Outline(20, lambda t: 30 + 2 * cos(3 * t)), 2.0, 20.0
    offset = BRepOffsetAPI_MakeOffsetShape()
    skin, sharp = BRepOffset_Mode.BRepOffset_Skin, GeomAbs_JoinType.GeomAbs_Intersection
    offset.PerformByJoin(extruded(outline.face(), height), distance, 1e-4, skin, False, False, sharp)
    curve = parallel(outline, distance)
    expected = prism(area_moments(*curve), height + 2 * distance)
    middle = np.array([0.0, 0.0, height / 2])
    found = Boundary(offset.Shape(), middle).integrals(1)
    assert_same(found, shifted(expected, height / 2 + distance), 1e-6)
    step = write_with_parameter_curves(tmp_path / "offset.step", offset.Shape())
    assert "OFFSET_SURFACE" in step.read_text()
    body = only(read_quietly(step))
    assert body.exact is not None
    assert body.exact.volume * 1e9 == pytest.approx(expected[0], rel=1e-7)
    assert body.exact_error < 1e-3
    plain = volume_properties(integrate(offset.Shape()))
    assert plain is not None
    assert abs(plain.volume * 1e9 / expected[0] - 1) > 1e-4, "what the kernel alone says"
