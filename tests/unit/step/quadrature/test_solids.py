"""Mass properties of splined solids, against planar integrals without faces, trimming or kernel."""

from collections.abc import Callable
from math import cos, inf, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robot_library.moments import Array
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import Body, BodyKind
from stepbot.step.kernel import faces_of
from stepbot.step.quadrature.solids import Boundary, properties_of
from stepbot.step.shapes.error_estimate import estimated, is_simple
from stepbot.step.shapes.exact import integrate, volume_properties
from stepbot.step.shapes.tessellation import Fineness, tessellated
from tests import solids
from tests.unit.step.in_process import read_quietly
from tests.unit.step.shapes.test_bodies import as_nurbs, edges_of, only, write, write_with_parameter_curves

Closed = Callable[[Array], tuple[Array, Array]]
"""Points and tangents, each (n, 2), of a closed curve at parameters (n,)."""


class Outline:
    """A closed cubic spline through points of r(t) in the plane z = 0, with its integrals in the plane."""

    def __init__(self, count: int, radius: Callable[[float], float]) -> None:
        from OCP.collections import HArray1_gp_Pnt
        from OCP.GeomAPI import GeomAPI_Interpolate
        from OCP.gp import gp_Pnt

        points = HArray1_gp_Pnt(1, count)
        for i in range(count):
            t = 2 * pi * i / count
            points.SetValue(i + 1, gp_Pnt(radius(t) * cos(t), radius(t) * sin(t), 0.0))
        fit = GeomAPI_Interpolate(points, True, 1e-9)
        fit.Perform()
        self.curve = fit.Curve()

    def nodes(self) -> tuple[Array, Array, Array]:
        """Gauss points (n, 2), tangents (n, 2) and weights (n,) on every span, read from the kernel one by one."""
        from OCP.gp import gp_Pnt, gp_Vec

        knots = np.array(list(self.curve.Knots()))
        x, w = np.polynomial.legendre.leggauss(12)
        t = (knots[:-1, None] + 0.5 * (x + 1) * np.diff(knots)[:, None]).reshape(-1)
        weights = (0.5 * w * np.diff(knots)[:, None]).reshape(-1)
        at, tangent = gp_Pnt(), gp_Vec()
        rows = []
        for parameter in t.tolist():
            self.curve.D1(parameter, at, tangent)
            rows.append((at.X(), at.Y(), tangent.X(), tangent.Y()))
        table = np.array(rows)
        return table[:, :2], table[:, 2:], weights

    def face(self, *holes: float) -> Any:
        """The face bounded by the outline, without scaled copies of it as holes."""
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
        from OCP.gp import gp_Pnt
        from OCP.TopoDS import TopoDS

        make = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(self.curve).Edge()).Wire(), True)
        for scale in holes:
            inner = self.curve.Scaled(gp_Pnt(0, 0, 0), scale)
            wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(inner).Edge()).Wire()
            make.Add(TopoDS.Wire(wire.Reversed()))
        return make.Face()


def area_moments(points: Array, tangents: Array, weights: Array) -> dict[tuple[int, int], float]:
    """Integrals of x^i y^j, i + j up to 2, over the region of a closed curve, by Green's theorem."""
    (x, y), dy = points.T, tangents[:, 1] * weights
    return {(i, j): float((x ** (i + 1) * y**j * dy).sum() / (i + 1)) for i in range(3) for j in range(3 - i)}


def prism(area: dict[tuple[int, int], float], height: float) -> Array:
    """The ten integrals (1, x, y, z, xx, xy, xz, yy, yz, zz) over a prism on z = 0."""
    h = height
    a = area
    first = (a[1, 0] * h, a[0, 1] * h, a[0, 0] * h**2 / 2)
    second = (a[2, 0] * h, a[1, 1] * h, a[1, 0] * h**2 / 2, a[0, 2] * h, a[0, 1] * h**2 / 2, a[0, 0] * h**3 / 3)
    return np.array([a[0, 0] * h, *first, *second])


def extruded(face: Any, height: float) -> Any:
    """A prism."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec

    return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, height)).Shape()


def assert_same(found: Array | VolumeProperties | None, expected: Array, tolerance: float) -> None:
    """Assert that volume, centre and inertia are as expected."""
    if isinstance(found, np.ndarray):
        found = properties_of(found, np.zeros(3))
    right = properties_of(expected, np.zeros(3))
    assert found is not None
    assert right is not None
    assert found.deviation_from(right)[0] < tolerance


def waves(t: float) -> float:
    """Nine waves and twenty-three."""
    return 40 + 6 * cos(9 * t) + 3 * sin(23 * t)


def test_a_plate_with_a_wavy_outline(tmp_path: Path) -> None:
    """A plate whose outline has 200 spans, which the kernel's integration misses by a tenth, read from a STEP file."""
    outline = Outline(200, waves)
    shape = extruded(outline.face(), 30.0)
    expected = prism(area_moments(*outline.nodes()), 30.0)
    plain = volume_properties(integrate(shape))
    assert plain is not None
    assert abs(plain.volume * 1e9 / expected[0] - 1) > 0.05
    assert_same(Boundary(shape, np.zeros(3)).integrals(1), expected, 1e-8)
    assert_same(Boundary(shape, np.zeros(3)).integrals(2), expected, 1e-10)


@pytest.mark.slow
def test_a_splined_solid_in_a_file(tmp_path: Path) -> None:
    """A smaller plate, read from a STEP file, is right to 1e-8, and its estimated error is below 1e-3."""
    outline = Outline(40, lambda t: 40 + 6 * cos(5 * t) + 2 * sin(9 * t))
    expected = prism(area_moments(*outline.nodes()), 30.0)
    body = only(read_quietly(write_with_parameter_curves(tmp_path / "plate.step", extruded(outline.face(), 30.0))))
    assert_same(body.exact, expected, 1e-8)
    assert 0.0 < body.exact_error < 1e-3


def test_a_thin_shell() -> None:
    """A wall of 1 % of its radius between two splines."""
    outline = Outline(60, lambda t: 50 + 3 * cos(4 * t))
    points, tangents, weights = outline.nodes()
    expected = prism(area_moments(points, tangents, weights), 80.0)
    expected = expected - prism(area_moments(0.99 * points, 0.99 * tangents, weights), 80.0)
    shape = extruded(outline.face(0.99), 80.0)
    assert_same(Boundary(shape, np.zeros(3)).integrals(2), expected, 1e-8)


def test_a_loft() -> None:
    """A ruled solid between two splined sections: every cross-section is a blend of the two."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.gp import gp_Pnt, gp_Vec

    outline, height = Outline(30, lambda t: 30 + 4 * cos(5 * t)), 25.0
    loft = BRepOffsetAPI_ThruSections(True, True)
    upper = outline.curve.Scaled(gp_Pnt(0, 0, 0), 0.5).Translated(gp_Vec(7.0, -3.0, height))
    for curve in (outline.curve, upper):
        loft.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(curve).Edge()).Wire())
    loft.Build()
    points, tangents, weights = outline.nodes()
    expected = np.zeros(10)
    nodes, shares = np.polynomial.legendre.leggauss(8)
    for v, share in zip(0.5 * (nodes + 1), 0.5 * shares, strict=True):
        scale, z = 1 - 0.5 * v, v * height
        a = area_moments(scale * points + v * np.array([7.0, -3.0]), scale * tangents, weights)
        flat = [a[0, 0], a[1, 0], a[0, 1], z * a[0, 0], a[2, 0], a[1, 1], z * a[1, 0], a[0, 2], z * a[0, 1]]
        expected += share * height * np.array([*flat, z * z * a[0, 0]])
    assert_same(Boundary(loft.Shape(), np.zeros(3)).integrals(2), expected, 1e-8)


def test_a_revolved_spline() -> None:
    """A wavy ring: a splined section revolved about an axis beside it."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    outline = Outline(40, lambda t: 10 + cos(6 * t))
    shape = BRepPrimAPI_MakeRevol(outline.face(), gp_Ax1(gp_Pnt(30, 0, 0), gp_Dir(0, 1, 0))).Shape()
    points, tangents, weights = outline.nodes()
    radius, y = 30 - points[:, 0], points[:, 1]
    dy = 2 * pi * tangents[:, 1] * weights

    def ring(i: int, j: int) -> float:
        """Integral of radius^i y^j over the solid, with the volume element 2 pi radius."""
        return float(-(radius ** (i + 2) * y**j * dy).sum() / (i + 2))

    volume, along = ring(0, 0), ring(0, 1)
    across = 0.5 * ring(2, 0)
    expected = np.array([volume, 0, along, 0, across, 0, 0, ring(0, 2), 0, across])
    found = properties_of(Boundary(shape, np.array([30.0, 0, 0])).integrals(2), np.zeros(3))  # with respect to the axis
    assert_same(found, expected, 1e-9)


@pytest.mark.parametrize(
    "solid",
    [
        solids.cylinder(3, 10).at(5, 7, 11),
        solids.cone(5, 2, 8),
        solids.sphere(3).at(5, 7, 11),
        solids.box(40, 30, 12) - solids.cylinder(5, 12).at(8, 3, -6),
    ],
    ids=["cylinder", "cone", "sphere", "bored plate"],
)
@pytest.mark.parametrize("rational", [False, True], ids=["quadrics", "rational"])
def test_closed_forms(solid: solids.Solid, rational: bool) -> None:
    """Quadrics are exact to rounding, and so are their rational B-splines."""
    shape = as_nurbs(solid.shape) if rational else solid.shape
    found = properties_of(Boundary(shape, np.array([1.0, 2.0, 3.0])).integrals(2), np.array([1.0, 2.0, 3.0]))
    expected = solid.moments.in_metres()
    assert found is not None
    right = VolumeProperties.of(expected.mass, np.array(expected.com), np.array(expected.inertia))
    assert found.deviation_from(right)[0] < 1e-9
    assert is_simple(shape) is not rational


def test_what_nothing_confirms_is_uncertain(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel's result that neither stepbot's integration nor meshes confirm has no small error."""
    shape = as_nurbs(solids.cylinder(3, 10).shape)
    right = properties_of(Boundary(shape, np.zeros(3)).integrals(2), np.zeros(3))
    assert right is not None
    wrong = VolumeProperties.of(
        1.2 * right.volume, np.array(right.unit_density.com), np.array(right.unit_density.inertia)
    )
    mesh = tessellated(shape, Fineness(0.01, 0.2))
    confirmed = estimated(shape, wrong, mesh, is_closed=True)
    assert confirmed.properties.volume == pytest.approx(right.volume, rel=1e-6)
    assert confirmed.error < 1e-3
    adaptive = estimated(shape, wrong, mesh, is_closed=False)
    assert adaptive.properties.volume == pytest.approx(right.volume, rel=1e-6)
    assert adaptive.error < 1e-3
    monkeypatch.setattr("stepbot.step.shapes.error_estimate.adaptive_volume", lambda *_: (right.volume, 2e-3))
    alone = estimated(shape, wrong, mesh, is_closed=False)
    assert alone.error > 0.1
    assert [name for name, _ in alone.opinions] == ["stepbot", "the kernel", "adaptive integration"]


def scaled(properties: VolumeProperties, factor: float) -> VolumeProperties:
    """The integrals scaled by a factor."""
    unit = properties.unit_density
    return VolumeProperties.of(factor * properties.volume, np.array(unit.com), factor * np.array(unit.inertia))


def test_the_larger_difference_is_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to 1e-3 off the kernel, stepbot's integral is used once converged to 1e-5; otherwise meshes decide."""
    shape = as_nurbs(solids.cylinder(3, 10).shape)
    right = properties_of(Boundary(shape, np.zeros(3)).integrals(2), np.zeros(3))
    assert right is not None
    mesh = tessellated(shape, Fineness(0.01, 0.2))
    converged = estimated(shape, scaled(right, 1 + 2e-4), mesh, is_closed=False)
    assert converged.properties.volume == pytest.approx(right.volume, rel=1e-8)
    assert converged.error == pytest.approx(2e-4, rel=1e-2)

    def claiming(factor: float, error: float) -> None:
        """Integrals scaled by a factor, with an error."""
        monkeypatch.setattr(Boundary, "integrals", lambda self, parts: factor * integrals(self, parts))
        monkeypatch.setattr(Boundary, "converged", lambda self, _: (self.integrals(1), error))

    integrals = Boundary.integrals
    claiming(1.0 + 2e-4, 3e-4)
    alone = estimated(shape, right, mesh, is_closed=False)
    assert alone.error == pytest.approx(3e-4, rel=1e-2), "further off than from the kernel"
    assert alone.opinions, "nothing was decided by two ways alone"
    claiming(1.04, 1e-2)
    by_meshes = estimated(shape, right, mesh, is_closed=True)
    assert by_meshes.properties == right, "the one that meshes tend to"
    assert estimated(shape, right, mesh, is_closed=False).error > 1e-3, "neither converges"
    claiming(0.0, 0.0)
    assert estimated(shape, right, mesh, is_closed=False).error == inf, "integrals without a volume confirm nothing"


def test_what_agrees_with_the_kernel_is_integrated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Integration that converges takes several times as long, and is not needed."""
    shape = as_nurbs(solids.cylinder(3, 10).shape)
    right = properties_of(Boundary(shape, np.zeros(3)).integrals(2), np.zeros(3))
    assert right is not None
    monkeypatch.setattr(Boundary, "converged", lambda *_: pytest.fail("integrated again"))
    assert estimated(shape, right, tessellated(shape, Fineness(0.01, 0.2)), is_closed=False).error < 1e-5


@pytest.mark.parametrize("gap", [0.0, 1e-7, 1e-5, 1e-3])
def test_an_open_boundary_is_an_error_and_costs_no_time(gap: float) -> None:
    """Where the boundary of a face does not close, smaller pieces change nothing, and the claimed error covers it."""
    shape = opened(as_nurbs(solids.cylinder(3, 10).shape), gap)
    expected = np.pi * 9 * 10
    boundary = Boundary(shape, np.array([0.5, 0.3, 6.0]))
    plain, halved, most = (boundary.integrals(parts) for parts in (1, 2, 8))
    assert most == pytest.approx(halved, rel=1e-9, abs=1e-9)
    assert plain == pytest.approx(halved, rel=1e-6, abs=1e-6)
    moments, error = boundary.converged(1e-6)
    assert abs(moments[0] / expected - 1.0) <= max(2.0 * error, 1e-9)
    assert error < 1e-6 + 20.0 * gap


def opened(shape: Any, gap: float) -> Any:
    """A shape in which an edge of its curved face is shorter by a share, in the face's parameters alone."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS

    face = next(f for f in faces_of(shape) if any(BRep_Tool.IsClosed_s(e, f) for e in edges_of(f)))
    face = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    edge = next(e for e in edges_of(face) if not BRep_Tool.IsClosed_s(e, face))
    first, last = BRep_Tool.Range_s(edge, face)
    BRep_Builder().Range(edge, face, first, last * (1.0 - gap) + first * gap)
    return shape


def test_what_meshes_cannot_confirm_adaptive_integration_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plate with a wavy outline, which the kernel's plain integration misses by a tenth, and no further mesh."""
    outline = Outline(60, lambda t: 40 + 2 * cos(15 * t))
    shape = extruded(outline.face(), 30.0)
    expected = prism(area_moments(*outline.nodes()), 30.0)
    plain = volume_properties(integrate(shape))
    assert plain is not None
    wrong = scaled(plain, 0.9)
    mesh = tessellated(shape, Fineness(4.0, 1.5))
    monkeypatch.setattr("stepbot.step.shapes.error_estimate._MOST_TRIANGLES", 0)
    estimate = estimated(shape, wrong, mesh, is_closed=True)
    assert estimate.error < 1e-3
    assert estimate.properties.volume * 1e9 == pytest.approx(expected[0], rel=1e-8)
    monkeypatch.setattr("stepbot.step.shapes.error_estimate.adaptive_volume", lambda *_: (1.1 * plain.volume, 1e-6))
    doubtful = estimated(shape, wrong, mesh, is_closed=True)
    assert doubtful.error > 1e-3, "it contradicts"
    assert [name for name, _ in doubtful.opinions][-1] == "adaptive integration"


def test_simple_solids_keep_the_kernels_numbers(tmp_path: Path) -> None:
    """Solids of planes and quadrics have the kernel's numbers, bit for bit."""
    solid = solids.box(40, 30, 12) - solids.cylinder(5, 12).at(8, 3, -6)
    body: Body = only(read_quietly(write(tmp_path / "plate.step", solid.shape)))
    assert body.kind is BodyKind.SOLID
    assert body.exact_error == 1e-9
