"""STEP files against closed forms: trees, names, poses, mass, colours, in any unit; and unusual files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly as DrawnAssembly
from robot_library.step_file import LengthUnit, Occurrence
from stepbot.step.assembly import BodyKind, ReadOptions
from tests import parts, solids
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import by_path, read_here, read_quietly

DRAWINGS: list[Callable[[Path], parts.Drawing]] = [
    parts.write_box,
    parts.write_cylinder,
    parts.write_cone,
    parts.write_sphere,
    parts.write_bored_plate,
    parts.write_two_solids,
    parts.write_surface_body,
    parts.write_colored_faces,
    parts.write_nested,
    parts.write_mirrored,
    parts.write_many,
    parts.write_same_names,
    parts.write_awkward_names,
    parts.write_several_roots,
    parts.write_hinge,
    parts.write_slider,
]


@pytest.mark.parametrize("write", DRAWINGS, ids=lambda write: write.__name__)
def test_every_body_is_where_and_what_was_drawn(write: Callable[[Path], parts.Drawing], tmp_path: Path) -> None:
    """Names, density and integrals of every body, in its pose, equal those of the drawing."""
    drawing = write(tmp_path / "drawn.step")
    assembly = read_quietly(drawing.path)
    components = by_path(assembly)
    assert {c.path for c in assembly.components if c.body >= 0} == {piece.path for piece in drawing.pieces}
    for piece in drawing.pieces:
        component = components[piece.path]
        if component.product:
            assert component.product == piece.product.strip()
            assert component.parent < 0 or component.occurrence.strip() == piece.occurrence.strip()
        assert component.density == (pytest.approx(piece.density, rel=1e-12) if piece.density else None)
        assert np.linalg.det(component.X_WC.R) == pytest.approx(1.0)
        exact = assembly.bodies[component.body].exact
        if piece.body.mass == 0:
            assert exact is None
            continue
        assert exact is not None
        found = exact.unit_density.moved(component.X_WC)
        size = np.linalg.norm(np.subtract(*assembly.bounds(component.index)))  # type: ignore[misc]
        assert found.mass == pytest.approx(piece.body.mass, rel=1e-9, abs=0)
        assert np.abs(np.subtract(found.com, piece.body.com)).max() < 1e-9 * size
        inertia = np.array(piece.body.inertia)
        assert np.abs(np.array(found.inertia) - inertia).max() < 1e-8 * np.abs(inertia).max()


@pytest.mark.parametrize("write", DRAWINGS, ids=lambda write: write.__name__)
def test_every_solid_is_watertight(write: Callable[[Path], parts.Drawing], tmp_path: Path) -> None:
    """The mesh of a valid solid is closed, faces outwards, and has the solid's volume within its tolerance."""
    assembly = read_quietly(write(tmp_path / "drawn.step").path)
    for body in assembly.bodies:
        if body.kind == BodyKind.SOLID:
            assert body.watertight
            assert not body.defect
            a, b, c = (body.mesh.vertices[body.mesh.faces[:, k]] for k in range(3))
            assert body.exact is not None
            assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(body.exact.volume, rel=0.05, abs=0)
            assert len(body.face_colors) == len(body.mesh.faces)


SCALES: dict[LengthUnit, float] = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 0.0254, "foot": 0.3048}


@pytest.mark.parametrize("unit", SCALES)
def test_units(unit: LengthUnit, tmp_path: Path) -> None:
    """The same machine in any unit is the same assembly; the file's unit is reported."""
    assembly = read_quietly(parts.write_nested(tmp_path / "other.step", unit).path)
    reference = read_quietly(parts.write_nested(tmp_path / "mm.step").path)
    assert (assembly.unit, assembly.unit_scale) == (unit, SCALES[unit])
    for mine, theirs in zip(assembly.components, reference.components, strict=True):
        assert (mine.path, mine.body, mine.material, mine.density) == (
            *(theirs.path, theirs.body, theirs.material),
            theirs.density,
        )
        assert mine.X_WC.matrix == pytest.approx(theirs.X_WC.matrix, abs=1e-12)
    for body, other in zip(assembly.bodies, reference.bodies, strict=True):
        assert body.exact is not None
        assert other.exact is not None
        # Coordinates have 13 significant digits.
        assert body.exact.volume == pytest.approx(other.exact.volume, rel=1e-11, abs=0)
        # Points on a circle are triangulated by the last bit, so vertices may be in another order.
        assert body.mesh.faces.shape == other.mesh.faces.shape
        assert np.array(body.mesh.bounds) == pytest.approx(np.array(other.mesh.bounds), abs=2e-9)


def test_facts(tmp_path: Path) -> None:
    """An assembly has the file's name, schema, program and encoding, and its number of definitions."""
    assembly = read_quietly(parts.write_nested(tmp_path / "nested.step").path)
    assert (assembly.source, assembly.schema, assembly.definitions) == ("nested.step", "AP214", 7)
    assert assembly.originating_system
    assert assembly.facts["encoding"] == "ASCII"


def test_a_definition_is_made_once(tmp_path: Path) -> None:
    """A hundred occurrences of a pin share one body and one definition."""
    assembly = read_quietly(parts.write_many(tmp_path / "row.step", 100).path)
    assert len(assembly.bodies) == 1
    assert len({component.definition for component in assembly.components[1:]}) == 1


def test_a_mirror_image_is_a_definition_of_its_own(tmp_path: Path) -> None:
    """A mirrored occurrence has a right-handed frame and a mirrored body."""
    assembly = read_quietly(parts.write_mirrored(tmp_path / "pair.step").path)
    left, right = (by_path(assembly)[name] for name in ("left", "right"))
    assert left.body != right.body
    assert left.definition != right.definition
    mine, other = (assembly.bodies[component.body] for component in (left, right))
    assert np.array(mine.mesh.bounds)[:, 2] == pytest.approx(-np.array(other.mesh.bounds)[::-1, 2])


def test_the_tree_alone(tmp_path: Path) -> None:
    """Without geometry the tree is the same, and bodies have their kind."""
    path = parts.write_surface_body(tmp_path / "drawn.step").path
    whole, tree = read_quietly(path), read_quietly(path, ReadOptions(geometry=False))
    assert tree.components == whole.components
    assert [body.kind for body in tree.bodies] == [body.kind for body in whole.bodies]
    assert not any(len(body.mesh.faces) or body.exact for body in tree.bodies)


def test_colours_down_to_the_face(tmp_path: Path) -> None:
    """The colour of a face takes precedence over the part's, which is that of the component."""
    assembly = read_quietly(parts.write_colored_faces(tmp_path / "drawn.step").path)
    (body,) = assembly.bodies
    assert assembly.components[-1].color == (0.0, 0.0, 1.0, 1.0)
    red = body.colors.index((1.0, 0.0, 0.0, 1.0))
    assert set(body.colors) == {None, (1.0, 0.0, 0.0, 1.0)}
    corners = body.mesh.vertices[body.mesh.faces[body.face_colors == red]]
    assert corners[..., 0] == pytest.approx(-0.015)
    assert len(corners) == 2


def test_an_occurrence_may_have_a_colour_of_its_own(tmp_path: Path) -> None:
    """One of two bolts has a colour in the assembly; the other keeps the part's colour."""
    components = by_path(read_quietly(parts.write_nested(tmp_path / "nested.step").path))
    assert components["frame/bolt:2"].color == (0.0, 0.8, 0.8, 1.0)
    assert components["frame/bolt:1"].color == pytest.approx((0x22 / 255,) * 3 + (1.0,), abs=1e-6)


def test_names_survive_in_one_place(tmp_path: Path) -> None:
    """Occurrences of one product at equal poses in different assemblies keep their own names."""
    pin = parts.drawn("pin", solids.cylinder(2, 10))
    first = DrawnAssembly("first", [Occurrence(pin, "one", pose((1, 2, 3)))])
    second = DrawnAssembly("second", [Occurrence(pin, "two", pose((1, 2, 3))), Occurrence(pin, "three")])
    root = DrawnAssembly("root", [Occurrence(first, "first:1"), Occurrence(second, "second:1", pose((50, 0, 0)))])
    path = tmp_path / "coincident.step"
    parts.draw(path, root)
    assembly = read_quietly(path)
    assert [c.occurrence for c in assembly.components if c.product == "pin"] == ["one", "two", "three"]
    assert {"first/pin", "second/two", "second/three"} <= set(by_path(assembly))


def test_a_file_without_a_unit(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Lengths without a unit are an error."""
    assert read_here(parts.write_without_unit(tmp_path / "box.step").path, diagnostics) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB207"
    assert diagnostic.help


def test_files_without_geometry(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An empty assembly is distinguished from one whose shapes are in other files."""
    assert read_here(parts.write_empty(tmp_path / "empty.step").path, diagnostics) is None
    assembly = read_here(parts.write_external_reference(tmp_path / "external.step").path, diagnostics)
    assert diagnostics.codes() == ["SB205", "SB203"]
    assert assembly is not None
    assert not assembly.bodies
    assert [bool(component.missing) for component in assembly.components].count(True) == 1


def test_a_solid_with_a_hole_in_its_skin(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A box without a lid has no volume, although the kernel returns one."""
    assembly = read_here(parts.write_open_solid(tmp_path / "open.step").path, diagnostics)
    assert assembly is not None
    (body,) = assembly.bodies
    assert (body.watertight, body.exact) == (False, None)
    assert body.defect
    (diagnostic,) = diagnostics
    assert (diagnostic.code, body.kind) == ("SB602", BodyKind.SOLID)
    assert diagnostic.message.startswith("'.': 4 of its edges belong to one face only")


def test_surfaces_have_no_mass(tmp_path: Path) -> None:
    """A sheet has a mesh and no volume."""
    assembly = read_quietly(parts.write_surface_body(tmp_path / "sheet.step").path)
    sheet = assembly.bodies[by_path(assembly)["sheet"].body]
    assert (sheet.kind, sheet.exact, sheet.watertight) == (BodyKind.SURFACE, None, False)
    assert len(sheet.mesh.faces) == 2
    assert sheet.defect
