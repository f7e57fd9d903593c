"""PROTOs of Webots: what the comparison with the model does not show, and the opinion of an independent converter.

Webots itself is not installed where the tests run: the PROTO is read by stepbot's parser, and compared with the PROTO
that Cyberbotics' own `urdf2webots` makes of the URDF.
"""

import importlib.util
import subprocess
import sys
from math import inf
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Request
from stepbot.engines.webots.vrml import Node, read_proto
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import files_of, main_file
from stepbot.formats.webots import proto_name
from stepbot.geometry.spatial import Pose, rotation_angle
from stepbot.robot.model import Actuator, ActuatorKind, Base, JointKind, Limit, Mimic, Robot
from tests.robots import ROBOTS, four_bar, two_link_arm
from tests.simulators.conftest import look

WEBOTS, URDF = format_named("webots"), format_named("urdf")


def proto(robot: Robot) -> Node:
    """The parsed PROTO of a robot."""
    lowered = lower(robot, WEBOTS, Diagnostics())
    _, top = read_proto(WEBOTS.writer.render(lowered).decode())
    return top


def all_nodes(node: Node) -> list[Node]:
    """A node and all nodes below it."""
    below = [one for value in node.fields.values() for one in (value if isinstance(value, list) else [value])]
    return [node, *(found for one in below if isinstance(one, Node) for found in all_nodes(one))]


def parameters_of(nodes: list[Node], joint: str) -> Node:
    """The parameters of a joint, which is found by its position sensor."""
    (found,) = (n for n in nodes if any(one.text("name") == f"{joint}_sensor" for one in n.nodes("device")))
    parameters = found.node("jointParameters")
    assert parameters is not None
    return parameters


def driven(robot: Robot, joint: str, **limits: float) -> Robot:
    """The robot with a motor on a joint alone, and the joint's limits."""
    joints = [
        replace(one, limit=replace(Limit(effort=3.0, velocity=2.0), **limits)) if one.name == joint else one
        for one in robot.joints
    ]
    motor = Actuator("drive", joint, ActuatorKind.POSITION, kp=5.0, limit=Limit(effort=1.5))
    return replace(robot, joints=tuple(joints), actuators=(motor,))


def test_a_motor_has_the_limits_of_its_joint_and_actuator() -> None:
    """Soft limits, velocity and the narrower effort are the motor's; stops are the joint's."""
    joint = two_link_arm().joints[-1]
    nodes = all_nodes(proto(driven(two_link_arm(), joint.name, lower=-1.0, upper=2.0)))
    (motor,) = (node for node in nodes if node.type == "RotationalMotor")
    assert motor.text("name") == "drive"
    named = ("minPosition", "maxPosition", "maxVelocity", "maxTorque")
    assert [motor.number(name, inf) for name in named] == [-1.0, 2.0, 2.0, 1.5]
    parameters = parameters_of(nodes, joint.name)
    assert (parameters.number("minStop", 0.0), parameters.number("maxStop", 0.0)) == (-1.0, 2.0)


@pytest.mark.parametrize(("lower_", "upper"), [(-4.0, 4.0), (0.5, 2.0), (-2.0, -0.5), (-inf, 1.0)])
def test_hinges_without_valid_stops_have_none(lower_: float, upper: float) -> None:
    """Webots allows stops from -180° to 0 and from 0 to 180°: for others there is a warning, and the motor's limits."""
    joint = two_link_arm().joints[-1].name
    robot, diagnostics = driven(two_link_arm(), joint, lower=lower_, upper=upper), Diagnostics()
    lower(robot, WEBOTS, diagnostics)
    assert [joint in one.message for one in diagnostics if one.code == "SB760:far-limit"] == [True]
    nodes = all_nodes(proto(robot))
    assert "minStop" not in parameters_of(nodes, joint).fields
    (motor,) = (node for node in nodes if node.type == "RotationalMotor")
    assert motor.number("minPosition", 0.0) == max(lower_, -1e9)
    passive = lower(replace(robot, actuators=()), WEBOTS, Diagnostics()).joint_by_name[joint]
    assert passive.limit == Limit()


def test_mimics_are_coupled_motors() -> None:
    """The motors share the beginning of their name, and the follower has the multiplier."""
    arm = two_link_arm()
    first, second = (joint.name for joint in arm.joints[:2])
    follower = replace(arm.joint_by_name[second], mimic=Mimic(first, -0.5, 0.1), drawn_position=0.1)
    robot = driven(arm, first)
    robot = replace(robot, joints=tuple(follower if one.name == second else one for one in robot.joints))
    motors = [node for node in all_nodes(proto(robot)) if node.type == "RotationalMotor"]
    assert [(one.text("name"), one.number("multiplier", 1.0)) for one in motors] == [
        (f"drive::{first}", 1.0),
        (f"drive::{second}", -0.5),
    ]


def test_a_loop_is_closed_by_a_reference() -> None:
    """The joint that closes the loop is on one link, at the closure's place in it, and refers to the other."""
    robot = four_bar()
    (closure,) = robot.closures
    (holder,) = (
        node
        for node in all_nodes(proto(robot))
        for child in node.nodes("children")
        if (end := child.node("endPoint")) is not None and end.type == "SolidReference"
    )
    (joint,) = (child for child in holder.nodes("children") if (e := child.node("endPoint")) and e.type != "Solid")
    end, parameters = joint.node("endPoint"), joint.node("jointParameters")
    assert end is not None
    assert parameters is not None
    assert (holder.text("name"), end.text("solidName")) == (closure.link_a, closure.link_b)
    np.testing.assert_allclose(parameters.numbers("anchor"), closure.X_AF.p, atol=1e-15)
    np.testing.assert_allclose(parameters.numbers("axis"), closure.X_AF.turn(closure.axis), atol=1e-15)


def test_a_fixed_closure_is_three_ball_joints_not_in_line() -> None:
    """Three points that coincide hold a body."""
    robot = four_bar()
    fixed = replace(robot.closures[0], kind=JointKind.FIXED)
    nodes = all_nodes(proto(replace(robot, closures=(fixed,))))
    anchors = [
        parameters.numbers("anchor", (0.0, 0.0, 0.0))
        for node in nodes
        if node.type == "BallJoint" and (parameters := node.node("jointParameters")) is not None
    ]
    a, b, c = map(np.array, anchors)
    assert np.linalg.norm(np.cross(b - a, c - a)) > 1e-4


@pytest.mark.parametrize("name", ROBOTS)
def test_every_base_is_held_or_has_physics(name: str) -> None:
    """Webots attaches a solid with physics in a robot without it to the world; all links have physics."""
    robot = ROBOTS[name]()
    top = proto(robot)
    assert (top.node("physics") is None) == (robot.base is Base.FIXED)
    solids = [
        node for node in all_nodes(top) if node.type == "Solid" and (node.node("physics") or node.nodes("children"))
    ]
    assert all(node.node("physics") is not None for node in solids)


def test_the_world_refers_to_the_proto() -> None:
    """The world declares the PROTO beside it and has one node of it; the time step is in milliseconds."""
    lowered = lower(two_link_arm(), WEBOTS, Diagnostics())
    files = files_of(lowered, WEBOTS)
    text = files["two_link_arm.wbt"].decode()
    assert 'EXTERNPROTO "two_link_arm.proto"' in text
    assert "\ntwo_link_arm {\n}" in text
    assert "basicTimeStep 2\n" in text
    assert main_file(lowered, WEBOTS) in files


@pytest.mark.parametrize(
    ("robot", "name"), [("arm", "arm"), ("2f85", "_2f85"), ("my arm", "my_arm"), ("bräs", "br_s"), ("-a.b", "_-a_b")]
)
def test_proto_names_are_identifiers(robot: str, name: str) -> None:
    """The PROTO, its file and the world have the same name, which is an identifier of VRML."""
    assert proto_name(robot) == name
    lowered = lower(replace(two_link_arm(), name=robot), WEBOTS, Diagnostics())
    assert main_file(lowered, WEBOTS) == f"{name}.proto"
    assert read_proto(WEBOTS.writer.render(lowered).decode())[0] == name


def test_text_cannot_leave_its_comment_or_string() -> None:
    """Line breaks in a licence or a file name, and what would open a template in a name, do not change the PROTO."""
    arm = two_link_arm()
    base = replace(arm.links[0], name='%{ os.exit() }% "a\\')
    joints = tuple(replace(one, parent=base.name) if one.parent == arm.root.name else one for one in arm.joints)
    metadata = replace(arm.metadata, license="MIT\nPROTO b [ ] { }")
    robot = replace(arm, links=(base, *arm.links[1:]), joints=joints, frames=(), sensors=(), metadata=metadata)
    top = proto(replace(robot, source="a\nPROTO b [ ] { }.step"))
    assert [node.text("name") for node in top.nodes("children")] == [base.name]


@pytest.mark.parametrize(
    "text",
    [
        "PROTO a [ ] { Robot { } }",
        "#VRML_SIM R2023b utf8\nPROTO a [ ] { Robot { ",
        "#VRML_SIM R2023b utf8\nPROTO a [ ] { Robot { name IS missing } }",
        "#VRML_SIM R2023b utf8\nRobot { }",
        "#VRML_SIM R2023b utf8\nPROTO a [ ] { Robot { %< if (true) { >% %< } >% } }",
        "#VRML_SIM R2023b utf8\nPROTO a [ ] " + "{ Group { children [ Group " * 300,
    ],
)
def test_other_texts_are_refused(text: str) -> None:
    """What is no PROTO, or more than this reader reads, ends with a reason."""
    with pytest.raises((EngineRefused, EngineCannotRead)):
        read_proto(text)


PHYSICS = "physics Physics { density -1 mass 1 inertiaMatrix [ 1 1 1, 0 0 0 ] }"


@pytest.mark.parametrize(
    ("children", "reason"),
    [
        (f'Solid {{ name "a" {PHYSICS} }} Solid {{ name "a" {PHYSICS} }}', "duplicate solid 'a'"),
        (f'Hinge2Joint {{ endPoint Solid {{ name "a" {PHYSICS} }} }}', "solids below a Hinge2Joint"),
        (f'Pose {{ children [ Solid {{ name "a" {PHYSICS} }} ] }}', "solids below a Pose"),
        (f"SliderJoint {{ jointParameters JointParameters {{ axis 0 0 0 }} endPoint Solid {{ {PHYSICS} }} }}", "zero"),
        ('Solid { name "caf\xe9" }', "not UTF-8"),
        (" ".join(f"DEF N{i + 1} Group {{ children [ USE N{i} USE N{i} ] }}" for i in range(40)), "1,000,000 nodes"),
    ],
    ids=["names", "joint", "group", "axis", "encoding", "bomb"],
)  # fmt: skip
def test_robots_beyond_the_reader_are_refused(children: str, reason: str, tmp_path: Path) -> None:
    """Solids that would be lost, and what would end in an exception or never, are refused with the reason."""
    file = tmp_path / "robot.proto"
    text = f"#VRML_SIM R2023b utf8\nPROTO a [ ] {{ Robot {{ {PHYSICS} children [ DEF N0 Group {{ }} {children} ] }} }}"
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises((EngineRefused, EngineCannotRead), match=reason):
        look("vrml", Request(str(file), "webots", configurations=({},), simulate=0.0))


def _solids(top: Node) -> dict[str, tuple[float, np.ndarray, Pose]]:
    """Mass, centre of mass in the root, and pose in the root, of each solid with physics."""
    found: dict[str, tuple[float, np.ndarray, Pose]] = {}

    def visit(node: Node, X: Pose) -> None:
        here = X @ node.pose()
        physics = node.node("physics")
        if physics is not None:
            com = here.apply(physics.numbers("centerOfMass", (0.0, 0.0, 0.0)))
            found[node.text("name")] = physics.number("mass", 0.0), com, here
        for child in node.nodes("children"):
            end = child.node("endPoint")
            if end is not None and end.type == "Solid":
                visit(end, here)
            elif child.type == "Solid":
                visit(child, here)

    visit(replace(top, fields={key: value for key, value in top.fields.items() if key not in _PLACE}), Pose())
    return found


_PLACE = ("translation", "rotation")
LIBRARY_ROUNDS = 1e-5
"""urdf2webots writes six digits."""


def test_urdf2webots_makes_the_same_robot_of_the_urdf(tmp_path: Path) -> None:
    """Masses, centres of mass and poses of the links agree with the PROTO that Cyberbotics' converter makes."""
    if importlib.util.find_spec("urdf2webots") is None:
        pytest.skip("urdf2webots is not installed")
    robot = replace(two_link_arm(), frames=(), sensors=())
    robot = replace(robot, joints=tuple(replace(joint, drawn_position=0.0) for joint in robot.joints))
    for path, data in files_of(lower(robot, URDF, Diagnostics()), URDF).items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes(data)
    program = (
        "import sys; from urdf2webots.importer import convertUrdfFile as c; c(input=sys.argv[1], output=sys.argv[2])"
    )
    command = [sys.executable, "-c", program, "two_link_arm.urdf", "theirs.proto"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)
    assert run.returncode == 0, run.stderr
    _, theirs = read_proto((tmp_path / "theirs.proto").read_text(encoding="utf-8"))
    ours, other = _solids(proto(robot)), _solids(theirs)
    names = [link.name for link in robot.links[1:]]
    for name in names:
        assert other[name][0] == pytest.approx(ours[name][0], rel=LIBRARY_ROUNDS)
        np.testing.assert_allclose(other[name][1], ours[name][1], atol=LIBRARY_ROUNDS)
        assert rotation_angle(other[name][2].R.T @ ours[name][2].R) < LIBRARY_ROUNDS
