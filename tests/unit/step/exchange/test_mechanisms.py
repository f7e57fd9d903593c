"""STEP files with a kinematic mechanism (ISO 10303-105)."""

import pkgutil
import re
from pathlib import Path

import OCP
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFApp import XCAFApp_Application

from stepbot.step.exchange.selection import mechanism_count
from stepbot.step.kernel import read_model
from tests import parts
from tests.unit.step.in_process import read_quietly


def add_mechanism(path: Path) -> None:
    """Add a slider of two links to a STEP file, as a property of its first product."""
    text = path.read_text(encoding="utf-8")
    numbers = [int(number) for number in re.findall(r"^#(\d+)", text, re.MULTILINE)]
    n = max(numbers) + 1
    product = re.findall(r"#(\d+)\s*=\s*PRODUCT_DEFINITION\(", text)[0]
    context = re.findall(r"#(\d+)\s*=\s*\(\s*GEOMETRIC_REPRESENTATION_CONTEXT", text)[0]
    statements = f"""\
#{n}=CARTESIAN_POINT('',(1.,2.,3.));
#{n + 1}=AXIS2_PLACEMENT_3D('rail',#{n},$,$);
#{n + 2}=AXIS2_PLACEMENT_3D('carriage',#{n},$,$);
#{n + 3}=KINEMATIC_LINK('holder');
#{n + 4}=KINEMATIC_LINK('block');
#{n + 5}=KINEMATIC_JOINT('slide',#{n + 3},#{n + 4});
#{n + 6}=KINEMATIC_TOPOLOGY_STRUCTURE('tree',(#{n + 5}),#{context});
#{n + 7}=RIGID_LINK_REPRESENTATION('holder',(#{n + 1}),#{context},#{n + 3});
#{n + 8}=PRISMATIC_PAIR('slide','','',#{n + 1},#{n + 2},#{n + 5},.F.,.F.,.T.,.F.,.F.,.F.);
#{n + 9}=MECHANISM_REPRESENTATION('slider',(#{n + 8}),#{context},#{n + 6});
#{n + 10}=PRODUCT_DEFINITION_KINEMATICS('motion','',#{product});
#{n + 11}=KINEMATIC_PROPERTY_MECHANISM_REPRESENTATION(#{n + 10},#{n + 9},#{n + 7});
"""
    end = text.rindex("ENDSEC;")
    path.write_text(text[:end] + statements + text[end:], encoding="utf-8", newline="\n")


def test_file_with_a_mechanism_is_read(tmp_path: Path) -> None:
    """Shapes, poses and densities are those without the mechanism, and `inspect` names what was not read."""
    path = parts.write_slider(tmp_path / "slider.step").path
    plain = read_quietly(path)
    assert mechanism_count(read_model(path)[1]) == 0
    add_mechanism(path)
    assert mechanism_count(read_model(path)[1]) == 1
    assembly = read_quietly(path)
    assert [component.path for component in assembly.components] == [one.path for one in plain.components]
    assert [component.density for component in assembly.components] == [one.density for one in plain.components]
    assert [len(body.mesh.faces) for body in assembly.bodies] == [len(body.mesh.faces) for body in plain.bodies]
    assert "mechanisms" not in plain.facts
    assert assembly.facts["mechanisms"].startswith("1; `stepbot init` drafts joints from them")


def test_the_kernel_parses_a_mechanism_and_does_not_write_it(tmp_path: Path) -> None:
    """Its entities are correct, but bindings and XCAF have none, nor has a file written from it (decision 0033)."""
    path = parts.write_slider(tmp_path / "slider.step").path
    add_mechanism(path)
    reader = STEPCAFControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    model = reader.Reader().Model()
    numbers = range(1, model.NbEntities() + 1)
    assert not [n for n in numbers if model.IsUnknownEntity(n) or model.IsErrorEntity(n)]
    document = TDocStd_Document(TCollection_ExtendedString("document"))
    XCAFApp_Application.GetApplication_s().NewDocument(TCollection_ExtendedString("MDTV-XCAF"), document)
    assert reader.Transfer(document)
    writer = STEPCAFControl_Writer()
    assert writer.Transfer(document)
    assert writer.Write(str(tmp_path / "again.step")) == IFSelect_ReturnStatus.IFSelect_RetDone
    counts = [file.read_text(encoding="utf-8").count("KINEMATIC_") for file in (path, tmp_path / "again.step")]
    assert counts == [5, 0]
    found = {module.name for module in pkgutil.iter_modules(OCP.__path__)}
    assert "StepShape" in found
    assert not {name for name in found if "Kinematic" in name}
