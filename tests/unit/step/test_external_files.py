"""Assemblies whose parts are in separate files."""

import os
from math import pi
from pathlib import Path

import numpy as np
import pytest

from robot_library.moments import pose, turn
from robot_library.step_file import Assembly, LengthUnit, Occurrence
from stepbot.step.assembly import Assembly as Read
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.parts import ALUMINIUM, STEEL, drawn
from tests.separate_files import Component, write_separately, write_structure
from tests.solids import box, cylinder, sphere

from .in_process import by_path, read_here


def machine() -> Assembly:
    """Three levels, a part in two subassemblies, two occurrences of a subassembly, colours, densities."""
    bolt = drawn("bolt", cylinder(4, 20) + cylinder(7, 5).at(0, 0, 20), "#222222", STEEL)
    plate = drawn("plate", box(200, 100, 10), "#b0b0b0", ALUMINIUM)
    carriage = drawn("carriage", box(40, 30, 20) - cylinder(5, 20).at(8, 4, -10), "#dd8800", ALUMINIUM)
    slide = Assembly(
        "slide",
        [
            Occurrence(carriage, "carriage:1"),
            Occurrence(bolt, "bolt:1", pose((0, 0, 10), turn("y", pi / 2))),
            Occurrence(drawn("knob", sphere(6), "#cc0000"), "knob:1", pose((0, 0, 40))),
        ],
    )
    frame = Assembly(
        "frame",
        [
            Occurrence(plate, "plate:1"),
            Occurrence(bolt, "bolt:1", pose((80, 30, 5))),
            Occurrence(bolt, "bolt:2", pose((-80, 30, 5), turn("x", pi))),
        ],
    )
    tilted = turn("z", 0.3) @ turn("x", -0.7)
    return Assembly(
        "machine",
        [
            Occurrence(frame, "frame:1"),
            Occurrence(slide, "slide:1", pose((50, 0, 60))),
            Occurrence(slide, "slide:2", pose((-50, 20, 80), tilted)),
        ],
    )


def assert_same(separate: Read, together: Read) -> None:
    """Assert that two assemblies have equal components, in all that a robot is built from."""
    one, other = by_path(separate), by_path(together)
    assert list(one) == list(other)
    for path, component in one.items():
        same = other[path]
        for name in ("product", "occurrence", "material", "color"):
            assert getattr(component, name) == getattr(same, name), (path, name)
        assert component.density == pytest.approx(same.density)
        assert np.allclose(component.X_WC.matrix, same.X_WC.matrix, atol=1e-12)
        if component.body < 0:
            assert same.body < 0
            continue
        body, expected = separate.bodies[component.body], together.bodies[same.body]
        assert body.exact is not None
        assert expected.exact is not None
        assert body.exact.volume == pytest.approx(expected.exact.volume, rel=1e-9)
        assert body.exact.unit_density.com == pytest.approx(expected.exact.unit_density.com, abs=1e-9)
        assert body.face_colors.tolist() == expected.face_colors.tolist()


@pytest.mark.parametrize("unit", ["MM", "INCH"])
def test_files_that_the_kernel_writes(unit: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Open CASCADE puts documents under version control between a part and its file, and repeats the file's name."""
    drawing = parts.draw(tmp_path / "machine.step", machine())
    together = read_here(drawing.path, diagnostics)
    separate = read_here(_written_by_the_kernel(drawing.path, tmp_path / "apart", unit), diagnostics)
    assert separate is not None
    assert together is not None
    assert {d.code for d in diagnostics} <= {
        "SB211",
        "SB220",
    }  # it repeats earlier parts, and writes densities without unit
    assert set(separate.external_files) == {f"part_{name}.stp" for name in ("plate", "bolt", "carriage", "knob")}
    assert _placed(separate) == _placed(together)


def _placed(assembly: Read) -> list[tuple[object, ...]]:
    """Product, pose and volume of each component, without names of occurrences, which the kernel does not write."""
    rows = []
    for component in assembly.components:
        exact = assembly.bodies[component.body].exact if component.body >= 0 else None
        numbers = [*component.X_WC.matrix.ravel(), 1e9 * exact.volume if exact else 0.0]
        rows.append((component.product, *(float(round(number, 6)) + 0.0 for number in numbers)))
    return sorted(rows)


def _written_by_the_kernel(step: Path, folder: Path, unit: str) -> Path:
    """The assembly of a file, written with one file for each part."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application

    storage = TCollection_ExtendedString("BinXCAF")
    document = TDocStd_Document(storage)
    XCAFApp_Application.GetApplication_s().NewDocument(storage, document)
    reader, writer = STEPCAFControl_Reader(), STEPCAFControl_Writer()
    reader.ReadFile(str(step))
    reader.Transfer(document)
    folder.mkdir()
    before = Path.cwd()
    os.chdir(folder)  # the kernel writes the parts into the current folder
    Interface_Static.SetCVal_s("write.step.unit", unit)
    try:
        assert writer.Transfer(document, STEPControl_AsIs, "part_")
        writer.Write("machine.step")
    finally:
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        os.chdir(before)
    return folder / "machine.step"


@pytest.mark.parametrize(
    "units",
    [{}, {"machine": "m", "slide": "cm", "bolt": "inch", "knob": "m", "plate": "foot"}],
    ids=["mm", "several units"],
)
def test_parts_in_their_own_files(units: dict[str, LengthUnit], tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Paths, names, poses, volumes, colours and materials are those of the same assembly in one file."""
    (tmp_path / "apart").mkdir()
    separate = read_here(write_separately(tmp_path / "apart", machine(), units), diagnostics)
    drawing = parts.draw(tmp_path / "machine.step", machine())
    together = read_here(drawing.path, diagnostics)
    assert separate is not None
    assert together is not None
    assert [str(d) for d in diagnostics] == []
    assert separate.external_files == (
        "frame.step", "slide.step", "plate.step", "bolt.step", "carriage.step", "knob.step",
    )  # fmt: skip
    assert_same(separate, together)
    assert len(separate.bodies) == len(together.bodies) == 4
    for piece in drawing.pieces:
        component = by_path(separate)[piece.path]
        exact = separate.bodies[component.body].exact
        assert exact is not None
        moved = exact.unit_density.moved(component.X_WC)
        assert moved.mass == pytest.approx(piece.body.mass, rel=1e-9)
        assert np.allclose(moved.com, piece.body.com, atol=1e-9)
    assert separate.definitions == together.definitions


def test_the_name_of_a_product_is_that_in_the_assembly(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A path has the product name in the assembly, not that in the part's file; one file can be two products."""
    parts.write_box(tmp_path / "part.step")  # the product 'block'
    root = write_structure(
        tmp_path / "root.step", "root", [Component("left", "part.step"), Component("right", "part.step")]
    )
    assembly = read_here(root, diagnostics)
    assert assembly is not None
    assert list(by_path(assembly)) == [".", "left", "right"]
    assert [c.product for c in assembly.components] == ["root", "left", "right"]
    assert diagnostics.codes() == []


def test_a_part_file_with_several_roots(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Of several roots the one with the product's name is used; without one, all are."""
    parts.write_several_roots(tmp_path / "two.step")  # 'block' and 'pin'
    root = write_structure(
        tmp_path / "root.step", "root", [Component("pin", "two.step"), Component("both", "two.step")]
    )
    assembly = read_here(root, diagnostics)
    assert assembly is not None
    assert list(by_path(assembly)) == [".", "pin", "both", "both/block", "both/pin"]


def test_files_below_the_folder(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A folder in the name, or in the reference's source, is relative to the referring file."""
    (tmp_path / "sub" / "deep").mkdir(parents=True)
    parts.write_box(tmp_path / "sub" / "deep" / "block.step")
    write_structure(tmp_path / "sub" / "arm.step", "arm", [Component("block", "block.step", folder="deep/")])
    root = write_structure(tmp_path / "root.step", "root", [Component("arm", "sub\\arm.step")])
    assembly = read_here(root, diagnostics)
    assert diagnostics.codes() == []
    assert assembly is not None
    assert assembly.external_files == ("sub/arm.step", "sub/deep/block.step")
    assert list(by_path(assembly)) == [".", "arm", "arm/block"]


def missing_files(assembly: Assembly | None) -> tuple[str, ...]:
    """Names of the files that an incomplete assembly misses; what they leave empty has no body."""
    assert assembly is not None
    missing = [component for component in assembly.components if component.missing]
    assert all(component.body == -1 for component in missing)
    return tuple(component.missing for component in missing)


def test_each_missing_file_is_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Each missing file is reported with product, file, line and remedy; a file in other case is suggested."""
    parts.write_box(tmp_path / "Plate.step")
    parts.write_box(tmp_path / "bolt.step")
    root = write_structure(
        tmp_path / "root.step",
        "root",
        [Component("plate", "plate.step"), Component("bolt", "bolt.step"), Component("knob", "knob.step")],
    )
    assembly = read_here(root, diagnostics)
    assert missing_files(assembly) == ("plate.step", "knob.step")
    assert assembly is not None
    assert [component.product for component in assembly.components if component.body >= 0] == ["bolt"]
    assert diagnostics.codes() == ["SB203", "SB203"]
    first, second = diagnostics
    assert first.message == "the geometry of 'plate' is in file 'plate.step', which does not exist"
    assert "did you mean 'Plate.step'?" in first.help
    assert second.message == "the geometry of 'knob' is in file 'knob.step', which does not exist"
    assert root.read_text().splitlines()[second.span.line - 1].count("knob.step") == 1


def test_parts_are_not_proposed_for_each_other(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Neither the assembly nor the file of another part is suggested for a missing file with a similar name."""
    parts.write_box(tmp_path / "Arm_Upper.step")
    root = write_structure(
        tmp_path / "Arm_Base.step", "root", [Component("a", "Arm_Upper.step"), Component("b", "Arm_Under.step")]
    )
    assert missing_files(read_here(root, diagnostics)) == ("Arm_Under.step",)
    (fault,) = diagnostics
    assert not any("did you mean" in text for text in fault.help)


def test_a_missing_file_of_a_subassembly(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A missing file of a subassembly is reported in the file that refers to it."""
    write_structure(tmp_path / "arm.step", "arm", [Component("block", "block.step")])
    assert missing_files(
        read_here(write_structure(tmp_path / "root.step", "root", [Component("arm", "arm.step")]), diagnostics)
    )
    (fault,) = diagnostics
    assert (fault.code, Path(fault.span.file).name) == ("SB203", "arm.step")


OUTSIDE = [
    "../block.step", "sub/../../block.step", "..\\block.step", "/etc/block.step", "\\\\host\\share\\block.step",
    "C:\\parts\\block.step", "c:block.step", "file:///etc/block.step", "http://example.org/block.step",
    "https://example.org/block.step",
]  # fmt: skip


@pytest.mark.parametrize("name", OUTSIDE)
def test_paths_that_leave_the_folder(name: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Absolute paths, parent folders and URLs are rejected, even if the file exists."""
    (tmp_path / "inside").mkdir()
    parts.write_box(tmp_path / "block.step")
    root = write_structure(tmp_path / "inside" / "root.step", "root", [Component("block", name)])
    assert missing_files(read_here(root, diagnostics))
    (fault,) = diagnostics
    assert fault.code == "SB203"
    assert "which is not beside it" in fault.message
    assert fault.help


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
@pytest.mark.parametrize("through", ["file", "folder"])
def test_links_that_leave_the_folder(through: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A link to a file outside the folder is rejected; one within the folder is followed."""
    (tmp_path / "inside").mkdir()
    (tmp_path / "outside").mkdir()
    parts.write_box(tmp_path / "outside" / "block.step")
    if through == "file":
        (tmp_path / "inside" / "block.step").symlink_to(tmp_path / "outside" / "block.step")
    else:
        (tmp_path / "inside" / "sub").symlink_to(tmp_path / "outside")
    name = "block.step" if through == "file" else "sub/block.step"
    root = write_structure(tmp_path / "inside" / "root.step", "root", [Component("block", name)])
    assert missing_files(read_here(root, diagnostics))
    assert [d.code for d in diagnostics] == ["SB203"]
    assert "link" in next(iter(diagnostics)).message

    parts.write_box(tmp_path / "inside" / "real.step")
    (tmp_path / "inside" / "alias.step").symlink_to("real.step")
    root = write_structure(tmp_path / "inside" / "root.step", "root", [Component("block", "alias.step")])
    assert read_here(root, diagnostics) is not None


@pytest.mark.skipif(os.name == "nt", reason="no such files on Windows")
def test_what_is_no_regular_file(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A folder, a pipe, a cycle of links and an invalid name are reported as missing files."""
    (tmp_path / "folder.step").mkdir()
    os.mkfifo(tmp_path / "pipe.step")
    (tmp_path / "circle.step").symlink_to("circle.step")
    names = ["folder.step", "pipe.step", "circle.step", "n" * 300 + ".step", "a\\X\\00b.step", "  .step"]
    for name in names:
        root = write_structure(tmp_path / "root.step", "root", [Component("block", name)])
        assert missing_files(read_here(root, diagnostics))
    assert diagnostics.codes() == ["SB203"] * len(names)


def test_the_kernel_opens_no_file_by_itself(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A file that stepbot does not use, because the assembly also contains the part, is not read by the kernel."""
    drawing = parts.write_needless_reference(tmp_path / "box.step")
    parts.write_cylinder(tmp_path / "elsewhere.step")
    assembly = read_here(drawing.path, diagnostics)
    assert diagnostics.codes() == ["SB231"]
    assert assembly is not None
    assert assembly.external_files == ()
    assert len(assembly.bodies) == 1
    (fault,) = diagnostics
    assert "elsewhere.step" in fault.message


@pytest.mark.parametrize("chain", [["root"], ["root", "a"], ["root", "a", "b"]], ids=["self", "two", "three"])
def test_circles(chain: list[str], tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Files that contain each other are an error that shows the cycle."""
    for name, next_name in zip(chain, [*chain[1:], chain[0]], strict=True):
        write_structure(tmp_path / f"{name}.step", name, [Component(next_name, f"{next_name}.step")])
    assert read_here(tmp_path / "root.step", diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB203"
    assert fault.message.endswith(" -> ".join(f"{name}.step" for name in [*chain, "root"]))


def test_a_part_file_that_is_damaged(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An error in a part's file names that file."""
    drawing = parts.write_box(tmp_path / "block.step")
    drawing.path.write_bytes(drawing.path.read_bytes()[:5000])
    root = write_structure(tmp_path / "root.step", "root", [Component("block", "block.step")])
    assert read_here(root, diagnostics) is None
    (fault,) = diagnostics
    assert (fault.code, Path(fault.span.file).name) == ("SB201", "block.step")


def test_a_file_name_in_a_code_page(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A file is found by a name in any code page, without a declaration, as for the cache key."""
    parts.write_box(tmp_path / "Корпус.step")
    root = write_structure(tmp_path / "root.step", "root", [Component("block", "Корпус.step")])
    root.write_bytes(root.read_text(encoding="utf-8").encode("cp1251"))
    assembly = read_here(root, diagnostics)
    assert assembly is not None
    assert diagnostics.codes() == ["SB210"]
    assert assembly.external_files == ("Корпус.step",)


def test_a_native_file_is_no_part(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Native CAD files are not read."""
    (tmp_path / "block.sldprt").write_bytes(b"")
    root = write_structure(tmp_path / "root.step", "root", [Component("block", "block.sldprt")])
    assert read_here(root, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB203"
    assert "not STEP: 'block.sldprt'" in fault.message
