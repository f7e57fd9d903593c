"""Faults of a URDF that other readers report as exceptions of their own have a message with the line."""

from pathlib import Path

import pytest
from lxml import etree

from stepbot.engines.describe import describe
from stepbot.engines.description.urdf_structure import check_structure
from stepbot.engines.observation import EngineRefused
from stepbot.geometry.primitives import Box

ARM = """<robot name="arm">
<link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="tip"/>
<joint name="hinge" type="revolute">
<origin xyz="0 0 1"/>
<parent link="base"/>
<child link="tip"/>
<axis xyz="0 0 1"/>
<limit lower="-inf" upper="1" effort="1" velocity="1"/>
</joint>
<gazebo><origin xyz="any"/></gazebo>
</robot>"""


def test_sound_files_pass() -> None:
    """Infinite limits are valid, repeated elements that agree too; numbers in extension blocks are not judged."""
    check_structure(etree.fromstring(ARM))
    check_structure(etree.fromstring(ARM.replace("</joint>", '<axis xyz="0 0 1"/></joint>')))


def test_fixed_joints_need_no_axis() -> None:
    """The SolidWorks exporter writes a zero axis for them."""
    fixed = ARM.replace('type="revolute"', 'type="fixed"').replace('axis xyz="0 0 1"', 'axis xyz="0 0 0"')
    check_structure(etree.fromstring(fixed))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('robot name="arm"', "robot", "line 1: <robot> without attribute 'name'"),
        ("<gazebo>", '<x:include xmlns:x="http://ros.org/wiki/xacro"/><gazebo>',
         "line 11: <xacro:include>: expand macros first, `xacro robot.urdf.xacro -o robot.urdf`"),
        ('link name="tip"', 'link name="base"', "line 3: duplicate link 'base'"),
        ('</joint>', '</joint><joint name="hinge" type="fixed"/>', "line 10: duplicate joint 'hinge'"),
        ('type="revolute"', "", "line 4: <joint> without attribute 'type'"),
        ('<child link="tip"/>', "", "line 4: joint 'hinge': no <child>"),
        ('<parent link="base"/>', '<parent link="bas"/>', "line 4: joint 'hinge': parent link 'bas' does not exist"),
        ('axis xyz="0 0 1"', 'axis xyz="0 0 0"', "line 8: joint 'hinge': the axis is zero"),
        ('axis xyz="0 0 1"', 'axis xyz="0,0,1"', "line 8: 'xyz' of <axis> is '0,0,1', not 3 numbers"),
        ('origin xyz="0 0 1"', 'origin xyz="0 0"', "line 5: 'xyz' of <origin> is '0 0', not 3 numbers"),
        ('origin xyz="0 0 1"', 'origin xyz="$(arg at)"', "line 5: 'xyz' of <origin> is '$(arg at)', not 3 numbers; "
         "expand macros first, `xacro robot.urdf.xacro -o robot.urdf`"),
        ('origin xyz="0 0 1"', 'origin xyz="0 0 inf"', "line 5: 'xyz' of <origin> is '0 0 inf', not 3 numbers"),
        ('lower="-inf"', 'lower="nan"', "line 9: 'lower' of <limit> is 'nan', not a number"),
        ('<box size="1 1 1"/>', "<!-- none -->", "line 2: link 'base': <visual> has no geometry"),
        ('<box size="1 1 1"/>', '<box size="1 1 1"/><sphere radius="1"/>',
         "line 2: link 'base': <visual> has several geometries"),
        ("<box", "<cone", "line 2: <cone> is not a geometry of URDF: <box>, <cylinder>, <capsule>, <sphere>, <mesh>"),
        ('<box size="1 1 1"/>', '<cylinder radius="1"/>', "line 2: <cylinder> without attribute 'length'"),
        ('<child link="tip"/>', '<child link="base"/>', "line 4: joint 'hinge': parent and child are both 'base'"),
        ("</joint>", '</joint><joint name="weld" type="fixed"><parent link="base"/><child link="tip"/></joint>',
         "line 10: link 'tip' is the child of two joints, 'hinge' and 'weld'"),
        ("</joint>", "<mimic/></joint>", "line 10: <mimic> without attribute 'joint'"),
        ("</joint>", '<limit upper="2"/></joint>', "line 10: duplicate <limit> in <joint>, with another content"),
    ],
)  # fmt: skip
def test_faults_have_their_line(old: str, new: str, message: str) -> None:
    """Missing and duplicate names, joints without ends, axes without direction, missing sizes, repeated elements."""
    assert old in ARM
    with pytest.raises(EngineRefused) as caught:
        check_structure(etree.fromstring(ARM.replace(old, new, 1)))
    assert str(caught.value) == message


def test_attributes_of_other_shapes_are_not_read(tmp_path: Path) -> None:
    """What a shape has no use for may be anything, as a radius of a box."""
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.replace('size="1 1 1"', 'size="1 1 1" radius="null"'), encoding="utf-8")
    (shape,) = describe(str(file), "urdf").shapes
    assert shape.geometry == Box((1.0, 1.0, 1.0))
