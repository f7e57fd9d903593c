"""STEP files with a kinematic mechanism (ISO 10303-105)."""

import re
from pathlib import Path

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
    assert mechanism_count(read_model(path).session) == 0
    add_mechanism(path)
    assert mechanism_count(read_model(path).session) == 1
    assembly = read_quietly(path)
    assert [component.path for component in assembly.components] == [one.path for one in plain.components]
    assert [component.density for component in assembly.components] == [one.density for one in plain.components]
    assert [len(body.mesh.faces) for body in assembly.bodies] == [len(body.mesh.faces) for body in plain.bodies]
    assert "mechanisms" not in plain.facts
    assert assembly.facts["mechanisms"].startswith("1; `stepbot init` drafts joints from them")
