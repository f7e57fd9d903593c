"""Validation properties: values stated in a file, against closed forms and the geometry read."""

import re
from math import pi
from pathlib import Path

import numpy as np
import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly as DrawnAssembly
from robot_library.step_file import LengthUnit, Occurrence
from stepbot.step.assembly import Assembly, Quantity, ReadOptions, Validation
from tests import parts, solids
from tests.conftest import ReadDiagnostics
from tests.step_editor import METRES, StepEditor
from tests.unit.step.in_process import read_here, read_quietly


def by_quantity(assembly: Assembly) -> dict[str, Validation]:
    """Validations of a file that states each quantity once, by quantity."""
    return {validation.quantity.value: validation for validation in assembly.validations}


@pytest.mark.parametrize(("unit", "stated_in"), [("mm", "cm"), ("inch", "mm"), ("m", "m"), ("foot", "cm")])
def test_units_of_statements(unit: LengthUnit, stated_in: str, tmp_path: Path) -> None:
    """A value has its own unit, independent of the file's length unit; a centroid has the file's."""
    drawing = parts.write_cylinder(tmp_path / "cylinder.step", 20.0, 70.0, unit)
    file = StepEditor(drawing.path)
    root, one = file.definition("pin"), METRES[stated_in]
    subject = file.shape(root)
    file.measure(subject, Quantity.VOLUME, pi * 0.020**2 * 0.070 / one**3, stated_in)
    file.measure(subject, Quantity.AREA, (2 * pi * 0.020**2 + 2 * pi * 0.020 * 0.070) / one**2, stated_in)
    own = {"mm": 1e-3, "inch": 0.0254, "m": 1.0, "foot": 0.3048}[unit]
    file.centroid(root, np.array(drawing.body.com) / own, file.context(file.representation(root)))
    found = by_quantity(read_quietly(file.write()))
    assert set(found) == {"volume", "area", "centroid"}
    assert found["volume"].stated == pytest.approx((pi * 0.020**2 * 0.070,), rel=1e-12, abs=0)
    for validation in found.values():
        assert validation.read == pytest.approx(validation.stated, rel=1e-9, abs=1e-12)
        assert validation.agrees
        assert validation.deviation < 1e-9


def test_differences_are_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A wrong volume and a wrong centroid are reported with both values, the deviation and the part."""
    drawing = parts.write_box(tmp_path / "box.step", (100.0, 60.0, 40.0))
    file = StepEditor(drawing.path)
    block = file.definition("block")
    file.measure(block, Quantity.VOLUME, 250_000.0)
    file.measure(block, Quantity.AREA, 24_800.0 * 1.009)
    center = np.array(drawing.body.com) * 1e3 + (3.0, 0.0, 0.0)
    file.centroid(block, center, file.context(file.representation(block)))
    assembly = read_here(file.write(), diagnostics)
    assert assembly is not None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("SB226", "warning")
    validations = by_quantity(assembly)
    assert validations["area"].agrees  # within 1 %
    volume, centroid = validations["volume"], validations["centroid"]
    assert (volume.stated, volume.read) == (pytest.approx((250e-6,)), pytest.approx((240e-6,)))
    assert (volume.agrees, volume.deviation) == (False, pytest.approx(0.04))
    gyration = np.sqrt((0.1**2 + 0.06**2 + 0.04**2) / 12)
    assert (centroid.agrees, centroid.deviation) == (False, pytest.approx(0.003 / gyration))
    assert diagnostic.message == "2 of 3 validation properties in the file differ from the geometry read"
    assert diagnostic.notes[0] == "'.': volume 250 cm^3 in the file, 240 read, off by 4.00% (tolerance 0.1%)"
    assert "3 mm apart, of the radius of gyration 8.4" in diagnostic.notes[1]


def test_sums_over_an_assembly(tmp_path: Path) -> None:
    """The values of an assembly are those of everything below it, for any occurrences."""
    drawing = parts.write_nested(tmp_path / "nested.step")
    file = StepEditor(drawing.path)
    root = file.definition("machine")
    file.measure(root, Quantity.VOLUME, drawing.body.mass * 1e9)
    file.centroid(root, np.array(drawing.body.com) * 1e3, file.context(file.representation(root)))
    found = by_quantity(read_quietly(file.write()))
    assert found["volume"].deviation < 1e-9
    assert found["centroid"].deviation < 1e-9
    assert {validation.component for validation in found.values()} == {0}


def test_mirrored_and_repeated_occurrences(tmp_path: Path) -> None:
    """The centroid of an occurrence is in the assembly's frame; each of several has its own."""
    drawing = parts.write_mirrored(tmp_path / "pair.step")
    file = StepEditor(drawing.path)
    context = file.context(file.representation(file.definition("pair of brackets")))
    usages = [
        int(n)
        for n in re.findall(r"^#(\d+)\s*=\s*NEXT_ASSEMBLY_USAGE_OCCURRENCE", drawing.path.read_text(), re.MULTILINE)
    ]
    assert len(usages) == len(drawing.pieces) == 2
    for usage, piece in zip(usages, drawing.pieces, strict=True):
        file.centroid(file.shape(usage), np.array(piece.body.com) * 1e3, context)
    assembly = read_quietly(file.write())
    paths = [assembly.components[validation.component].path for validation in assembly.validations]
    assert paths == [piece.path for piece in drawing.pieces]
    assert max(validation.deviation for validation in assembly.validations) < 1e-9


@pytest.mark.parametrize("style", ["shape representation", "item usage"])
def test_solids_of_a_part(style: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Each solid of a part has its own values, in the forms of AP214 and AP242."""
    drawing = parts.write_two_solids(tmp_path / "pair.step")
    file = StepEditor(drawing.path)
    definition = file.definition("pair")
    representation = file.representation(definition)
    text = drawing.path.read_text(encoding="utf-8")
    breps = [int(n) for n in re.findall(r"^#(\d+)\s*=\s*MANIFOLD_SOLID_BREP", text, re.MULTILINE)]
    assert len(breps) == len(drawing.pieces) == 2
    for brep, piece in reversed(list(zip(breps, drawing.pieces, strict=True))):
        aspect = file.add(f"SHAPE_ASPECT('','solid',#{file.shape(definition)},.F.)")
        if style == "item usage":
            file.add(f"GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#{aspect},#{representation},#{brep})")
        else:
            meaning = file.add(f"PROPERTY_DEFINITION('','shape of the solid',#{aspect})")
            shape = file.add(f"SHAPE_REPRESENTATION('',(#{brep}),#{file.context(representation)})")
            file.add(f"SHAPE_DEFINITION_REPRESENTATION(#{meaning},#{shape})")
        file.measure(aspect, Quantity.VOLUME, piece.body.mass * 1e9)
    assembly = read_here(file.write(), diagnostics)
    assert assembly is not None
    read = {assembly.components[v.component].path: v.read[0] for v in assembly.validations}
    assert read == {piece.path: pytest.approx(piece.body.mass, rel=1e-9, abs=0) for piece in drawing.pieces}
    assert len(set(read.values())) == 2
    assert all(validation.agrees for validation in assembly.validations)
    assert diagnostics.codes() == []


def test_what_cannot_be_compared(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A volume in square metres, and a value of something that is not a part, are counted as not compared."""
    file = StepEditor(parts.write_box(tmp_path / "box.step").path)
    root = file.definition("block")
    file.measure(root, Quantity.VOLUME, 1.0, power=2)
    file.measure(file.find("APPLICATION_CONTEXT"), Quantity.VOLUME, 1.0)
    assembly = read_here(file.write(), diagnostics)
    assert assembly is not None
    assert assembly.validations == ()
    codes = diagnostics.codes()
    assert "SB227" in codes
    assert "SB226" not in codes


def test_triangles_are_not_compared(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A tessellated body has no exact volume to compare."""
    file = StepEditor(parts.write_tessellated(tmp_path / "mesh.step").path)
    file.measure(file.definition("scan"), Quantity.VOLUME, 1.0)
    assembly = read_here(file.write(), diagnostics)
    assert assembly is not None
    assert (assembly.validations, diagnostics.codes()) == ((), ["SB227"])


def test_an_open_solid_has_no_volume(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The stated volume of a solid that lost a face is reported as different."""
    file = StepEditor(parts.write_open_solid(tmp_path / "open.step").path)
    file.measure(file.definition("open box"), Quantity.VOLUME, 1000.0)
    assembly = read_here(file.write(), diagnostics)
    assert assembly is not None
    assert [validation.read for validation in assembly.validations] == [(0.0,)]
    assert sorted(diagnostics.codes()) == ["SB226", "SB602"]


def test_without_geometry_nothing_is_compared(tmp_path: Path) -> None:
    """Without geometry nothing is compared."""
    file = StepEditor(parts.write_box(tmp_path / "box.step").path)
    file.measure(file.definition("block"), Quantity.VOLUME, 1.0)
    assert read_quietly(file.write(), ReadOptions(geometry=False)).validations == ()


def test_areas_cost_nothing_where_none_is_stated(tmp_path: Path) -> None:
    """Areas are integrated only if the file states one."""
    path = parts.write_box(tmp_path / "box.step", (100.0, 60.0, 40.0)).path
    assert [body.area for body in read_quietly(path).bodies] == [0.0]
    file = StepEditor(path)
    file.measure(file.definition("block"), Quantity.AREA, 24_800.0)
    assert [body.area for body in read_quietly(file.write()).bodies] == [pytest.approx(0.0248, rel=1e-12)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count", "differing"),
    [("as1-oc-214.step", 27, 0), ("s1_autocad_foot.step", 39, 0), ("dm1_ideas_inch.step", 19, 1)],
)
def test_real_files(name: str, count: int, differing: int, corpus: Path, diagnostics: ReadDiagnostics) -> None:
    """Values stated by three CAD programs for real assemblies agree, in mm, feet and inches."""
    assembly = read_here(corpus / name, diagnostics)
    assert assembly is not None
    assert len(assembly.validations) == count
    wrong = [validation for validation in assembly.validations if not validation.agrees]
    assert len(wrong) == differing
    assert diagnostics.codes() == ["SB226"] * (differing > 0)
    for validation in assembly.validations:
        if validation.quantity is Quantity.VOLUME:
            assert validation.deviation < 3e-4
    if wrong:  # a centre of mass, of parts of several densities, in place of a centroid
        leaves = [c for c in assembly.components if c.body >= 0]
        exact = [assembly.bodies[c.body].exact for c in leaves]
        masses = np.array([c.density * e.volume for c, e in zip(leaves, exact, strict=True) if e is not None])
        centers = [c.X_WC.apply(e.unit_density.com) for c, e in zip(leaves, exact, strict=True) if e is not None]
        assert wrong[0].stated == pytest.approx(masses @ np.array(centers) / masses.sum(), abs=2e-6)


def test_a_turned_occurrence_of_an_assembly(tmp_path: Path) -> None:
    """Values of a subassembly are in its own frame, in any pose."""
    pin = parts.drawn("pin", solids.cylinder(2, 10))
    pair = DrawnAssembly("pair", [Occurrence(pin, "one", pose((1, 2, 3))), Occurrence(pin, "two", pose((5, 2, 3)))])
    root = DrawnAssembly("root", [Occurrence(pair, "pair:1", pose((50, 0, 0), np.diag([1.0, -1.0, -1.0])))])
    path = tmp_path / "turned.step"
    drawing = parts.draw(path, root)
    file = StepEditor(path)
    definition = file.definition("pair")
    height = float(pin.bodies[0].com[2])
    file.centroid(definition, (3, 2, 3 + height), file.context(file.representation(definition)))
    usage = file.find(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*','pair:1'")
    file.centroid(
        file.shape(usage), np.array(drawing.body.com) * 1e3, file.context(file.representation(file.definition("root")))
    )
    assembly = read_quietly(file.write())
    assert [validation.deviation < 1e-9 for validation in assembly.validations] == [True, True]
