"""An MJCF as the source of a conversion: what MuJoCo's compiler makes of defaults, angles, classes and includes."""

from pathlib import Path

import mujoco
import pytest

from stepbot.described.robot import DescribedRobot, robot_of_description
from stepbot.engines.describe import describe
from stepbot.engines.observation import Quantity
from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options
from stepbot.robot.model import Base, JointKind, MeshRef

LEG = """<mujoco model="leg">
  <compiler angle="radian" eulerseq="zyx" autolimits="true"/>
  <option timestep="0.004" integrator="RK4" gravity="0 0 -9.81"/>
  <include file="defaults.xml"/>
  <asset><texture name="t" type="2d" builtin="flat" width="8" height="8"/><material name="red" rgba="1 0 0 1"/></asset>
  <worldbody>
    <light pos="0 0 3"/><geom type="plane" size="1 1 0.1"/>
    <body name="trunk" pos="0 0 0.8">
      <freejoint/>
      <inertial pos="0.01 0 0.02" mass="6" fullinertia="0.08 0.09 0.1 0.001 0.002 -0.003"/>
      <geom type="box" size="0.2 0.1 0.05" material="red"/>
      <site name="imu" pos="0 0 0.05"/>
      <body name="hip" pos="0.1 0 -0.05" euler="0.1 0.2 0.3" childclass="joints">
        <joint name="roll" axis="1 0 0"/>
        <joint name="pitch" axis="0 1 0" pos="0 0 -0.02"/>
        <geom type="capsule" size="0.04" fromto="0 0 0 0 0 -0.3"/>
        <body pos="0 0 -0.3">
          <joint axis="0 1 0" range="-2 0.5" ref="0.1"/>
          <geom type="cylinder" size="0.03 0.1" pos="0 0 -0.1" density="500"/>
        </body>
      </body>
      <body name="toe_a" pos="0 0.1 -0.1">
        <inertial pos="0 0 0" mass="0.2" diaginertia="0.0002 0.0002 0.0002"/>
        <joint name="a" axis="0 0 1"/><geom size="0.02" contype="0" conaffinity="0"/>
      </body>
      <body name="toe_b" pos="0 -0.1 -0.1">
        <inertial pos="0 0 0" mass="0.2" diaginertia="0.0002 0.0002 0.0002"/>
        <joint name="b" axis="0 0 1"/><geom size="0.02" group="3"/>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="cord"><joint joint="a" coef="1"/></fixed></tendon>
  <equality><joint joint1="b" joint2="a" polycoef="0.1 -1 0 0 0"/></equality>
  <actuator>
    <position name="servo" joint="roll" kp="80" kv="2" ctrlrange="-0.5 0.4" forcerange="-30 30"/>
    <velocity name="drive" joint="pitch" kv="5" ctrlrange="-3 0" gear="-1"/>
    <motor name="torque" joint="a" gear="3" ctrlrange="-2 2"/>
    <intvelocity name="integrated" joint="b" kp="3" actrange="-1 1"/>
    <motor name="pull" tendon="cord"/>
  </actuator>
  <sensor><accelerometer name="acc" site="imu"/><touch site="imu"/><gyro site="imu"/></sensor>
</mujoco>"""
DEFAULTS = """<mujocoinclude><default>
  <default class="joints"><joint damping="0.7" armature="0.01" range="-1 1" actuatorfrcrange="-40 40"/></default>
</default></mujocoinclude>"""


@pytest.fixture
def leg(tmp_path: Path) -> Path:
    """The file, which includes another."""
    (tmp_path / "defaults.xml").write_text(DEFAULTS, encoding="utf-8")
    path = tmp_path / "leg.xml"
    path.write_text(LEG, encoding="utf-8")
    return path


@pytest.fixture
def described(leg: Path) -> DescribedRobot:
    """Its robot."""
    return robot_of_description(describe(str(leg), "mjcf"), "leg", leg.name)


def test_defaults_angles_and_names(described: DescribedRobot) -> None:
    """Classes of an included file apply; limits are in radians; what has no name gets one; ref moves zero."""
    robot = described.robot
    assert robot.base is Base.FLOATING
    assert set(robot.link_by_name) == {"trunk", "hip_1", "hip_2", "hip", "body_3", "toe_a", "toe_b"}
    roll = robot.joint_by_name["roll"]
    assert (roll.limit.lower, roll.limit.upper, roll.limit.effort) == (-1.0, 1.0, 40.0)
    assert (roll.dynamics.damping, roll.dynamics.armature) == (0.7, 0.01)
    knee = robot.joint_by_name["joint_3"]
    assert knee.kind is JointKind.REVOLUTE
    assert (knee.limit.lower, knee.limit.upper, knee.drawn_position) == (-2.0, 0.5, 0.1)
    trunk = robot.link_by_name["trunk"].mass_properties
    assert trunk.mass == 6.0
    assert trunk.com == pytest.approx((0.01, 0.0, 0.02))
    rows = ((0.08, 0.001, 0.002), (0.001, 0.09, -0.003), (0.002, -0.003, 0.1))
    assert [one for row in trunk.inertia for one in row] == pytest.approx([one for row in rows for one in row])
    mimic = robot.joint_by_name["b"].mimic
    assert mimic is not None
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("a", -1.0, 0.1)
    assert robot.simulation.timestep == 0.004


def test_shapes_are_visuals_collisions_or_both(described: DescribedRobot) -> None:
    """A geom that collides is shown, too, unless its group is hidden; one without contact bits is a visual alone."""
    links = described.robot.link_by_name
    counts = {name: (len(links[name].visuals), len(links[name].collisions)) for name in ("trunk", "toe_a", "toe_b")}
    assert counts == {"trunk": (1, 1), "toe_a": (1, 0), "toe_b": (0, 1)}
    assert links["trunk"].visuals[0].rgba == (1.0, 0.0, 0.0, 1.0)


def test_actuators_of_other_kinds_are_listed(described: DescribedRobot) -> None:
    """Servos, velocity drives and motors are converted; others are reported, and a range that is not symmetric."""
    kinds = {one.name: (one.kind.value, one.kp, one.kv, one.gear) for one in described.robot.actuators}
    assert kinds == {
        "servo": ("position", 80.0, 2.0, 1.0),
        "drive": ("velocity", 0.0, 5.0, -1.0),
        "torque": ("motor", 0.0, 0.0, 3.0),
    }
    servo = described.robot.actuators[0].limit
    assert (servo.lower, servo.upper, servo.effort) == (-0.5, 0.4, 30.0)
    lost = [one.text for one in described.findings if one.code == "SB863"]
    assert [text.split("'")[1] for text in lost] == ["drive", "integrated", "pull", "sensor_1"]
    assert lost[0] == "actuator 'drive': speed from 0 to 3 at the joint: not symmetric, 3 taken for both directions"
    assert described.robot.actuators[1].limit.velocity == 3.0


@pytest.mark.slow
def test_conversion_is_proven(leg: Path, tmp_path: Path) -> None:
    """URDF and MJCF move like the source; every element that does not reach them is reported, in its file.

    Folders of packages, which MJCF has no use for, do not keep engines from reading it.
    """
    conversion = convert(leg, Options(tmp_path / "out", formats=("urdf", "mjcf"), package_path=(tmp_path,)))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    lost = {one.message.partition(":")[0] for one in conversion.diagnostics if one.code == "SB860"}
    assert lost == {"<texture> in <asset>", "<light> in <worldbody>", "<geom> in <worldbody>", "<tendon> in <mujoco>"}
    assert conversion.report is not None
    assert set(conversion.report.inputs) == {"leg.xml", "defaults.xml"}
    of_source = [one for one in conversion.report.checks if one.against.startswith("leg.xml (")]
    passed = {one.quantity for one in of_source if one.status == "passed"}
    assert {"links", "joints", "axes", "limits", "mass", "inertia", "poses", "mass matrix", "mimic"} <= passed


@pytest.mark.parametrize(
    ("xml", "word"),
    [
        ('<equality><joint joint1="b" joint2="a" polycoef="0 1 2 0 0"/></equality>', "linear"),
        ('<equality><tendon tendon1="cord"/></equality>', "linear"),
    ],
)
def test_unsupported_constraints_are_errors(leg: Path, tmp_path: Path, xml: str, word: str) -> None:
    """A constraint that the model cannot hold is an error, not a robot that moves otherwise."""
    before, _, after = LEG.partition("<equality>")
    leg.write_text(before + xml + after.partition("</equality>")[2], encoding="utf-8")
    conversion = convert(leg, Options(tmp_path / "out", formats=("urdf",), verify=False))
    assert [one.code for one in conversion.diagnostics if word in one.message and one.severity == "error"] == ["SB861"]
    assert not conversion.files


@pytest.mark.long
@pytest.mark.parametrize(
    "name", ["ant", "half_cheetah", "hopper", "humanoid", "inverted_double_pendulum", "walker2d_v5"]
)
def test_gymnasium_models_convert_with_proof(name: str, tmp_path: Path) -> None:
    """MJCF files of Gymnasium convert to URDF, SDFormat and MJCF, and engines find no difference from the source."""
    gymnasium = pytest.importorskip("gymnasium")
    source = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / f"{name}.xml"
    conversion = convert(source, Options(tmp_path / "out"))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    against = {check.file for check in conversion.report.checks if check.against.startswith(f"{name}.xml (")}
    assert len(against) == 3


@pytest.mark.slow
def test_losses_of_a_format_are_no_differences_from_the_source(tmp_path: Path) -> None:
    """Stops away from 0, which Webots lacks, are a declared loss (SB760:far-limit), not an error."""
    source = tmp_path / "knee.xml"
    source.write_text(
        """<mujoco model="knee"><worldbody><body name="hip"><freejoint/>
        <inertial pos="0 0 0" mass="1" diaginertia="0.004 0.004 0.004"/><geom size="0.1"/>
        <body name="shin" pos="0.3 0 0"><inertial pos="0 0 0" mass="1" diaginertia="0.004 0.004 0.004"/>
        <joint name="knee" range="10 50"/><geom size="0.1"/></body></body></worldbody>
        <keyframe><key name="home" qpos="0 0 0 1 0 0 0 0.5"/></keyframe></mujoco>""",
        encoding="utf-8",
    )
    conversion = convert(source, Options(tmp_path / "out", formats=("webots",)))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert "SB760:far-limit" in {one.code for one in conversion.diagnostics}


@pytest.mark.parametrize(
    ("bodies", "text"),
    [
        (
            """<body name="base"><geom size="0.15"/>
            <body name="lower" pos="0 0 0.2"><joint axis="0 1 0"/><geom size="0.1"/>
            <body name="upper" pos="0 0 0.2"><joint axis="0 1 0"/><geom size="0.1"/></body></body></body>""",
            "contacts between adjacent links, which the written files exclude: 'base' and 'lower'",
        ),
        (
            """<geom name="rail" type="capsule" size="0.02 1" contype="0"/>
            <body name="cart"><joint type="slide" axis="0 0 1"/><geom size="0.1" contype="0"/></body>""",
            "contacts with shapes that are not converted, of links 'world'",
        ),
    ],
    ids=["base", "surroundings"],
)
def test_contacts_that_differ_are_declared(bodies: str, text: str, tmp_path: Path) -> None:
    """MuJoCo lets a base that is fixed to the world collide with the first links; its surroundings stay behind."""
    source = tmp_path / "stand.xml"
    source.write_text(f'<mujoco model="stand"><worldbody>{bodies}</worldbody></mujoco>', encoding="utf-8")
    found = robot_of_description(describe(str(source), "mjcf"), "stand", source.name).findings
    (contacts,) = (one for one in found if one.code == "SB860")
    assert (contacts.text, contacts.differs) == (text, (Quantity.CONTACTS,))


@pytest.mark.slow
def test_excluded_contacts_are_kept(tmp_path: Path) -> None:
    """Links that the source keeps from touching, by an exclude or by the bits of their geoms, do not touch in MJCF."""
    source = tmp_path / "legs.xml"
    body = """<body name="{0}" pos="0 {1} 0"><inertial pos="0 0 -0.2" mass="2" diaginertia="0.03 0.03 0.01"/>
      <joint name="{0}_hip" axis="0 1 0"/><geom type="capsule" size="0.05" fromto="0 0 -0.1 0 0 -0.4" {2}/></body>"""
    bodies = body.format("left", 0.1, "") + body.format("right", -0.1, "") + body.format("tail", 0.3, 'conaffinity="0"')
    source.write_text(
        f"""<mujoco model="legs"><worldbody><body name="pelvis">
        <inertial pos="0 0 0" mass="3" diaginertia="0.05 0.05 0.01"/>{bodies}</body></worldbody>
        <contact><exclude body1="left" body2="right"/></contact></mujoco>""",
        encoding="utf-8",
    )
    conversion = convert(source, Options(tmp_path / "out", formats=("urdf", "mjcf")))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert b'link1="left" link2="right" reason="User"' in conversion.files["legs.srdf"]
    assert b'<exclude body1="left" body2="right"/>' in conversion.files["legs.xml"]
    assert conversion.report is not None
    contacts = [one for one in conversion.report.checks if one.quantity == "contacts"]
    assert {one.against for one in contacts if one.status == "passed"} == {"model", "legs.xml (mujoco)"}


_OF_ONE_BODY = {
    ("right_shoulder1", "right_shoulder2"): "hinge hinge",
    ("hip_x", "hip_y"): "hinge hinge",
    ("knee_1", "knee_2"): "hinge hinge",
    ("quill_slide", "quill_turn"): "slide hinge",
    ("drill_a", "drill_b"): "slide hinge",
    ("base_x", "base_y", "base_yaw"): "slide slide hinge",
    ("stage_x", "stage_y", "stage_turn"): "slide slide hinge",
}
"""Names and types of joints of one body, each by the name of another writer, or as stepbot would name them."""


@pytest.mark.slow
@pytest.mark.parametrize("limits", ["", 'range="-0.5 0.25"'])
def test_joints_of_one_body_keep_names_and_limits(limits: str, tmp_path: Path) -> None:
    """Also those that could be one joint of several coordinates, which the model names itself and has no limits for."""
    bodies = ""
    for number, (names, kinds) in enumerate(_OF_ONE_BODY.items()):
        axes = ("0 0 1", "0 0 1") if kinds == "slide hinge" else ("2 1 1", "0 -1 1", "1 -1 -1")
        joints = "".join(
            f'<joint name="{name}" type="{kind}" axis="{axis}" {limits}/>'
            for name, kind, axis in zip(names, kinds.split(), axes, strict=False)
        )
        bodies += f'<body name="arm{number}" pos="{number} 0 0.3">{joints}<geom size="0.04" pos="0.1 0.1 0.1"/></body>'
    path = tmp_path / "arm.xml"
    text = f'<compiler angle="radian"/><worldbody><body name="torso"><geom size="0.1"/>{bodies}</body></worldbody>'
    path.write_text(f'<mujoco model="arm">{text}</mujoco>', encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out"))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    written = conversion.files["arm.xml"].decode()
    assert not [name for names in _OF_ONE_BODY for name in names if f'name="{name}"' not in written]


_THING = '<body name="{0}" pos="{1} 0.5 0.1"><freejoint/><geom size="0.03"/></body>'
_PAD = '<body name="pad" pos="0 1 0"><geom type="box" size="0.1 0.1 0.01"/></body>'
_ROBOT = """<body name="arm" pos="0 0 0.2">{}<geom size="0.05"/><site name="at_arm"/>
  <body name="fore" pos="0 0.1 0"><joint name="elbow" axis="1 0 0" range="-1 1"/><geom size="0.04"/></body></body>"""


@pytest.mark.parametrize("free", ["", "<freejoint/>"], ids=["fixed", "floating"])
@pytest.mark.parametrize("first", [True, False], ids=["things first", "robot first"])
def test_things_that_lie_loose_around_the_robot_are_left_out(tmp_path: Path, free: str, first: bool) -> None:
    """A scene gives the robot in it, wherever it stands in the file; what lies around is listed, with its places.

    A body that stands in the world belongs to a robot that does, and not to one that walks.
    """
    things = _THING.format("cube", 0.3) + _PAD + _THING.format("ball", -0.3)
    bodies = [things, _ROBOT.format(free)] if first else [_ROBOT.format(free), things]
    path = tmp_path / "scene.xml"
    path.write_text(
        f"""<mujoco model="scene"><compiler autolimits="true"/><worldbody>{"".join(bodies)}</worldbody>
        <sensor><accelerometer site="at_arm"/></sensor>
        <actuator><position joint="elbow" kp="3"/></actuator></mujoco>""",
        encoding="utf-8",
    )
    conversion = convert(path, Options(tmp_path / "out", formats=("urdf", "sdf", "mjcf")))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert not conversion.report.failed
    out = {"ball", "cube"} | ({"pad"} if free else set())
    left = {
        one.message.split("'")[1] for one in conversion.diagnostics if "is not connected to the robot" in one.message
    }
    assert left == out
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "scene.xml"))
    names = {model.body(n).name for n in range(1, model.nbody)}
    assert names == {"arm", "fore"} | ({"pad"} - out)
    assert model.nv == (7 if free else 1)


def test_two_robots_that_move_freely_are_no_robot(tmp_path: Path) -> None:
    """Which of them is the robot, nobody has stated."""
    path = tmp_path / "two.xml"
    other = _ROBOT.format("<freejoint/>").replace("arm", "leg").replace("fore", "shin").replace("elbow", "knee")
    path.write_text(
        f"<mujoco><worldbody>{_ROBOT.format('<freejoint/>')}{other}</worldbody></mujoco>".replace("range", "user"),
        encoding="utf-8",
    )
    conversion = convert(path, Options(tmp_path / "out"))
    (error,) = (one for one in conversion.diagnostics if one.severity == "error")
    assert error.code == "SB861"
    assert "of one robot" in error.remedies[0]


_MEASURED = """<mujoco><worldbody><body name="trunk"><freejoint/>
<geom size="0.1"/><site name="imu" pos="0.01 0.02 0.03"/>
<body name="leg"><joint name="hip" axis="0 1 0"/><geom size="0.1" pos="0 0 -0.3"/><site name="load" pos="0 0 -0.1"/>
</body></body></worldbody><sensor><gyro name="w" site="imu"/><accelerometer name="a" site="imu"/>{more}
<jointpos name="q" joint="hip"/><jointvel name="qd" joint="hip"/><jointactuatorfrc name="tau" joint="hip"/>
<force name="f" site="load"/><torque name="t" site="load"/></sensor></mujoco>"""


@pytest.mark.parametrize("more", ["", '<framequat name="r" objtype="site" objname="imu"/>'])
def test_readings_of_others_at_one_place_are_one_sensor(more: str, tmp_path: Path) -> None:
    """They have the name of their site or joint; what no sensor of the model measures is listed."""
    path = tmp_path / "leg.xml"
    path.write_text(_MEASURED.format(more=more), encoding="utf-8")
    conversion = convert(path, Options(tmp_path / "out"))
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    assert conversion.robot is not None
    found = {one.name: (one.kind.value, one.link, one.joint, one.X_LS.position) for one in conversion.robot.sensors}
    assert found == {
        "imu": ("imu", "trunk", "", (0.01, 0.02, 0.03)),
        "hip": ("joint", "leg", "hip", (0.0, 0.0, 0.0)),
        "load": ("force_torque", "leg", "hip", (0.0, 0.0, -0.1)),
    }
    assert [one.message for one in conversion.diagnostics if one.code == "SB863"] == [
        "sensor 'tau' of type 'jointactfrc': not converted"
    ]


def test_a_reading_alone_is_no_sensor(tmp_path: Path) -> None:
    """Nor are two at different rates, nor at different sites."""
    path = tmp_path / "leg.xml"
    apart = _MEASURED.format(more="").replace('name="w"', 'name="w" interval="0.01" nsample="1"')
    path.write_text(apart.replace('<torque name="t" site="load"/>', '<torque name="t" site="imu"/>'), encoding="utf-8")
    robot = robot_of_description(describe(str(path), "mjcf"), "leg", path.name).robot
    assert [one.name for one in robot.sensors] == ["hip"]


ARM = """<mujoco model="{name}"><compiler meshdir="{folder}"/><option timestep="0.001"/>
  <asset><mesh name="{name}_body" file="body.obj"/></asset>
  <worldbody><body name="{name}"><joint name="{name}_hinge"/><geom type="mesh" mesh="{name}_body" mass="1"/></body>
  </worldbody>
</mujoco>"""
CELL = """<mujoco model="cell"><compiler meshdir="mine"/>
  <asset><mesh name="plinth" file="body.obj"/>
    <model name="one" file="one/arm.xml"/><model name="two" file="two/arm.xml"/></asset>
  <worldbody><body name="base"><geom type="mesh" mesh="plinth" mass="2"/>
    <frame pos="1 0 0"><attach model="one" prefix=""/></frame><attach model="two" prefix="two_"/></body></worldbody>
</mujoco>"""


@pytest.mark.slow
def test_attached_models_have_meshes_of_their_own(tmp_path: Path) -> None:
    """Each has its mesh folder, and their files may have the same names; what they hold is listed with their file."""
    for name, size in (("mine", 1.0), ("one/meshes", 2.0), ("two/parts", 3.0)):
        (tmp_path / name).mkdir(parents=True)
        corners = ((0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size))
        text = "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        (tmp_path / name / "body.obj").write_text(text, encoding="utf-8")
    for name, folder in (("one", "meshes"), ("two", "parts")):
        text = ARM.format(name=name, folder=folder)
        (tmp_path / name / "arm.xml").write_text(text, encoding="utf-8")
    (tmp_path / "cell.xml").write_text(CELL, encoding="utf-8")
    conversion = convert(tmp_path / "cell.xml", Options(tmp_path / "out", formats=("mjcf", "urdf"), base="fixed"))
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    robot = conversion.robot
    assert robot is not None
    sizes = {
        link.name: max(robot.mesh_by_name[shape.geometry.name].mesh.bounds[1])
        for link in robot.links
        for shape in link.visuals
        if isinstance(shape.geometry, MeshRef)
    }
    assert sizes == pytest.approx({"base": 1.0, "one": 2.0, "two_two": 3.0})
    assert robot.simulation.timestep is None  # the options of a model are not attached
    assert not any("<attach>" in one.message or "<model>" in one.message for one in conversion.diagnostics)
    (tmp_path / "one" / "meshes" / "body.obj").unlink()
    found = convert(tmp_path / "cell.xml", Options(tmp_path / "out", formats=("mjcf",), verify=False)).diagnostics
    assert found.has_errors  # and not the file of another model
