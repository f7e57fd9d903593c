"""Right descriptions that other programs accept: each converts, and proves against its source."""

import base64
import json
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
import trimesh

from stepbot.engines import engine_of
from stepbot.engines.observation import Request
from stepbot.geometry.mesh_files import read_content
from stepbot.geometry.spatial import Pose
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.robot.closures import driven_joints
from tests.command_line import stepbot

pytestmark = pytest.mark.slow  # each is proven by engines

_INERTIAL = '<inertial><mass value="1"/><inertia ixx="1e-2" iyy="1e-2" izz="1e-2" ixy="0" ixz="0" iyz="0"/></inertial>'
_TURN = """<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" effort="10" velocity="2"/></joint>"""


def urdf(*elements: str) -> str:
    """A robot of an arm with mass that turns on a base, and of further elements."""
    arm = _INERTIAL.replace("<mass", '<origin xyz="0.1 0 0"/><mass')
    return f'<robot name="robot"><link name="arm">{arm}</link>{_TURN}{"".join(elements)}</robot>'


def proven(folder: Path, suffix: str, text: str, *formats: str, base: str = "fixed") -> Conversion:
    """A description converted with proof, without errors."""
    path = folder / f"robot{suffix}"
    path.write_text(text, encoding="utf-8")
    conversion = convert(path, Options(folder / "out", formats=formats, base=base))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    return conversion


def told(conversion: Conversion, code: str) -> list[str]:
    """The messages with a code."""
    return [one.message for one in conversion.diagnostics if one.code == code]


_FRAME = (
    '<link name="tip"><inertial><mass value="1e-9"/>'
    '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="mount" type="{}"><parent link="arm"/><child link="tip"/><origin xyz="0.2 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
)
"""As onshape-to-robot writes a frame: a link with hardly any mass, and no inertia."""


def test_frames_with_a_mass_are_point_masses(tmp_path: Path) -> None:
    """A link with a mass and no inertia on a link with both is physical, in every format."""
    source = urdf(f'<link name="base">{_INERTIAL}</link>', _FRAME.format("fixed"))
    proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf", "usd", "webots")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.body("tip").mass == pytest.approx([1e-9])
    assert not model.body("tip").inertia.any()


@pytest.mark.parametrize(("kind", "mass", "arm"), [("revolute", "1e-9", "1"), ("fixed", "5", "0")])
def test_other_links_need_an_inertia(tmp_path: Path, kind: str, mass: str, arm: str) -> None:
    """One that moves alone, or on links without mass, has an inertia that was forgotten."""
    path, frame = tmp_path / "robot.urdf", _FRAME.format(kind).replace("1e-9", mass)
    source = urdf(f'<link name="base">{_INERTIAL}</link>', frame).replace('value="1"', f'value="{arm}"')
    path.write_text(source, encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out", base="fixed"))
    assert [one.message for one in conversion.diagnostics if one.severity == "error"] == [
        "link 'tip': its inertia is not positive definite: principal moments 0, 0, 0 kg m^2"
    ]


@pytest.mark.parametrize(("mass", "arm"), [("0.001", "1"), ("0.1", "0.06"), ("2e-6", "100")])
def test_small_point_masses_are_named(mass: str, arm: str, tmp_path: Path) -> None:
    """Links of sensors and tools, as of Upkie and TIAGo: possible, but an inertia may have been forgotten."""
    frame = _FRAME.format("fixed").replace("1e-9", mass)
    source = urdf(f'<link name="base">{_INERTIAL}</link>', frame).replace('value="1"', f'value="{arm}"')
    conversion = proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf", "usd", "webots")
    doubt = f"link 'tip': {float(mass):g} kg without inertia is taken as a point mass at its centre of mass"
    assert doubt in told(conversion, "SB518:small-inertia")


@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
def test_xml_of_a_version_that_there_is_not(suffix: str, tmp_path: Path) -> None:
    """PyBullet's own URDF state version 0.0, which simulators do not read, and at which other parsers of XML end."""
    sources = {
        ".urdf": urdf(f'<link name="base">{_INERTIAL}</link>'),
        ".xml": '<mujoco><worldbody><body><joint name="turn"/><geom size="0.1"/></body></worldbody></mujoco>',
    }
    proven(tmp_path, suffix, f'<?xml version="0.0" ?>\n{sources[suffix]}', "urdf", "sdf", "mjcf")


@pytest.mark.parametrize(
    ("suffix", "before"), [(".urdf", "\n\n"), (".urdf", "<!-- by a script -->\n"), (".xml", "\n  \n")]
)
def test_declarations_below_blank_lines_and_comments(suffix: str, before: str, tmp_path: Path) -> None:
    """Simulators read such files; XML does not allow them. MuJoCo reads no comment there."""
    sources = {
        ".urdf": urdf(f'<link name="base">{_INERTIAL}</link>'),
        ".xml": '<mujoco><worldbody><body><joint name="turn"/><geom size="0.1"/></body></worldbody></mujoco>',
    }
    proven(tmp_path, suffix, f'{before}<?xml version="1.0"?>\n{sources[suffix]}', "urdf", "sdf", "mjcf")


def test_empty_switches_of_gazebo(tmp_path: Path) -> None:
    """Gazebo takes an empty `<turnGravityOff>` for false; nothing is lost, and the file was refused."""
    block = '<gazebo reference="arm"><turnGravityOff/><selfCollide></selfCollide></gazebo>'
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}</link>', block), "urdf", "mjcf")
    assert not told(conversion, "SB860")


def test_link_with_collision_and_without_inertial(tmp_path: Path) -> None:
    """It has no mass, as URDF defines, although MuJoCo computes one when it loads the source; and this is reported."""
    base, tool = (
        f'<link name="{name}">{own}<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>'
        for name, own in (("base", _INERTIAL), ("tool", ""))
    )
    mount = '<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>'
    source = urdf(base, tool, mount)
    assert mujoco.MjModel.from_xml_string(source).body_mass.sum() == pytest.approx(2.0)  # 1 kg for the tool
    conversion = proven(tmp_path, ".urdf", source, "urdf", "mjcf")
    assert told(conversion, "SB867") == ["mass properties not given in the file: 'tool'"]
    for file in ("robot.urdf", "robot.xml"):
        model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / file))
        assert model.body_mass.sum() == pytest.approx(2.0 if file.endswith(".xml") else 1.0)


def test_floating_root_without_mass(tmp_path: Path) -> None:
    """PyBullet fixes it in SDFormat: whether the base floats is then not compared, and the report says so."""
    body = f'<link name="base"/><link name="body">{_INERTIAL}</link>'
    mount = (
        '<joint name="mount" type="fixed"><parent link="base"/><child link="body"/><origin xyz="0.1 0 0.2"/></joint>'
    )
    conversion = proven(tmp_path, ".urdf", urdf(body, mount), "sdf", base="floating")
    assert conversion.report is not None
    assert any("PyBullet fixes" in note for notes in conversion.report.notes.values() for note in notes)


def test_servo_without_gains_holds_its_joint(tmp_path: Path) -> None:
    """Gains are computed, and reported; the arm then sags by less than 0.04 rad."""
    servo = """<transmission name="servo"><type>transmission_interface/SimpleTransmission</type>
      <joint name="turn"><hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
      <actuator name="servo"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>"""
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}</link>', servo), "mjcf")
    (message,) = told(conversion, "SB874:gains")
    assert message.startswith("actuator 'servo' on 'turn': no gains in the file: kp = ")
    assert told(conversion, "SB863") == []
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    data = mujoco.MjData(model)
    for _ in range(2000):
        mujoco.mj_step(model, data)
    assert 0.0 < abs(data.joint("turn").qpos[0]) < 0.04


def test_actuator_with_a_gain_of_0_is_lost(tmp_path: Path) -> None:
    """It exerts no force, and MuJoCo has no such position actuator."""
    control = """<ros2_control name="c" type="system"><hardware><plugin>p</plugin></hardware><joint name="turn">
      <command_interface name="position"><param name="kp">0</param></command_interface></joint></ros2_control>"""
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}</link>', control), "mjcf")
    assert told(conversion, "SB863") == ["actuator '' of type 'position' on 'turn' with a gain of 0: not converted"]


def test_slides_with_armature_in_one_body(tmp_path: Path) -> None:
    """The mass matrix of the source is read without its armatures, which MuJoCo adds when it compiles."""
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>'
    source = f"""<mujoco model="robot"><worldbody><body name="base">{inertial}<body name="cart">{inertial}
      <joint name="x" type="slide" axis="1 0 0" armature="0.1"/>
      <joint name="y" type="slide" axis="0 1 0" armature="0.2"/>
      </body></body></worldbody></mujoco>"""
    proven(tmp_path, ".xml", source, "urdf", "mjcf")
    path = str(tmp_path / "robot.xml")
    seen = engine_of("mujoco").observer.observe(Request(path, "mjcf", configurations=({},), simulate=0.0))
    assert seen.dynamics[0].mass_matrix == pytest.approx(np.eye(2), abs=1e-15)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.dof_armature == pytest.approx([0.1, 0.2])


def test_ambient_colour_of_its_own(tmp_path: Path) -> None:
    """It is reported as lost, and not found as a difference again."""
    source = """<sdf version="1.9"><model name="robot"><link name="base">
      <inertial><mass>1</mass><inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia></inertial>
      <visual name="v"><geometry><box><size>0.1 0.1 0.1</size></box></geometry>
      <material><ambient>1 0 0 1</ambient><diffuse>0 1 0 1</diffuse></material></visual></link></model></sdf>"""
    conversion = proven(tmp_path, ".sdf", source, "urdf", "sdf")
    assert told(conversion, "SB860") == ["<ambient> in <material>: not converted"]


WORDLESS = """<mujoco><worldbody><body name="led" mocap="true"/><body name="base">
  <body name="a"><geom size=".1"/><joint name="a" type="ball" range="0 60"/></body>
  <body name="round" pos="1 0 0"><geom type="ellipsoid" size=".1 .2 .3"/><joint name="turn"/></body>
  <body name="hand" pos="2 0 0"><geom size=".05"/><joint name="lift" axis="0 1 0" range="10 60"/></body>
  <body name="strong" pos="3 0 0"><geom size=".1"/><joint name="j" range="-1 1"/></body></body></worldbody>
  <equality><weld body1="led" body2="hand"/></equality>
  <actuator><position name="m" joint="j" kp="1e12" kv="1e10" ctrlrange="-1 1"/></actuator></mujoco>"""
"""A joint with the name of its body has another one in SDFormat, and so have its coordinates. Programs lead the hand by
a body: it moves on its joint, whose limits exclude the pose that the file has."""


def test_what_formats_have_no_word_for(tmp_path: Path) -> None:
    """Cones of ball joints, ellipsoids and leaders are reported, and the rest is proven; stiff gains are in full."""
    assert sorted(told(proven(tmp_path, ".xml", WORDLESS, "urdf", "sdf", "mjcf"), "SB860")) == [
        "attribute 'mocap' of <body>: not converted",
        "equality constraint of a mocap body: not converted",
        "joint 'a': the cone of 1.0472 rad that limits it: not converted",
        *(f"link 'round': {kind} with an ellipsoid: approximated by a mesh" for kind in ("collision", "visual")),
    ]


SDF = '<sdf version="1.9"><model name="m"><link name="a">{}</link>{}</model></sdf>'


def test_geometry_that_is_not_read(tmp_path: Path) -> None:
    """It is reported, and what remains is proven."""
    geometry = "<collision name='c'><geometry><polyline><height>1</height></polyline></geometry></collision>"
    assert told(proven(tmp_path, ".sdf", SDF.format(geometry, ""), "sdf"), "SB860") == [
        "<polyline> in <geometry>: not converted"
    ]


@pytest.mark.parametrize(
    ("shape", "size", "volume"),
    [
        ("an ellipsoid", "<ellipsoid><radii>.1 .2 .3</radii></ellipsoid>", 4.0 / 3.0 * np.pi * 0.006),
        ("a cone", "<cone><radius>.1</radius><length>.3</length></cone>", np.pi * 0.001),
    ],
)
def test_round_shapes_that_a_mesh_approximates(shape: str, size: str, volume: float, tmp_path: Path) -> None:
    """It is reported; the mesh is closed, convex, and has the volume to 3 %."""
    text = SDF.format(f"<collision name='c'><geometry>{size}</geometry></collision>", "")
    conversion = proven(tmp_path, ".sdf", text, "sdf", "mjcf")
    assert told(conversion, "SB860") == [f"link 'a': collision with {shape}: approximated by a mesh"]
    assert not told(conversion, "SB760")  # concave shapes are reported
    (file,) = (tmp_path / "out" / "meshes").glob("*.obj")
    mesh = trimesh.load_mesh(file)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume, rel=0.03)


TWO_AXES = """<link name="b"><pose relative_to="j"/><inertial><mass>.2</mass><inertia><ixx>2e-4</ixx><iyy>2e-4</iyy>
  <izz>1e-4</izz></inertia></inertial></link><joint name="j" type="{}"><pose relative_to="a">0 0 -.1 0 0 0</pose>
  <parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz><limit><lower>-.5</lower><upper>.5</upper><effort>3</effort>
  </limit></axis><axis2><xyz>0 1 0</xyz>{}</axis2></joint>"""


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
@pytest.mark.parametrize(
    ("second", "bounds"),
    [
        ("<limit><lower>-.6</lower><upper>.7</upper><effort>4</effort></limit>", ("-0.6", "0.7", "4")),
        ("<limit><lower>-.5</lower><upper>.5</upper><effort>3</effort></limit>", ("-0.5", "0.5", "3")),
        ("<dynamics><damping>.2</damping></dynamics>", None),
    ],
)
def test_universal_joint_with_limits(kind: str, second: str, bounds: tuple[str, ...] | None, tmp_path: Path) -> None:
    """It becomes two hinges with the limits of their axes, since the universal joint of the model has none."""
    proven(tmp_path, ".sdf", SDF.format("", TWO_AXES.format(kind, second)), "urdf", "sdf", "mjcf")
    joints = {one.get("name"): one for one in ET.parse(tmp_path / "out" / "m.urdf").iter("joint")}
    limits = {name: one.find("limit") for name, one in joints.items()}
    found = {
        name: None if one is None else tuple(one.get(key) for key in ("lower", "upper", "effort"))
        for name, one in limits.items()
    }
    assert found == {"j_1": ("-0.5", "0.5", "3"), "j_2": bounds}
    assert {name: one.get("type") for name, one in joints.items()} == {
        "j_1": "revolute",
        "j_2": "revolute" if bounds else "continuous",
    }


def test_gearbox_between_two_turning_links(tmp_path: Path) -> None:
    """It is refused, and not taken for a hinge that closes a loop."""
    joints = [
        f"<link name='{child}'/><joint name='{child}_joint' type='{kind}'><parent>{parent}</parent>"
        f"<child>{child}</child><axis><xyz>0 0 1</xyz></axis></joint>"
        for parent, child, kind in (("a", "b", "revolute"), ("a", "c", "revolute"))
    ]
    gear = (
        "<joint name='gear' type='gearbox'><parent>b</parent><child>c</child><axis><xyz>0 0 1</xyz></axis>"
        "<axis2><xyz>0 0 1</xyz></axis2><gearbox_ratio>2</gearbox_ratio></joint>"
    )
    path = tmp_path / "robot.sdf"
    path.write_text(SDF.format("", "".join([*joints, gear])), encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out"))
    (text,) = told(conversion, "SB861")
    assert text.startswith("closure 'gear' of type 'gearbox' between '")


def test_geom_that_is_visual_and_collision(tmp_path: Path) -> None:
    """SDFormat allows no two elements of a link with one name: libsdformat rejects the file."""
    body = '<body name="base"><freejoint/><geom name="g" type="sphere" size="0.1"/></body>'
    source = f'<mujoco model="robot"><worldbody>{body}</worldbody></mujoco>'
    proven(tmp_path, ".xml", source, "sdf", "urdf", base="")
    for model in ET.parse(tmp_path / "out" / "robot.sdf").iter("model"):
        for parent in (model, *model.iter("link")):
            names = Counter(one.get("name") for one in parent if one.get("name"))
            assert set(names.values()) <= {1}, names
    assert {one.get("name") for one in ET.parse(tmp_path / "out" / "robot.sdf").iter("collision")} == {"g_geom"}


def test_repeated_names_are_noticed_without_libsdformat(tmp_path: Path) -> None:
    """stepbot's own reader warns of them, which fails the proof of a file that stepbot writes."""
    path = tmp_path / "robot.sdf"
    shape = '<{0} name="g"><geometry><sphere><radius>1</radius></sphere></geometry></{0}>'
    shapes = shape.format("visual") + shape.format("collision")
    path.write_text(f'<sdf version="1.9"><model name="m"><link name="base">{shapes}</link></model></sdf>', "utf-8")
    seen = engine_of("reader").observer.observe(Request(str(path), "sdf", simulate=0.0))
    assert seen.warnings == ("link 'base': 2 elements named 'g'",)


TRIANGLES = (
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4").tobytes()
    + np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], "<u2").tobytes()
)


def gltf(uri: str) -> str:
    """A tetrahedron of 1/6 m^3 whose triangles are in a buffer."""
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}]
    content = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0] * 3, "max": [1] * 3},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"uri": uri, "byteLength": 72}],
    }
    return json.dumps(content)


def test_gltf_with_its_triangles_in_another_file(tmp_path: Path) -> None:
    """The buffer is read, and is an input of the conversion."""
    (tmp_path / "a part.bin").write_bytes(TRIANGLES)
    (tmp_path / "part.gltf").write_text(gltf("a%20part.bin"), encoding="utf-8")
    visual = '<visual><geometry><mesh filename="part.gltf"/></geometry></visual>'
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}{visual}</link>'), "mjcf")
    assert conversion.report is not None
    assert set(conversion.report.inputs) == {"robot.urdf", "part.gltf", "a part.bin"}
    assert (tmp_path / "out" / "meshes" / "part.obj").is_file()


def test_only_files_beside_a_gltf_are_its_buffers(tmp_path: Path) -> None:
    """A buffer may be in the file itself; one outside of its folder is not opened."""
    folder = tmp_path / "meshes"
    folder.mkdir()
    (tmp_path / "part.bin").write_bytes(TRIANGLES)
    path = folder / "part.gltf"
    path.write_text(gltf("../part.bin"), encoding="utf-8")
    assert read_content(path) is None
    path.write_text(gltf(f"data:application/octet-stream;base64,{base64.b64encode(TRIANGLES).decode()}"), "utf-8")
    content = read_content(path)
    assert content is not None
    assert len(content.mesh.faces) == 4
    assert content.buffers == ()


_NO_LIMITS = {
    "slow": 'lower="-1" upper="1" effort="10" velocity="0"',
    "weak": 'lower="-1" upper="1" effort="0" velocity="0"',
    "bare": 'lower="-1" upper="1"',
    "strong": 'lower="-1" upper="1" effort="10"',
    "rotor": 'lower="-1e16" upper="1e16" effort="0" velocity="0"',
}
"""Limits by joint: zeros as the SolidWorks exporter states them, none, and the stops of a rotor as Gazebo writes it."""


def test_limits_that_are_none(tmp_path: Path) -> None:
    """Nothing would move at limits of 0, which MuJoCo, PyBullet and MoveIt ignore; URDF requires the others.

    Engines report no limit between endless stops. A servo has its inputs from what remains.
    """
    servo = """<transmission name="{0}"><type>transmission_interface/SimpleTransmission</type>
      <joint name="{0}"><hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
      <actuator name="{0}"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>"""
    parts = [f'<link name="base">{_INERTIAL}</link>', servo.format("slow"), servo.format("weak")]
    for name, limit in _NO_LIMITS.items():
        turn = _TURN.replace("turn", name).replace('"arm"', f'"{name}_arm"')
        parts.append(turn.replace('lower="-1" upper="1" effort="10" velocity="2"', limit))
        parts.append(f'<link name="{name}_arm">{_INERTIAL}</link>')
    conversion = proven(tmp_path, ".urdf", urdf(*parts), "urdf", "sdf", "mjcf")
    zeros = {"slow": "velocity", "weak": "velocity and effort", "rotor": "velocity and effort"}
    assert told(conversion, "SB874:limit") == [
        f"joint '{name}': {zero} limit of 0, at which nothing moves: read as unlimited" for name, zero in zeros.items()
    ]
    written = ET.parse(tmp_path / "out" / "robot.urdf").getroot()
    joints = {one.get("name", ""): one for one in written.findall("joint")}
    assert {name: joints[name].get("type") for name in _NO_LIMITS} == {
        name: "continuous" if name == "rotor" else "revolute" for name in _NO_LIMITS
    }
    limits = [limit for name in _NO_LIMITS for limit in joints[name].iter("limit")]
    assert all(float(limit.get("velocity", "")) >= 1e9 for limit in limits)


def test_names_that_are_one_or_missing(tmp_path: Path) -> None:
    """URDF identifies collisions by their order; the written ones have names of their own, and the same places.

    Formats without capsules have three shapes for each, which together are one of the source. Of materials of one name
    a colour of its own counts, and else the first of the name, as in ROS; PyBullet takes the last.
    """
    spheres = "".join(
        f'<collision name="c"><origin xyz="{x} 0 0"/><geometry><sphere radius="{r}"/></geometry></collision>'
        for x, r in ((0.1, 0.05), (0.3, 0.04), (0.6, 0.03))
    )
    capsules = "".join(
        f'<collision><origin xyz="{x} 0 0"/><geometry><capsule radius="0.07" length="0.1"/></geometry></collision>'
        for x in (0.1, 0.4)
    )
    box = '<visual name="v{}"><origin xyz="0 0 {}"/><geometry><box size="0.1 0.1 0.1"/></geometry>{}</visual>'
    own = '<material name="black"><color rgba="0 0 0 0.9"/></material>'
    boxes = "".join(box.format(n, n, one) for n, one in enumerate(['<material name="black"/>', own]))
    material = '<material name="black"><color rgba="0 0.1 0 1"/></material>'
    source = urdf(material, f'<link name="base">{_INERTIAL}{boxes}{spheres}</link>')
    proven(tmp_path, ".urdf", source.replace("</link>", f"{capsules}</link>", 1), "urdf", "sdf", "mjcf")
    written = ET.parse(tmp_path / "out" / "robot.urdf").getroot()
    shapes = [shape for collision in written.iter("collision") for shape in collision.find("geometry") or ()]
    radii = [float(shape.get("radius", "")) for shape in shapes if shape.tag == "sphere"]
    assert sorted(radii) == [0.03, 0.04, 0.05, *[0.07] * 4]
    assert Counter(shape.tag for shape in shapes) == {"cylinder": 2, "sphere": 7}
    assert len({one.get("name") for one in written.iter("collision")}) == 9
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    colors = {model.geom(n).name: model.geom_rgba[n].tolist() for n in range(model.ngeom)}
    assert [colors[name] for name in ("v0", "v1")] == [pytest.approx([0, 0.1, 0, 1]), pytest.approx([0, 0, 0, 0.9])]


def test_light_link_far_from_a_heavy_root(tmp_path: Path) -> None:
    """MuJoCo computes with distances from the common centre of mass: m r^2 of the link is rounded, not its inertia."""
    base = _INERTIAL.replace('"1"', '"1e6"').replace("1e-2", "1e4")
    source = urdf(f'<link name="base">{base}</link>').replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><origin xyz="1000 0 0"/>'
    )
    proven(
        tmp_path, ".urdf", source.replace('<mass value="1"/>', '<mass value="1e-3"/>').replace("1e-2", "1e-6"), "mjcf"
    )


def test_payload_that_lies_on_a_moving_link(tmp_path: Path) -> None:
    """A floating joint connects nothing: what lies on a tray collides with it, in MJCF, too."""
    box = "<geometry><box size='0.1 0.1 0.1'/></geometry>"
    base, tray, load = (
        f'<link name="{name}">{_INERTIAL}<collision>{box}</collision></link>' for name in ("base", "tray", "load")
    )
    joints = """<joint name="hold" type="fixed"><parent link="arm"/><child link="tray"/><origin xyz="0 0 1"/></joint>
      <joint name="free" type="floating"><parent link="tray"/><child link="load"/><origin xyz="0 0 0.099"/></joint>"""
    proven(tmp_path, ".urdf", urdf(base, tray, load, joints), "mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = [{model.geom(geom).name for geom in contact.geom} for contact in data.contact]
    assert {"tray_collision", "load_collision"} in names


def test_one_name_for_the_collisions_of_all_links(tmp_path: Path) -> None:
    """As in most models of Gazebo; a continuous joint ignores the limits that its axis states.

    SDFormat keeps the names; MuJoCo, where they are unique in the file, gets the link's with them. A sun is no robot.
    """
    inertial = "<inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>"
    shape = "<geometry><box><size>.1 .1 .1</size></box></geometry>"
    shapes = f'<visual name="visual">{shape}</visual><collision name="collision">{shape}</collision>'
    links = "".join(
        f'<link name="{one}"><pose>0 0 {z} 0 0 0</pose>{inertial}{shapes}</link>' for z, one in enumerate("abc")
    )
    joints = "".join(
        f'<joint name="{child}" type="continuous"><parent>{parent}</parent><child>{child}</child><axis><xyz>0 0 1</xyz>'
        "<limit><lower>-1</lower><upper>1</upper></limit></axis></joint>"
        for parent, child in ("ab", "bc")
    )
    around = "<include><uri>model://sun</uri></include>"
    world = f'<world name="w">{around}<model name="robot">{links}{joints}</model></world>'
    conversion = proven(tmp_path, ".sdf", f'<sdf version="1.7">{world}</sdf>', "urdf", "sdf", "mjcf")
    assert "<include> in <world>: not converted" in told(conversion, "SB860")
    written = ET.parse(tmp_path / "out" / "robot.sdf").getroot()
    assert [one.get("name") for one in written.iter("collision")] == ["collision"] * 3
    compiled = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    names = {compiled.geom(i).name for i in range(compiled.ngeom)}
    assert names == {f"{kind}{link}" for kind in ("visual", "collision") for link in ("", "_b", "_c")}
    robot = ET.parse(tmp_path / "out" / "robot.urdf").getroot()
    assert [joint.get("type") for joint in robot.iter("joint")] == ["continuous", "continuous"]


def test_joint_between_frames(tmp_path: Path) -> None:
    """SDFormat joins frames as well as links: the pose of the joint is relative to the child that the file names."""
    inertial = "<inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>"
    model = f"""<sdf version="1.9"><model name="robot"><link name="a">{inertial}</link>
      <link name="b"><pose>1 2 3 0 0 0</pose>{inertial}</link>
      <frame name="of_a" attached_to="a"><pose>0 0 5 0 0 0</pose></frame>
      <frame name="of_b" attached_to="b"><pose>0.5 0 0 0 0 1.5707963267948966</pose></frame>
      <frame name="below" attached_to="of_b"><pose>0 0.25 0 0 0 0</pose></frame>
      <joint name="turn" type="revolute"><parent>of_a</parent><child>below</child><axis><xyz>1 0 0</xyz>
      <limit><lower>-1</lower><upper>1</upper></limit></axis></joint></model></sdf>"""
    proven(tmp_path, ".sdf", model, "mjcf")
    compiled = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    turn = compiled.joint("turn").id
    assert np.allclose(data.xaxis[turn], [0.0, 1.0, 0.0], atol=1e-12)  # x of `of_b`, a quarter turn about z
    assert np.allclose(data.xanchor[turn] - data.body("a").xpos, [1.25, 2.0, 3.0], atol=1e-12)  # y of `of_b` is -x


def test_files_included_below_the_root(tmp_path: Path) -> None:
    """MJCF includes files anywhere: what they state counts as stated there, and nothing of it is lost."""
    (tmp_path / "robot.xml").write_text(
        '<mujoco model="robot"><worldbody><include file="base.xml"/></worldbody></mujoco>', encoding="utf-8"
    )
    base = '<body name="base"><geom size=".1"/><body name="arm" pos="0 0 .3"><include file="arm.xml"/></body></body>'
    (tmp_path / "base.xml").write_text(f"<mujocoinclude>{base}</mujocoinclude>", encoding="utf-8")
    arm = '<joint name="j" axis="0 1 0"/><geom size=".03" margin=".001"/>'
    (tmp_path / "arm.xml").write_text(f"<mujocoinclude>{arm}</mujocoinclude>", encoding="utf-8")
    conversion = convert(tmp_path / "robot.xml", Options(tmp_path / "out", formats=("mjcf",), verify=False))
    lost = [(one.span.file.rpartition("/")[2], one.message) for one in conversion.diagnostics if one.code == "SB860"]
    assert lost[0] == ("arm.xml", "attribute 'margin' of <geom>: not converted")
    assert not [message for _, message in lost if "include" in message or "<" in message[0]]


def _colored_mesh(path: Path) -> None:
    """Two boxes, red and blue, beside each other."""
    scene = trimesh.Scene()
    for x, color in ((0.0, (200, 0, 0, 255)), (0.3, (0, 0, 200, 255))):
        box = trimesh.creation.box((0.1, 0.2, 0.3), Pose.of(position=(x, 0.0, 0.0)).matrix)
        box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(baseColorFactor=color))
        scene.add_geometry(box)
    path.write_bytes(scene.export(file_type="glb"))


@pytest.mark.parametrize("suffix", [".urdf", ".sdf"])
def test_mesh_of_several_colours(suffix: str, tmp_path: Path) -> None:
    """A visual for each colour of a mesh is, to the proof, the one visual of the source, whatever else a link has."""
    _colored_mesh(tmp_path / "part.glb")
    tag = "<mesh filename='part.glb'/>" if suffix == ".urdf" else "<mesh><uri>part.glb</uri></mesh>"
    size = "<sphere radius='0.2'/>" if suffix == ".urdf" else "<sphere><radius>0.2</radius></sphere>"
    name = iter(range(9))

    def visual(shape: str) -> str:
        return f"<visual name='v{next(name)}'><geometry>{shape}</geometry></visual>"

    arm, base = visual(tag) + visual(size) + visual(tag), visual(size) + visual(tag)
    if suffix == ".urdf":
        text = urdf(f'<link name="base">{_INERTIAL}{base}</link>').replace("</link>", f"{arm}</link>", 1)
    else:
        inertial = "<inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>"
        links = f"<link name='base'>{inertial}{base}</link><link name='arm'>{inertial}{arm}</link>"
        turn = "<joint name='turn' type='revolute'><parent>base</parent><child>arm</child><axis><xyz>0 1 0</xyz></axis>"
        text = f"<sdf version='1.9'><model name='robot'>{links}{turn}</joint></model></sdf>"
    proven(tmp_path, suffix, text, "urdf", "sdf", "mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.ngeom == 2 * 3 + 2  # three meshes of two colours, two spheres


def test_several_frictions_on_one_link(tmp_path: Path) -> None:
    """URDF has one for a link, which is a declared loss and no difference from the source."""
    geoms = '<geom size="0.1" friction="1 0.01 0.01"/><geom pos="0.2 0 0" size="0.05" friction="0.5 0.005 0.0001"/>'
    turn = f'<body name="arm" pos="0 0 0.5"><joint name="turn" axis="0 1 0"/>{geoms}</body>'
    text = f'<worldbody><body name="base"><geom size="0.1"/>{turn}</body></worldbody>'
    proven(tmp_path, ".xml", f'<mujoco model="robot">{text}</mujoco>', "urdf", "sdf", "mjcf")


_SOLID = f'<link name="base">{{}}{_INERTIAL}<collision><geometry><sphere radius="0.1"/></geometry></collision></link>'


@pytest.mark.parametrize("stated", ["rolling_friction", "spinning_friction", "lateral_friction", "restitution"])
def test_a_single_contact_property(stated: str, tmp_path: Path) -> None:
    """Robots for PyBullet state one; what PyBullet takes for the others is not theirs, and MJCF has other values."""
    contact = f'<contact><{stated} value="0.03"/></contact>'
    source = urdf(_SOLID.format(contact))
    proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")
    (tmp_path / "bare.urdf").write_text(source.replace(contact, ""))
    assert stepbot("diff", "robot.urdf", "bare.urdf", cwd=tmp_path).code == 1
    (tmp_path / "same.urdf").write_text(source.replace("0.03", "3e-2"))
    assert stepbot("diff", "robot.urdf", "same.urdf", cwd=tmp_path).code == 0


@pytest.mark.parametrize("contact", ["", '<contact><rolling_friction value="0.01"/></contact>'])
def test_friction_for_gazebo_alone(contact: str, tmp_path: Path) -> None:
    """Robots for Gazebo state `mu1`: what PyBullet takes without `<lateral_friction>` is not the robot's."""
    gazebo = '<gazebo reference="base"><mu1>0.62</mu1></gazebo>'
    proven(tmp_path, ".urdf", urdf(_SOLID.format(contact) + gazebo), "urdf", "sdf", "mjcf")
    written = (tmp_path / "out" / "robot.urdf").read_text(encoding="utf-8")
    assert "<mu1>0.62</mu1>" in written
    assert '<lateral_friction value="0.62"/>' in written


def test_a_command_interface_of_a_follower(tmp_path: Path) -> None:
    """Grippers claim mimic joints, too: what follows has no gains, and MuJoCo took 0 for a motor."""
    finger = f'<link name="{{0}}">{_INERTIAL}</link><joint name="to_{{0}}" type="prismatic"><parent link="base"/>'
    finger += (
        '<child link="{0}"/><axis xyz="0 {1} 0"/><limit lower="0" upper="0.04" effort="20" velocity="0.1"/>{2}</joint>'
    )
    mimic = '<mimic joint="to_left"/>'
    claims = "".join(
        f'<joint name="to_{one}"><command_interface name="position"/></joint>' for one in ("left", "right")
    )
    control = (
        f'<ros2_control name="hand" type="system"><hardware><plugin>a/B</plugin></hardware>{claims}</ros2_control>'
    )
    fingers = finger.format("left", 1, "") + finger.format("right", -1, mimic)
    proven(tmp_path, ".urdf", urdf(_SOLID.format("") + fingers + control), "urdf", "sdf", "mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert [model.actuator(n).name for n in range(model.nu)] == ["to_left_position"]


def test_two_contacts_of_one_link(tmp_path: Path) -> None:
    """PyBullet reads the first one, and of each property the first in it."""
    twice = '<contact><restitution value="0.2"/><restitution value="0.3"/></contact>'
    source = urdf(_SOLID.format(twice + '<contact><restitution value="0.4"/><lateral_friction value="0.9"/></contact>'))
    proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")
    written = (tmp_path / "out" / "robot.urdf").read_text(encoding="utf-8")
    assert '<restitution value="0.2"/>' in written
    assert "lateral_friction" not in written


@pytest.mark.parametrize("second", ["", '<joint name="slide" type="slide" springref="-0.4"/>'], ids=["one", "two"])
def test_a_rest_without_a_spring(second: str, tmp_path: Path) -> None:
    """A spring reference without stiffness moves nothing, and is not written; also of several joints in one body."""
    turn = f'{second}<joint name="turn" axis="0 1 0" springref="0.4"/><geom size="0.1"/>'
    turn = f'<body name="arm" pos="0 0 0.5">{turn}</body>'
    text = f'<worldbody><body name="base"><geom size="0.1"/>{turn}</body></worldbody>'
    proven(tmp_path, ".xml", f'<mujoco model="robot">{text}</mujoco>', "urdf", "sdf", "mjcf")


def test_sensors_of_one_name_are_those_of_their_joints(tmp_path: Path) -> None:
    """SDFormat names sensors within their joint or link: a file equals its copy, and not one with two exchanged."""
    moments = "".join(f"<{one}>0.01</{one}>" for one in ("ixx", "iyy", "izz"))
    link = f'<link name="{{}}"><inertial><mass>1</mass><inertia>{moments}</inertia></inertial></link>'
    joint = (
        '<joint name="{0}" type="revolute"><parent>{1}</parent><child>{2}</child><axis><xyz>0 0 1</xyz><limit>'
        "<lower>-1</lower><upper>1</upper></limit></axis>"
        '<sensor name="wrench" type="force_torque"><update_rate>{3}</update_rate></sensor></joint>'
    )

    def text(*rates: int) -> str:
        joints = [joint.format(name, *ends, rate) for name, ends, rate in zip("ab", ("xy", "yz"), rates, strict=True)]
        return f'<sdf version="1.9"><model name="m">{"".join(map(link.format, "xyz"))}{"".join(joints)}</model></sdf>'

    for name, rates in {"one": (30, 40), "copy": (30, 40), "other": (40, 30)}.items():
        (tmp_path / f"{name}.sdf").write_text(text(*rates))
    assert stepbot("diff", "one.sdf", "copy.sdf", cwd=tmp_path).code == 0
    assert stepbot("diff", "one.sdf", "other.sdf", cwd=tmp_path).code == 1


_FOLDED = (  # position, height of the com, mass, moments, axis, and half sizes of each link of a chain
    ((-0.145, -0.084, 0.003), 0.024, 0.787, 0.00732, "0 0 1", (0.078, 0.089, 0.045)),
    ((-0.026, -0.121, 0.075), 0.096, 1.52, 9.03e-07, "0 1 0", (0.068, 0.157, 0.061)),
    ((-0.037, -0.094, -0.01), 0.084, 0.0219, 0.000184, "0 0 1", (0.095, 0.109, 0.181)),
    ((-0.148, 0.094, -0.045), 0.094, 0.0338, 3.99e-06, "1 0 0", (0.094, 0.128, 0.16)),
    ((-0.07, -0.091, -0.069), -0.032, 0.308, 1.52e-05, "1 0 0", (0.047, 0.03, 0.033)),
)


def _folded() -> str:
    """A URDF of light links that are in one another, as humanoids' convex hulls are."""
    box = '<collision><geometry><box size="{} {} {}"/></geometry></collision>'
    links = [f'<link name="link_0">{_INERTIAL}{box.format(0.4, 0.4, 0.4)}</link>']
    for n, (at, height, mass, moment, axis, half) in enumerate(_FOLDED, start=1):
        body = f'<mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/>'
        links.append(
            f'<link name="link_{n}"><inertial><origin xyz="0 0 {height}"/>{body}</inertial>'
            f'{box.format(*(2 * one for one in half))}</link><joint name="joint_{n}" type="continuous">'
            f'<parent link="link_{n - 1}"/><child link="link_{n}"/><origin xyz="{at[0]} {at[1]} {at[2]}"/>'
            f'<axis xyz="{axis}"/></joint>'
        )
    return f'<robot name="folded">{"".join(links)}</robot>'


def test_links_that_start_in_one_another(tmp_path: Path) -> None:
    """A URDF states no contacts: those that would burst the robot are excluded, and named; an MJCF's are its own."""
    path = tmp_path / "folded.urdf"
    path.write_text(_folded(), encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out", formats=("urdf", "mjcf"), base="fixed"))
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    (message,) = told(conversion, "SB874:contacts")
    excluded = ET.parse(tmp_path / "out" / "folded.xml").findall("contact/exclude")
    pairs = {(str(one.get("body1")), str(one.get("body2"))) for one in excluded} - {("link_0", "link_1")}  # adjacent
    assert pairs
    assert all(f"'{a}' and '{b}'" in message for a, b in pairs)
    model = mujoco.MjSpec.from_file(str(tmp_path / "out" / "folded.xml"))
    for one in [one for one in model.excludes if (one.bodyname1, one.bodyname2) in pairs]:
        model.delete(one)
    (tmp_path / "burst.xml").write_text(model.to_xml(), encoding="utf-8")
    again = convert(tmp_path / "burst.xml", Options(tmp_path / "again", formats=("mjcf",)))
    assert "SB811" in {one.code for one in again.diagnostics}
    assert not told(again, "SB874:contacts")


@pytest.mark.parametrize(("step", "failed"), [("2 ms", {"SB811"}), ("0.1 ms", set())])
def test_a_urdf_is_simulated_with_the_time_step_of_the_sidecar(step: str, failed: set[str], tmp_path: Path) -> None:
    """A URDF states none: the remedy for a chain of light links with a heavy end is that of the sidecar."""
    links = ['<link name="link_0"/>']
    for n, mass in enumerate((1e-4, 1e-4, 1e-4, 1e-4, 1.0), start=1):
        diagonal = " ".join(f'{key}="{1e-4 * mass}"' for key in ("ixx", "iyy", "izz"))
        links.append(
            f'<link name="link_{n}"><inertial><origin xyz="0.05 0 0"/><mass value="{mass}"/>'
            f'<inertia {diagonal} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint_{n}" type="continuous"><parent link="link_{n - 1}"/><child link="link_{n}"/>'
            '<origin xyz="0.1 0 0"/><axis xyz="0 1 0"/></joint>'
        )
    (tmp_path / "chain.urdf").write_text(f'<robot name="chain">{"".join(links)}</robot>', encoding="utf-8")
    sidecar = tmp_path / "chain.robot.yaml"
    text = "version: 1\nrobot: chain\nbase: fixed\nmodules: {m: {file: chain.urdf}}\n"
    sidecar.write_text(f"{text}simulation: {{timestep: {step}}}\n", encoding="utf-8")
    conversion = convert(sidecar, Options(tmp_path / "out", formats=("urdf",)))
    assert {one.code for one in conversion.diagnostics if one.severity == "error"} == failed


def test_a_flat_collision_mesh_is_left_out_where_mujoco_rejects_it(tmp_path: Path) -> None:
    """A printed marker of two triangles, as on Stretch: MuJoCo loads no file with it, and the loss is reported."""
    text = "v 0 0 0\nv 0.06 0 0\nv 0.06 0.06 0\nv 0 0.06 0\nf 1 2 3\nf 1 3 4\n"
    (tmp_path / "marker.obj").write_text(text, encoding="utf-8")
    mesh = '<geometry><mesh filename="marker.obj"/></geometry>'
    marker = f'<link name="marker">{_INERTIAL}<visual>{mesh}</visual><collision>{mesh}</collision></link>'
    mount = '<joint name="mount" type="fixed"><parent link="arm"/><child link="marker"/><origin xyz="0 0 0.2"/></joint>'
    source = urdf(f'<link name="base">{_INERTIAL}</link>', f"{marker}{mount}")
    conversion = proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")
    assert len(told(conversion, "SB760:flat-collision")) == 2  # of URDF and MJCF
    assert conversion.robot is not None
    assert len(conversion.robot.link_by_name["marker"].collisions) == 1


def test_planes_of_bodies(tmp_path: Path) -> None:
    """A plane of a body is named as not converted, and what remains is proven."""
    source = """<mujoco model="robot"><worldbody><body name="floor"><geom type="plane" size="1 1 1"/>
      <body name="arm"><joint name="turn" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom name="box" type="box" size=".1 .1 .1"/></body></body></worldbody></mujoco>"""
    conversion = proven(tmp_path, ".xml", source, "urdf", "sdf", "mjcf")
    assert told(conversion, "SB860") == ["planes in <body>: not converted"]
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml")).geom("box").bodyid == [2]


@pytest.mark.parametrize("joint", ["revolute", "fixed"])
def test_moments_below_those_of_mujoco(joint: str, tmp_path: Path) -> None:
    """A pendulum that means a point mass has moments that MuJoCo rejects: they are raised, and reported."""
    tiny = _INERTIAL.replace("1e-2", "1e-20")
    tip = f'<link name="tip">{tiny}</link>' + _FRAME.format(joint).partition("</link>")[2]
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}</link>', tip), "urdf", "mjcf")
    assert told(conversion, "SB866") == ["link 'tip': principal moment of 1e-20 kg m^2: 1e-14 added about each axis"]
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml")).body("tip").inertia.min() >= 1e-14


@pytest.mark.parametrize("moment", ["1e-5", "3", "200"])
def test_a_rod_without_thickness(moment: str, tmp_path: Path) -> None:
    """Two moments are equal and the third is 0: engines reject that, and get two billionths of the others."""
    rod = _INERTIAL.replace("1e-2", moment).replace(f'izz="{moment}"', 'izz="0"')
    assert rod.count(f'"{moment}"') == 2
    tip = f'<link name="tip">{rod}</link>' + _FRAME.format("revolute").partition("</link>")[2]
    conversion = proven(tmp_path, ".urdf", urdf(f'<link name="base">{_INERTIAL}</link>', tip), "urdf", "sdf", "mjcf")
    assert len(told(conversion, "SB866")) == 1
    least, middle, largest = sorted(
        mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml")).body("tip").inertia
    )
    assert 0.0 < least < 3e-9 * largest
    assert [middle, largest] == pytest.approx([float(moment)] * 2, rel=3e-9)


_ONES = '<inertial><mass value="1e-6"/><inertia {}/></inertial>'.format(
    " ".join(f'{name}="1e-6"' for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
)


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_an_impossible_inertia_of_a_root_for_programs_that_need_one(base: str, tmp_path: Path) -> None:
    """Quadrupeds have one: the trunk that it is fixed to gets its inertia, turned, and the body has the same."""
    trunk = f'<link name="trunk">{_INERTIAL}</link><joint name="hold" type="fixed"><parent link="base"/>'
    trunk += '<child link="trunk"/><origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/></joint>'
    source = urdf(f'<link name="base">{_ONES}</link>', trunk)
    conversion = proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf", base=base)
    (text,) = told(conversion, "SB866")
    assert text.startswith("link 'base': its inertia is not positive definite: principal moments ")
    assert text.endswith(": added to that of 'trunk', which it is fixed to")
    assert not told(conversion, "SB518:small-inertia")
    assert conversion.robot is not None
    ((xx, xy, _), (_, yy, _), _) = conversion.robot.link_by_name["trunk"].mass_properties.inertia
    assert [xx, yy, xy] == pytest.approx([1e-2 + 1e-6, 1e-2 + 1e-6, -1e-6], rel=1e-9)


def test_an_impossible_inertia_of_a_link_that_matters(tmp_path: Path) -> None:
    """A link of a tenth of the mass, or one on a joint, has an inertia that was mistaken: an error, as before."""
    for mass, kind in (("0.1", "fixed"), ("1e-6", "revolute")):
        tip = f'<link name="tip">{_ONES.replace("1e-6", mass, 1)}</link>' + _FRAME.format(kind).partition("</link>")[2]
        (tmp_path / "robot.urdf").write_text(urdf(f'<link name="base">{_INERTIAL}</link>', tip), encoding="utf-8")
        conversion = convert(tmp_path / "robot.urdf", Options(tmp_path / "out", base="fixed"))
        assert [one.code for one in conversion.diagnostics if one.severity == "error"] == ["SB509"]


def test_passive_forces_of_a_free_joint(tmp_path: Path) -> None:
    """A free joint of type `free` has those of the defaults, too; no other format has them, and they are named."""
    source = """<mujoco model="robot"><default><joint damping="1" armature=".1"/></default><worldbody>
      <body name="top"><joint type="free" stiffness="5"/><geom size=".1"/></body></worldbody></mujoco>"""
    conversion = proven(tmp_path, ".xml", source, "urdf", "mjcf")
    lost = "'stiffness' and 'damping' and 'armature' of a free joint: not converted"
    assert told(conversion, "SB860") == [lost]
    plain = source.replace('<joint type="free" stiffness="5"/>', "<freejoint/>")
    assert not told(proven(tmp_path, ".xml", plain, "urdf", "mjcf"), "SB860")


_FINGER = """<mujoco model="robot"><compiler angle="radian"/><worldbody><body name="palm">{inertial}
  <body name="near" pos=".1 0 0"><joint name="near" axis="0 1 0" ref=".1"/>{inertial}
  <body name="far" pos=".1 0 0"><joint name="far" axis="0 1 0" ref=".2"/>{inertial}
  <body name="tip" pos=".1 0 0"><joint name="tip" axis="0 1 0"/>{inertial}</body></body></body></body></worldbody>
  <tendon><fixed name="two"><joint joint="near" coef="1.5"/><joint joint="far" coef="-.5"/></fixed>
  <fixed name="one"><joint joint="far" coef="2"/></fixed><fixed name="last"><joint joint="tip" coef="4"/></fixed>
  <fixed name="all"><joint joint="near" coef="1"/><joint joint="far" coef="1"/><joint joint="tip" coef="1"/></fixed>
  </tendon><equality>{equalities}</equality><actuator><motor name="pull" joint="far"/></actuator></mujoco>"""
"""A finger of three joints, as hands couple them; those at their references have them as initial positions."""
_BODY = '<inertial pos=".05 0 0" mass="1" diaginertia=".01 .01 .01"/>'


def test_joints_coupled_by_tendons(tmp_path: Path) -> None:
    """Tendons of two joints in equalities are mimics: the joint without motor follows, as MuJoCo holds it."""
    couplings = (
        '<tendon tendon1="two" polycoef=".3 1 0 0 0"/><tendon tendon1="last" tendon2="one" polycoef="0 .5 0 0 0"/>'
    )
    proven(tmp_path, ".xml", _FINGER.format(inertial=_BODY, equalities=couplings), "urdf", "mjcf")
    read = {one.get("name"): one.find("mimic") for one in ET.parse(tmp_path / "out" / "robot.urdf").iter("joint")}
    assert read["far"] is None
    for follower, multiplier, offset in (("near", 1.0 / 3.0, 0.1 - 0.2 / 3.0 + 0.2), ("tip", 0.25, -0.05)):
        mimic = read[follower]
        assert mimic is not None
        assert mimic.get("joint") == "far"
        assert [float(mimic.get(name, "0")) for name in ("multiplier", "offset")] == pytest.approx([multiplier, offset])
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = [0.5 / 3.0 + 0.1 - 0.2 / 3.0 + 0.2, 0.5, 0.25 * 0.5 - 0.05]
    mujoco.mj_forward(model, data)
    assert data.efc_pos[: data.ne] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_tendons_that_hold_three_joints_are_a_loss(tmp_path: Path) -> None:
    """As of dm_control's quadruped: no other format states such a relation, and the report says what moves freely."""
    source = _FINGER.format(inertial=_BODY, equalities='<tendon name="e" tendon1="all"/>')
    conversion = proven(tmp_path, ".xml", source, "urdf", "sdf", "mjcf")
    assert "<tendon> in <equality>: not converted" in told(conversion, "SB860")
    assert any("e: the joints move independently" in note for one in conversion.diagnostics for note in one.notes)


def test_the_armature_of_a_tendon_is_a_loss(tmp_path: Path) -> None:
    """As that of joints, it is not in the mass matrix that is compared."""
    tendon = '<tendon><fixed name="heavy" armature="123"><joint joint="near" coef="1"/></fixed></tendon></mujoco>'
    source = _FINGER.format(inertial=_BODY, equalities="").replace("</mujoco>", tendon)
    conversion = proven(tmp_path, ".xml", source, "urdf", "sdf", "mjcf")
    assert any(text.startswith("<tendon> in <mujoco>: not converted") for text in told(conversion, "SB860"))


def test_what_stands_beside_a_robot_that_moves_freely(tmp_path: Path) -> None:
    """As the target of dm_control's fish: it is not part of the robot, as little as a ball that lies there."""
    source = """<mujoco><worldbody><body name="target" pos="0 .4 .1"><geom size=".04"/></body>
      <body name="torso"><freejoint/><geom size=".1"/><body><joint name="fin"/><geom size=".05" pos=".2 0 0"/></body>
      </body></worldbody></mujoco>"""
    conversion = proven(tmp_path, ".xml", source, "urdf", "sdf", "mjcf")
    assert conversion.robot is not None
    assert "target" not in conversion.robot.link_by_name


_LIDAR = """<gazebo reference="arm"><sensor name="eye" type="ray"><ray><scan>
  <horizontal><samples>{}</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle></horizontal>
  <vertical><samples>{}</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></vertical>
  </scan><range><min>0.05</min><max>50</max></range></ray></sensor></gazebo>"""


@pytest.mark.parametrize(("rays", "rows"), [(1, 1), (12, 16)])
def test_lidars_of_one_ray_and_of_several_rows(rays: int, rows: int, tmp_path: Path) -> None:
    """As Baxter's: a single ray points along x, whatever its field of view; of several rows one is converted."""
    source = urdf(f'<link name="base">{_INERTIAL}</link>', _LIDAR.format(rays, rows))
    conversion = proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")
    lost = f"sensor 'eye': {rows} rows of rays: one converted, level with its frame"
    assert (lost in told(conversion, "SB863")) == (rows > 1)


def test_meshes_as_large_as_buildings(tmp_path: Path) -> None:
    """Engines hold vertices in single precision, which at a hundred metres is several micrometres."""
    trimesh.creation.icosphere(subdivisions=2, radius=97.31).export(tmp_path / "dome.stl")
    place = '<origin xyz="0.123 45.678 3.21" rpy="0.1 0.2 0.3"/>'
    dome = f'<visual>{place}<geometry><mesh filename="dome.stl" scale="1.1 0.9 1"/></geometry></visual>'
    source = urdf(f'<link name="base">{_INERTIAL}{dome}{dome.replace("visual", "collision")}</link>')
    proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")


_HINGES = '<joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/><joint name="z" axis="0 0 1"/>'


def test_several_joints_in_bodies_of_a_microgram(tmp_path: Path) -> None:
    """As of NeuroMechFly: moments that stand for those between joints are within what engines compare."""
    body = f'<body pos="0.002 0 0">{_HINGES}<inertial pos="1e-4 0 0" mass="1e-6" diaginertia="1e-7 1e-7 1e-7"/>'
    bodies = "".join(body.replace('name="', f'name="{number}_') for number in range(6)) + "</body>" * 6
    proven(tmp_path, ".xml", f"<mujoco><worldbody>{bodies}</worldbody></mujoco>", "mjcf")


def test_couplings_that_are_no_mimic(tmp_path: Path) -> None:
    """A second leader of one joint is refused, and not left out in silence."""
    path = tmp_path / "robot.xml"
    equalities = '<joint joint1="tip" joint2="far"/><joint name="e" joint1="tip" joint2="near"/>'
    path.write_text(_FINGER.format(inertial=_BODY, equalities=equalities))
    conversion = convert(path, Options(tmp_path / "out"))
    assert told(conversion, "SB861") == [
        "equality constraint 'e' is not a linear relation of two joints, of which one follows no other"
    ]


def test_names_with_slashes(tmp_path: Path) -> None:
    """A file with names as dm_control gives them to the parts of a robot is proven under new names."""
    inertial = '<inertial pos=".1 0 0" mass="1" diaginertia=".1 .1 .1"/>'
    source = f"""<mujoco model="four/bar"><worldbody><body name="r/base">{inertial}
      <body name="r/a"><joint name="r/ja" axis="0 0 1" range="-50 50"/>{inertial}
      <geom name="r/g" type="box" size=".1 .1 .1"/>
      <body name="r/b" pos=".2 0 0"><joint name="r/jb" axis="0 0 1"/>{inertial}<site name="r/site"/></body></body>
      <body name="r/c" pos="0 .2 0"><joint name="r/jc" axis="0 0 1"/>{inertial}</body></body></worldbody>
      <equality><connect name="r/loop" body1="r/b" body2="r/c" anchor="0 .2 0"/></equality>
      <contact><exclude name="r/x" body1="r/a" body2="r/c"/></contact>
      <actuator><motor name="r/pull" joint="r/ja"/><velocity name="r/turn" joint="r/jb" kv="1"/></actuator>
      <sensor><accelerometer name="r/acc" site="r/site"/><gyro name="r/gyro" site="r/site"/>
      <jointpos name="r/jc" joint="r/jc"/><jointvel name="r/v" joint="r/jc"/></sensor></mujoco>"""
    proven(tmp_path, ".xml", source, "urdf", "sdf", "mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "four_bar.xml"))
    assert [model.actuator(i).name for i in range(2)] == ["r_pull", "r_turn"]
    assert model.geom("r_g").bodyid == model.body("r_a").id


@pytest.mark.parametrize("comment", ["<!-- arm -- upper -->", "<!----- arm --->"])
def test_comments_with_hyphens(comment: str, tmp_path: Path) -> None:
    """XML forbids them, MuJoCo reads them, and so does the conversion; what is not XML beside them has its line."""
    source = f"""<mujoco model="robot"><worldbody><body name="base">{_BODY}{comment}
      <body name="arm"><joint name="turn" axis="0 0 1"/>{_BODY}</body></body></worldbody></mujoco>"""
    proven(tmp_path, ".xml", source, "mjcf")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml")).nbody == 3
    wrong = {"wrong.xml": (source.replace('"turn" ', '"turn"'), 2), "wrong.urdf": (f"<robot>\n\n{comment}</robot>", 3)}
    for name, (text, line) in wrong.items():
        (tmp_path / name).write_text(text)
        conversion = convert(tmp_path / name, Options(tmp_path / "out"))
        assert [(one.code, one.span and one.span.line) for one in conversion.diagnostics] == [("SB814", line)]


@pytest.mark.parametrize(
    "joints",
    [
        '<joint name="a" axis="0 0 1" pos=".1 .2 .3" ref="7"/><joint name="b" axis="1 1 0" pos="0 .1 0" ref="10"/>',
        '<joint name="a" axis="0 0 1" pos=".1 0 0"/><joint name="b" type="slide" axis="1 0 1" ref=".05"/>'
        '<joint name="c" axis="0 1 0" ref="-20" pos="0 0 .1"/>',
    ],
)
def test_reference_positions_of_several_joints_in_one_body(joints: str, tmp_path: Path) -> None:
    """MuJoCo states axes where the joints are at their `ref`, which turns and moves those before them in the body."""
    source = f"""<mujoco model="robot"><worldbody><body name="base">{_BODY}
      <body name="arm" pos=".1 0 0">{joints}{_BODY}</body></body></worldbody></mujoco>"""
    proven(tmp_path, ".xml", source, "mjcf", "urdf")


_BARS = "".join(
    f'<link name="{name}"><pose>{x} 0 {z} 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy>'
    "<izz>.01</izz></inertia></inertial></link>"
    for name, x, z in (("base", 0, 0), ("crank", 0, 0), ("coupler", 0, 0.2), ("rocker", 0.3, 0))
)
_PIN = (
    '<joint name="{0}" type="revolute">{1}<parent>{2}</parent><child>{3}</child>'
    "<axis><xyz>0 1 0</xyz>{4}</axis></joint>"
)


@pytest.mark.parametrize("limit", ["<limit><lower>0.1</lower><upper>1</upper></limit>", ""])
def test_limits_without_0_in_loops(limit: str, tmp_path: Path) -> None:
    """Where a joint of a loop starts at its limit, the others move to where the loop is closed."""
    pins = [
        _PIN.format("drive", "", "base", "crank", limit),
        _PIN.format("knee", "", "crank", "coupler", ""),
        _PIN.format("swing", "", "base", "rocker", ""),
        _PIN.format("loop", "<pose>0 0 .2 0 0 0</pose>", "coupler", "rocker", ""),
    ]
    source = f'<sdf version="1.9"><model name="robot">{_BARS}{"".join(pins)}</model></sdf>'
    conversion = proven(tmp_path, ".sdf", source, "sdf", "mjcf")
    moved = {text.partition(":")[0] for text in told(conversion, "SB870")}
    assert moved == ({"joint 'drive'", "joint 'knee'", "joint 'swing'"} if limit else set())
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    if limit:
        at = {name: model.joint(name).qposadr[0] for name in ("drive", "knee", "swing")}
        q = {name: model.key_qpos[0][address] for name, address in at.items()}
        assert q == pytest.approx({"drive": 0.1, "knee": -0.1, "swing": 0.1}, abs=1e-6)


def test_no_closed_pose_within_limits(tmp_path: Path) -> None:
    """Limits that no closed pose is within: the remedy names the position that they must include."""
    limit = "<limit><lower>{}</lower><upper>1</upper></limit>"
    pins = [
        _PIN.format("drive", "", "base", "crank", limit.format(0.1)),
        _PIN.format("knee", "", "crank", "coupler", limit.format(0)),
        _PIN.format("swing", "", "base", "rocker", ""),
        _PIN.format("loop", "<pose>0 0 .2 0 0 0</pose>", "coupler", "rocker", ""),
    ]
    path = tmp_path / "robot.sdf"
    path.write_text(f'<sdf version="1.9"><model name="robot">{_BARS}{"".join(pins)}</model></sdf>', encoding="utf-8")
    found = convert(path, Options(tmp_path / "out", verify=False)).diagnostics
    assert [one.code for one in found if one.severity == "error"] == ["SB411"]
    (moved,) = [one for one in found if one.code == "SB870"]
    assert "widen the limits to include this position" in moved.help[0]


_FOUR_BAR = """<mujoco model="robot"><compiler angle="radian"/><worldbody><body name="ground">
  <geom type="box" size=".2 .02 .02" mass="1"/>
  <body name="crank" pos="-.1 0 0"><joint name="j1" axis="0 1 0" range="-1 1"/><geom size=".01" pos="0 0 .05" mass="1"/>
    <body name="coupler" pos="0 0 .1"><joint name="j2" axis="0 1 0"/><geom size=".01" pos=".1 0 0" mass="1"/></body>
  </body>
  <body name="rocker" pos=".1 0 0"><joint name="j3" axis="0 1 0"/><geom size=".01" pos="0 0 .05" mass=".1"/></body>
</body></worldbody>
<equality><connect body1="coupler" body2="rocker" anchor=".2 0 0"/></equality>
<keyframe><key name="home" qpos="{}"/></keyframe></mujoco>"""


def test_a_loop_that_is_open_in_the_initial_pose_is_closed_near_it(tmp_path: Path) -> None:
    """A keyframe of two digits opens a four-bar by 4 mm, which MuJoCo pulls together: it starts closed, and says so."""
    conversion = proven(tmp_path, ".xml", _FOUR_BAR.format("0.4 -0.39 0.37"), "sdf", "mjcf", "urdf")
    moved = told(conversion, "SB870")
    assert [text.partition(" taken")[0] for text in moved] == [
        f"joint '{name}': initial position {q} does not close the loops: {sign}0.386751"
        for name, q, sign in (("j1", 0.4, ""), ("j3", 0.37, ""), ("j2", -0.39, "-"))
    ]
    (tmp_path / "exact").mkdir()
    assert not told(proven(tmp_path / "exact", ".xml", _FOUR_BAR.format("0.4 -0.4 0.4"), "mjcf"), "SB870")


def test_followers_whose_limits_exclude_0(tmp_path: Path) -> None:
    """The leader starts where its follower is within its limits."""
    follower = """<link name="hand">{}</link>
      <joint name="follow" type="revolute"><parent link="arm"/><child link="hand"/><axis xyz="0 1 0"/>
      <limit lower="0.2" upper="1" effort="1" velocity="1"/><mimic joint="turn" multiplier="2"/></joint>"""
    base = f'<link name="base">{_INERTIAL}</link>'
    conversion = proven(tmp_path, ".urdf", urdf(base, follower.format(_INERTIAL)), "urdf", "sdf", "mjcf")
    assert told(conversion, "SB870") == ["joint 'turn': initial position 0 is outside the limits 0.1 to 0.5: 0.1 taken"]


def test_ellipsoids_of_sdformat_are_compared(tmp_path: Path) -> None:
    """PyBullet rejects a file with an ellipsoid: the other engines compare it, and report what differs."""
    shape = "<visual name='v'><geometry><ellipsoid><radii>.1 .2 {}</radii></ellipsoid></geometry></visual>"
    for name, z in (("old", 0.3), ("new", 0.31)):
        link = f"<link name='a'>{shape.format(z)}</link>"
        text = f"<sdf version='1.9'><model name='robot'>{link}</model></sdf>"
        (tmp_path / f"{name}.sdf").write_text(text, encoding="utf-8")
    assert stepbot("verify", "old.sdf", cwd=tmp_path).code == 0
    run = stepbot("diff", "old.sdf", "new.sdf", cwd=tmp_path)
    assert run.code == 1, run.err


def test_sensors_of_two_links_with_one_name(tmp_path: Path) -> None:
    """SDFormat allows it; other formats do not, so that the second one is renamed."""
    sensor = '<sensor name="imu" type="imu"><update_rate>{}</update_rate></sensor></link>'
    links = _BARS.replace("</link>", sensor.format(100), 1).replace("</inertial></link>", f"</inertial>{sensor}", 1)
    joints = (_PIN.format(name, "", "base", name, "") for name in ("crank", "coupler", "rocker"))
    source = f'<sdf version="1.9"><model name="robot">{links.format(50)}{"".join(joints)}</model></sdf>'
    source = source.replace('joint name="', 'joint name="j_')
    conversion = proven(tmp_path, ".sdf", source, "urdf", "sdf", "mjcf")
    assert "sensor 'imu' of link 'crank' is renamed to 'imu_2'" in told(conversion, "SB864")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.site("imu::site").bodyid == model.body("base").id
    assert model.site("imu_2::site").bodyid == model.body("crank").id


def test_transmissions_with_one_name(tmp_path: Path) -> None:
    """As of two joints that one macro drives: both are converted, the second one under another name."""
    hand = f"""<link name="base">{_INERTIAL}</link><link name="hand">{_INERTIAL}</link>
      <joint name="wrist" type="revolute"><parent link="arm"/><child link="hand"/>
      <limit lower="-1" upper="1" effort="2" velocity="1"/></joint>"""
    drive = """<transmission name="drive"><type>transmission_interface/SimpleTransmission</type><joint name="{}">
      <hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
      <actuator name="motor"><mechanicalReduction>{}</mechanicalReduction></actuator></transmission>"""
    source = urdf(hand, drive.format("turn", 10), drive.format("wrist", 20))
    proven(tmp_path, ".urdf", source, "urdf", "sdf", "mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    gears = {model.joint(int(one.trnid[0])).name: one.gear[0] for one in map(model.actuator, range(model.nu))}
    assert gears == {"turn": 10.0, "wrist": 20.0}


def test_loops_without_moving_joints(tmp_path: Path) -> None:
    """A closure between links that are fixed to each other moves with them: its Jacobian is rounding alone."""
    pins = [
        _PIN.format("drive", "", "base", "crank", "").replace("0 1 0", "0.1 0.7 0.3"),
        _PIN.format("mount", "", "crank", "coupler", "").replace("revolute", "fixed"),
        _PIN.format("other", "<pose>.1 .2 .3 .4 .5 .6</pose>", "crank", "rocker", "").replace("revolute", "fixed"),
        _PIN.format("loop", "<pose>.3 .2 .1 .7 .2 .1</pose>", "coupler", "rocker", "").replace("revolute", "fixed"),
    ]
    source = f'<sdf version="1.9"><model name="robot">{_BARS}{"".join(pins)}</model></sdf>'
    conversion = proven(tmp_path, ".sdf", source, "sdf", "mjcf")
    assert conversion.robot is not None
    assert driven_joints(conversion.robot) == ("drive",)


def test_a_loop_to_the_world(tmp_path: Path) -> None:
    """A second joint on the world closes a loop, also where the first one fixes the base."""
    mass = "<inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>"
    links = f'<link name="base">{mass}</link><link name="arm"><pose>0 0 1 0 0 0</pose>{mass}</link>'
    limit = "<limit><lower>-1</lower><upper>1</upper><effort>5</effort><velocity>2</velocity></limit>"
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{rest}</joint>'
        for name, kind, parent, child, rest in (
            ("on_world", "fixed", "world", "base", ""),
            ("turn", "revolute", "base", "arm", f"<axis><xyz>0 0 1</xyz>{limit}</axis>"),
            ("held", "ball", "world", "arm", ""),
        )
    )
    text = f'<sdf version="1.9"><model name="held">{links}{joints}</model></sdf>'
    robot = proven(tmp_path, ".sdf", text, "sdf", "mjcf").robot
    assert robot is not None
    assert [one.link_b for one in robot.closures] == ["arm"]
