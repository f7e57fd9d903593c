"""One body: tolerance, size, refinement, accuracy, axes; on shapes with closed forms."""

from collections.abc import Callable
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from robot_library.moments import pose, turn
from robot_library.step_file import Part, moved, write_step
from stepbot.step.assembly import Assembly, AxisFace, Body, BodyKind, MeshTolerance, ReadOptions
from stepbot.step.shapes import exact, tessellation
from tests import parts, solids
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here, read_quietly


def write(path: Path, shape: Any) -> Path:
    """A file with one part of this shape."""
    write_step(path, Part("part", shape))
    return path


def write_with_parameter_curves(path: Path, shape: Any) -> Path:
    """The same as the kernel writes it by default, with parameter curves of edges on their faces."""
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    assert Interface_Static.IVal_s("write.surfacecurve.mode") == 1
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    return path


def only(assembly: Assembly | None) -> Body:
    """The one body of an assembly."""
    assert assembly is not None
    (body,) = assembly.bodies
    return body


def as_nurbs(shape: Any) -> Any:
    """The same shape with all its surfaces as rational B-splines."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

    return BRepBuilderAPI_NurbsConvert(shape, True).Shape()


# Tolerance


@pytest.mark.parametrize("relative", [0.02, 0.002, 0.0002])
def test_the_mesh_follows_the_solid(relative: float, tmp_path: Path) -> None:
    """No facet of a ball deviates by more than the tolerance, a share of the ball's diagonal."""
    path = parts.write_sphere(tmp_path / "ball.step", radius=30).path
    body = only(read_quietly(path, ReadOptions(tolerance=MeshTolerance(relative, angle=pi))))
    middles = body.mesh.vertices[body.mesh.faces].mean(axis=1)
    diagonal = 0.06 * sqrt(3)
    # The mesher keeps the deviation along edges, and nearly so inside faces.
    assert 0.03 - np.linalg.norm(middles, axis=1).min() < 1.25 * relative * diagonal


def test_an_absolute_tolerance_is_a_length(tmp_path: Path) -> None:
    """A tolerance in metres is independent of the size."""
    for radius in (3.0, 300.0):
        path = parts.write_cylinder(tmp_path / f"{radius}.step", radius=radius).path
        body = only(read_quietly(path, ReadOptions(tolerance=MeshTolerance(absolute=1e-5, angle=pi))))
        on_circle = body.mesh.vertices[np.isclose(body.mesh.vertices[:, 2], 0.0)]
        angles = np.sort(np.arctan2(on_circle[:, 1], on_circle[:, 0]))
        sagitta = radius / 1000 * (1 - np.cos(np.diff(angles).max() / 2))
        assert 1e-6 < sagitta <= 1e-5


def test_the_angle_bounds_the_facets(tmp_path: Path) -> None:
    """A circle has at least as many segments as the angle requires."""
    path = parts.write_cylinder(tmp_path / "pin.step").path
    body = only(read_quietly(path, ReadOptions(tolerance=MeshTolerance(relative=0.02, angle=pi / 24))))
    on_circle = np.isclose(np.hypot(*body.mesh.vertices[:, :2].T), 0.02) & np.isclose(body.mesh.vertices[:, 2], 0.0)
    assert np.count_nonzero(on_circle) >= 48


def test_the_finest_claim_on_a_body_holds(tmp_path: Path) -> None:
    """The finest tolerance of all occurrences applies to a body; other parts stay coarse."""
    path = parts.write_nested(tmp_path / "nested.step").path
    coarse = MeshTolerance(0.05, angle=1.0)
    plain = read_quietly(path, ReadOptions(tolerance=coarse))
    claims = (("slide:1/bolt", MeshTolerance(0.0005, angle=0.1)),)
    fine = read_quietly(path, ReadOptions(tolerance=coarse, tolerance_of=claims))
    bolt = next(c.body for c in fine.components if c.product == "bolt")
    for number, (before, after) in enumerate(zip(plain.bodies, fine.bodies, strict=True)):
        assert (len(after.mesh.faces) > len(before.mesh.faces)) == (number == bolt)


@pytest.mark.slow
def test_a_mesh_that_grows_too_large_is_coarsened(
    tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The number of faces is limited, with a warning about the tolerance."""
    monkeypatch.setattr(tessellation, "MAX_FACES", 2000)
    path = parts.write_sphere(tmp_path / "ball.step").path
    body = only(read_here(path, diagnostics, ReadOptions(tolerance=MeshTolerance(1e-5, angle=0.02))))
    assert 500 < len(body.mesh.faces) <= 2000
    assert body.watertight
    assert diagnostics.codes() == ["SB603"]


# Mass


@pytest.mark.slow
def test_measuring_meshes_are_refined(tmp_path: Path) -> None:
    """Volume and inertia of a ball by its measuring mesh agree with the closed form to the requested deviation."""
    drawing = parts.write_sphere(tmp_path / "ball.step", radius=30)
    body = only(read_quietly(drawing.path, ReadOptions(refine_mass_to=1e-4)))
    assert body.refined is not None
    assert body.refined.volume == pytest.approx(drawing.body.mass, rel=1e-4, abs=0)
    assert np.array(body.refined.unit_density.inertia) == pytest.approx(
        np.array(drawing.body.inertia), rel=1e-3, abs=1e-12
    )
    assert len(body.mesh.faces) < 5000


def test_refinement_has_a_bound(tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the limit of faces is reached first, the best measurement is kept, with a warning about the deviation."""
    monkeypatch.setattr(exact, "MAX_MEASURING_FACES", 5000)
    drawing = parts.write_sphere(tmp_path / "ball.step")
    body = only(read_here(drawing.path, diagnostics, ReadOptions(refine_mass_to=1e-6)))
    assert body.refined is not None
    assert 1e-6 < abs(body.refined.volume / drawing.body.mass - 1) < 1e-2
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB511"
    assert "e-0" in diagnostic.message


@pytest.mark.parametrize(
    ("writer", "volume_tolerance", "com_tolerance"),
    # Without parameter curves in the file, the kernel fits them to 1e-7 m.
    [(write_with_parameter_curves, 1e-6, 1e-8), (write, 3e-6, 1e-7)],
    ids=["with parameter curves", "without"],
)
@pytest.mark.parametrize(
    "solid",
    [solids.cylinder(3, 10).at(5, 7, 11), solids.sphere(3).at(5, 7, 11), solids.cone(5, 2, 8)],
    ids=["cylinder", "sphere", "cone"],
)
def test_rational_surfaces_are_integrated_well(
    solid: solids.Solid,
    writer: Callable[[Path, Any], Path],
    volume_tolerance: float,
    com_tolerance: float,
    tmp_path: Path,
) -> None:
    """Rational B-splines, on which the kernel's plain integration is 1 % off, are integrated accurately."""
    exact = only(read_quietly(writer(tmp_path / "nurbs.step", as_nurbs(solid.shape)))).exact
    assert exact is not None
    expected = solid.moments.in_metres()
    assert exact.volume == pytest.approx(expected.mass, rel=volume_tolerance, abs=0)
    assert exact.unit_density.com == pytest.approx(expected.com, abs=com_tolerance)
    inertia = np.array(expected.inertia)
    assert np.abs(np.array(exact.unit_density.inertia) - inertia).max() < 1e-4 * np.abs(inertia).max()


def test_a_solid_inside_out_is_turned_round(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A solid whose faces point inwards is reversed: positive volume, outward mesh."""
    drawing = parts.write_bored_plate(tmp_path / "plate.step")
    text = drawing.path.read_text(encoding="utf-8")
    turned = text.replace(",.T.);", ",.?.);").replace(",.F.);", ",.T.);").replace(",.?.);", ",.F.);")
    only_faces = "".join(
        new if "ADVANCED_FACE" in old else old
        for old, new in zip(text.splitlines(keepends=True), turned.splitlines(keepends=True), strict=True)
    )
    assert only_faces != text
    drawing.path.write_text(only_faces, encoding="utf-8", newline="\n")
    body = only(read_here(drawing.path, diagnostics))
    list(diagnostics)
    assert body.watertight
    assert body.exact is not None
    assert body.exact.volume == pytest.approx(drawing.body.mass, rel=1e-9, abs=0)
    assert all(face.bore for face in body.axis_faces)


# Kinds


def test_a_closed_shell_is_no_solid(tmp_path: Path) -> None:
    """A closed box of faces without a solid is a surface: the file does not declare it as solid."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    shell = TopExp_Explorer(solids.box(1, 2, 3).shape, TopAbs_ShapeEnum.TopAbs_SHELL).Current()
    body = only(read_quietly(write(tmp_path / "shell.step", shell)))
    assert (body.kind, body.exact) == (BodyKind.SURFACE, None)
    assert body.watertight


def edge() -> Any:
    """A straight line."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Pnt

    return BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)).Edge()


def test_curves_alone_are_a_wire(tmp_path: Path) -> None:
    """A part of curves only is in the tree and has no shape."""
    body = only(read_quietly(write(tmp_path / "wire.step", edge())))
    assert (body.kind, len(body.mesh.faces), body.watertight) == (BodyKind.WIRE, 0, False)


def test_curves_beside_a_solid_are_left_out(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Curves beside a solid are no separate body, which is reported."""
    shape = solids.compound(edge(), solids.box(10, 10, 10).shape)
    body = only(read_here(write(tmp_path / "both.step", shape), diagnostics))
    assert body.kind == BodyKind.SOLID
    assert diagnostics.codes() == ["SB216"]


# Axes


def axis_faces(tmp_path: Path, solid: Any) -> tuple[AxisFace, ...]:
    """The axis faces of a drawn shape."""
    return only(read_quietly(write(tmp_path / "part.step", solid))).axis_faces


X_WB = pose((100.0, -50.0, 30.0), turn("x", 0.4) @ turn("y", -1.1))
"""Some pose, so that no axis is parallel to another [mm]."""


def ends(face: AxisFace) -> np.ndarray:
    """Both ends of a face's axis, the lower one in its own frame first, shape (2, 3) [mm]."""
    along = np.outer([face.low, face.high], face.direction) + np.array(face.point)
    local = (along * 1000 - X_WB[:3, 3]) @ X_WB[:3, :3]
    return local[np.argsort(local[:, 2])]


def test_a_shaft(tmp_path: Path) -> None:
    """A pin has its axis, radius and extent, with material inside."""
    (face,) = axis_faces(tmp_path, moved(solids.cylinder(4, 25).shape, X_WB))
    assert (face.bore, face.cone) == (False, False)
    assert face.radius == pytest.approx(0.004)
    assert ends(face) == pytest.approx(np.array([(0, 0, 0), (0, 0, 25)]), abs=1e-6)


def test_a_bore(tmp_path: Path) -> None:
    """A hole has its material outside."""
    plate = solids.box(40, 40, 12) - solids.cylinder(5, 12).at(8, 3, -6)
    (face,) = axis_faces(tmp_path, moved(plate.shape, X_WB))
    assert face.bore
    assert face.radius == pytest.approx(0.005)
    assert ends(face) == pytest.approx(np.array([(8, 3, -6), (8, 3, 6)]), abs=1e-6)


def test_a_cone(tmp_path: Path) -> None:
    """A cone has its larger radius."""
    (face,) = axis_faces(tmp_path, moved(solids.cone(9, 4, 20).shape, X_WB))
    assert (face.bore, face.cone) == (False, True)
    assert face.radius == pytest.approx(0.009)
    assert ends(face) == pytest.approx(np.array([(0, 0, 0), (0, 0, 20)]), abs=1e-6)


def test_an_oblique_cut_counts_to_its_tip(tmp_path: Path) -> None:
    """The extent of a face ending in an ellipse is exact: a pin of radius 5 cut at 30 degrees."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    knife = solids.box(100, 100, 100).at(0, 0, 50).moved(pose((0, 0, 20), turn("x", pi / 6)))
    shape = BRepAlgoAPI_Cut(solids.cylinder(5, 60).shape, knife.shape).Shape()
    (face,) = axis_faces(tmp_path, moved(shape, X_WB))
    assert ends(face)[1, 2] == pytest.approx(20 + 5 / sqrt(3), abs=1e-6)


@pytest.mark.parametrize("sweep", ["extrusion", "revolution"])
def test_swept_surfaces_that_are_cylinders(sweep: str, tmp_path: Path) -> None:
    """A cylinder written as an extruded circle or a revolved line is a cylinder."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_Circle, Geom_Line, Geom_SurfaceOfLinearExtrusion, Geom_SurfaceOfRevolution
    from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt

    z = gp_Dir(0, 0, 1)
    if sweep == "extrusion":
        surface = Geom_SurfaceOfLinearExtrusion(Geom_Circle(gp_Ax2(gp_Pnt(1, 2, 0), z), 6.0), z)
        bounds = (0.0, 2 * pi, -3.0, 14.0)
    else:
        surface = Geom_SurfaceOfRevolution(Geom_Line(gp_Pnt(7, 2, 0), z), gp_Ax1(gp_Pnt(1, 2, 0), z))
        bounds = (0.0, 2 * pi, -3.0, 14.0)
    (face,) = axis_faces(tmp_path, moved(BRepBuilderAPI_MakeFace(surface, *bounds, 1e-7).Face(), X_WB))
    assert (face.radius, face.cone) == (pytest.approx(0.006), False)
    assert ends(face) == pytest.approx(np.array([(1, 2, -3), (1, 2, 14)]), abs=1e-5)


def test_other_faces_have_no_axis(tmp_path: Path) -> None:
    """Planes and spheres have no axis."""
    assert axis_faces(tmp_path, solids.box(1, 2, 3).shape) == ()
    assert axis_faces(tmp_path, solids.sphere(2).shape) == ()


def test_a_mirrored_bore_is_a_bore(tmp_path: Path) -> None:
    """A mirrored bore has a mirrored axis, and its material still outside."""
    from stepbot.step.shapes.splitting import variant

    plate = solids.box(40, 40, 12) - solids.cone(6, 3, 12).at(8, 3, -6)
    body = only(read_quietly(write(tmp_path / "part.step", plate.shape)))
    body = replace(body, area=0.25)  # of a file that states areas
    mirrored = variant(body, is_mirrored=True, scale=3.0)
    (before,), (after,) = body.axis_faces, mirrored.axis_faces
    assert (after.bore, after.cone, after.radius) == (before.bore, before.cone, 3 * before.radius)
    for end, image in zip((before.low, before.high), (after.low, after.high), strict=True):
        at = np.array(before.point) + end * np.array(before.direction)
        shown = np.array(after.point) + image * np.array(after.direction)
        assert shown == pytest.approx(3 * at * (1, 1, -1), abs=1e-12)
    assert mirrored.area == pytest.approx(9 * 0.25, rel=1e-12)
    assert mirrored.exact is not None
    assert body.exact is not None
    assert mirrored.exact.volume == pytest.approx(27 * body.exact.volume, rel=1e-12)
    assert variant(body, is_mirrored=False, scale=1.0) is body


# Special cases


def test_a_slanted_seam_is_straightened(tmp_path: Path) -> None:
    """A seam slanted by rounding in parameter space stays in place and becomes exactly vertical."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir2d, gp_Pnt2d
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS

    from stepbot.step.kernel import faces_of
    from stepbot.step.shapes.tessellation import straighten

    shape = solids.cone(9, 4, 20).shape
    face = next(f for f in faces_of(shape) if any(BRep_Tool.IsClosed_s(e, f) for e in edges_of(f)))
    face = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    seam = next(e for e in edges_of(face) if BRep_Tool.IsClosed_s(e, face))
    seam = TopoDS.Edge(seam.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    slanted = [
        Geom2d_Line(gp_Pnt2d(u, 0.0), gp_Dir2d(3e-16, 1.0))
        for u in (curve_place(seam, face), curve_place(TopoDS.Edge(seam.Reversed()), face))
    ]
    BRep_Builder().UpdateEdge(seam, *slanted, face, 1e-7)
    assert straighten([face]) >= 1
    straight = BRep_Tool.CurveOnSurface_s(seam, face, 0.0, 0.0).Lin2d().Direction()
    assert (straight.X(), straight.Y()) == (0.0, 1.0)
    assert straighten([face]) == 0


@pytest.mark.parametrize(("seconds", "calls"), [(-1.0, 1), (1e9, 4)])
def test_tries_to_mesh_end_at_a_limit(
    seconds: float, calls: int, tmp_path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a face stays without triangles, the best mesh is kept, and the message says whether tries were left."""
    mesh, made = tessellation.tessellated_once, list[int]()

    def lacking(*arguments: Any) -> tessellation.Tessellation:
        made.append(len(made))
        return replace(mesh(*arguments), missing=[0, 1] if len(made) == 1 else [0])

    monkeypatch.setattr(tessellation, "tessellated_once", lacking)
    monkeypatch.setattr(tessellation, "RETRY_SECONDS", seconds)
    path = write(tmp_path / "ball.step", solids.sphere(10).shape)
    assert only(read_here(path, diagnostics)).exact is not None
    assert len(made) == calls
    (message,) = (diagnostic.message for diagnostic in diagnostics if diagnostic.code == "SB601")
    assert ("tries ended" in message) is (seconds < 0.0)
    assert ("2 of its faces" in message) is (seconds < 0.0)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_error_that_a_mesh_may_have_does_not_depend_on_its_size(scale: float) -> None:
    """By chordal deviation 3.6 % of a sheet whose thickness is a hundred times that, and no more than by the angle."""
    sheet, wanted = solids.box(scale, scale, 0.1 * scale).shape, tessellation.Fineness(1e-3 * scale, 0.5)
    by_deflection = 1.5e-3 * (2 + 0.4) / 0.1
    assert tessellation.tessellated_once(sheet, wanted).volume_tolerance == pytest.approx(by_deflection, rel=1e-6)
    coarse = replace(wanted, deflection=scale)
    assert tessellation.tessellated_once(sheet, coarse).volume_tolerance == pytest.approx(0.5**2 / 2 + 0.02, rel=1e-9)


def test_a_finer_mesh_is_bounded_and_needs_all_faces(monkeypatch: pytest.MonkeyPatch) -> None:
    """None is made that would have too many faces, or lack a face that is not meshed alone; the result says so."""
    mesh, made = tessellation.tessellated_once, list[tessellation.Fineness]()

    def lacking(shape: Any, wanted: tessellation.Fineness, *algorithm: Any) -> tessellation.Tessellation:
        made.append(wanted)
        return replace(mesh(shape, wanted, *algorithm), missing=[0])

    monkeypatch.setattr(tessellation, "tessellated_once", lacking)
    wanted = tessellation.Fineness(1.0, 0.3)
    every = tessellation.tessellated(solids.sphere(10).shape, wanted)
    assert (len(made), min(one.angle for one in made), every.untried) == (4, 0.25 * wanted.angle, "")
    made.clear()
    monkeypatch.setattr(tessellation, "MAX_RETRIED", len(every.mesh.faces) + 1)
    few = tessellation.tessellated(solids.sphere(10).shape, wanted)
    assert {one.angle for one in made} == {wanted.angle}
    assert "would have more than" in few.untried
    assert len(few.mesh.faces) == len(every.mesh.faces)
    made.clear()
    monkeypatch.undo()
    crossed = tessellation.tessellated(_bow_tie(), wanted)
    assert (crossed.missing, crossed.fineness) == ([0], wanted)
    assert crossed.untried == "no finer mesh has all faces"


def _bow_tie() -> Any:
    """A plane face whose outline crosses itself, which the kernel never meshes."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.gp import gp_Pnt

    outline = BRepBuilderAPI_MakePolygon()
    for x, y in ((0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)):
        outline.Add(gp_Pnt(x, y, 0.0))
    outline.Close()
    return BRepBuilderAPI_MakeFace(outline.Wire(), True).Face()


@pytest.mark.parametrize("upper", [0.0, 4.0])
def test_a_straightened_edge_keeps_its_range(upper: float) -> None:
    """Also that of the apex of a cone, which has no curve in space; the mesher never ends on an infinite one."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir2d
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS

    from stepbot.step.kernel import faces_of
    from stepbot.step.shapes.tessellation import Fineness, straighten, tessellated

    shape = solids.cone(9, upper, 20).shape
    curved = (f for f in faces_of(shape) if any(BRep_Tool.IsClosed_s(e, f) for e in edges_of(f)))
    face = TopoDS.Face(next(curved).Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    edges = [TopoDS.Edge(e.Oriented(TopAbs_Orientation.TopAbs_FORWARD)) for e in edges_of(face)]
    level = [edge for edge in edges if not BRep_Tool.IsClosed_s(edge, face)]
    ranges = [BRep_Tool.Range_s(edge, face) for edge in level]
    for edge, (first, last) in zip(level, ranges, strict=True):
        at = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0).Lin2d().Location()
        BRep_Builder().UpdateEdge(edge, Geom2d_Line(at, gp_Dir2d(1.0, 3e-16)), face, 1e-7)
        BRep_Builder().Range(edge, face, first, last)
    assert straighten([face]) == len(level) == 2
    assert [BRep_Tool.Range_s(edge, face) for edge in level] == ranges
    assert tessellated(shape, Fineness(0.1, 0.3)).is_complete


def edges_of(face: Any) -> list[Any]:
    """The edges of a face."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer, found = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_EDGE), []
    while explorer.More():
        found.append(TopoDS.Edge(explorer.Current()))
        explorer.Next()
    return found


def curve_place(edge: Any, face: Any) -> float:
    """Position of the seam in parameter space."""
    from OCP.BRep import BRep_Tool

    return float(BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0).Lin2d().Location().X())
