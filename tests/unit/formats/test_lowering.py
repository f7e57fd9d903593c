"""Lowering a robot to the features of a format."""

from math import inf
from random import Random

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.linalg import eigh

from stepbot.diagnostics import Diagnostics
from stepbot.diagnostics.codes import CODES
from stepbot.formats import FORMATS, lowering
from stepbot.formats.features import Feature, Level
from stepbot.formats.lowering import lower
from stepbot.formats.lowering.joints import UNLIMITED, damped_softly, stiffly_damped
from stepbot.formats.lowering.masses import STAND_IN_MASS, STAND_IN_MOMENT
from stepbot.formats.lowering.rerooted_loops import _turned, reroot_loops
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.closures import close_loops, degrees_of_freedom, driven_joints, loop_ways
from stepbot.robot.dynamics import equations_of_motion, free_mass_matrix
from stepbot.robot.kinematics import complete, configurations, initial_configuration, link_poses
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Collision,
    Frame,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    MeshAsset,
    MeshRef,
    Robot,
)
from stepbot.robot.sensors import Sensor, SensorKind
from stepbot.robot.validity import check_robot
from tests.closed_mechanisms import sliding_closure
from tests.conftest import ReadDiagnostics
from tests.devices import equipped
from tests.meshes import trough
from tests.random_robots import drawn_robot
from tests.robots import (
    ROBOTS,
    every_robot,
    four_bar,
    four_bar_with_zeros,
    odd_names,
    one_link,
    pendulum,
    primitives,
    slider,
    two_link_arm,
)
from tests.workshop import at

every_format = pytest.mark.parametrize("format_", FORMATS)
ALWAYS_IN_URDF = "SB762:fixed-base"
LEFT_OUT = {
    "urdf": "armature encoder-rate",
    "sdf": "actuator-input armature encoder-rate",
    "mjcf": "camera-extras lidar-nearest",
    "usd": "actuator-input camera contact force-torque imu joint-sensor lidar second-actuator spring",
    "webots": "actuator-input armature contact force-torque joint-sensor second-actuator sensor-rate spring",
}
"""Features that each format lacks, of a robot with every actuator and sensor."""


def lowered(robot: Robot, format_: str, *codes: str) -> Robot:
    """The lowered robot, which must report exactly these codes."""
    diagnostics = Diagnostics()
    result = lower(robot, FORMATS[format_], diagnostics)
    assert sorted({d.code for d in diagnostics} - {ALWAYS_IN_URDF}) == sorted(codes)
    return result


@every_format
def test_every_notion_is_declared(format_: str) -> None:
    """Every writer declares every feature; inexact support has a code of the right severity."""
    declared = FORMATS[format_].expresses
    assert set(declared) == set(Feature)
    for feature, support in declared.items():
        assert support.how
        assert not support.how.endswith(".")
        assert (support.level is Level.EXACT) == (support.code == ""), feature
        if support.level is Level.REFUSED:
            assert CODES[support.code].severity == "error"
        elif support.level is not Level.EXACT:
            assert feature.word in CODES[support.code].features
            assert CODES[support.code].severity in ("warning", "note")


SAID_BY_WHO_LOADS = {
    Feature.MASSLESS_BODY,
    Feature.FIXED_BASE,
    Feature.FLOATING_BASE,
    Feature.INITIAL_POSE,
    Feature.TIMESTEP,
    Feature.SOLVER,
}
"""Settings that a file may leave to its loader; no part of the robot is lost."""


@every_format
def test_every_loss_is_an_error_when_strict(format_: str) -> None:
    """A feature that a format omits is a warning, and an error with ``--strict``."""
    for feature, support in FORMATS[format_].expresses.items():
        if support.level is Level.REPORTED and feature not in SAID_BY_WHO_LOADS:
            assert CODES[support.code].severity == "warning", feature
    diagnostics = Diagnostics()
    lower(equipped(), FORMATS[format_], diagnostics)
    left_out = {diagnostic.code for diagnostic in diagnostics if diagnostic.severity == "warning"}
    diagnostics.make_strict()
    assert left_out == {f"SB760:{feature}" for feature in LEFT_OUT[format_].split()}
    assert {diagnostic.code for diagnostic in diagnostics if diagnostic.severity == "error"} == left_out


@every_format
def test_what_is_not_exact_is_handled(format_: str) -> None:
    """Each feature without exact support is reported."""
    handled = {*lowering._HANDLINGS, Feature.RESERVED_NAME}
    not_exact = {feature for feature, s in FORMATS[format_].expresses.items() if s.level is not Level.EXACT}
    assert not_exact <= handled


@every_format
@every_robot
def test_lowering_twice_changes_nothing_more(name: str, format_: str) -> None:
    """Supported features are unchanged by lowering."""
    once = lower(ROBOTS[name](), FORMATS[format_], Diagnostics())
    assert lower(once, FORMATS[format_], Diagnostics()) == once


UNCOUPLED = {(name, one) for name in ("screw", "left_screw") for one in ("usd", "webots")}
MOVES_OTHERWISE = {("sliding_closure", "mjcf"), *UNCOUPLED}
"""Robots that are cut open elsewhere, and joints that the format cannot couple."""


@pytest.mark.parametrize(
    ("name", "format_"), [(name, one) for name in ROBOTS for one in FORMATS if (name, one) not in MOVES_OTHERWISE]
)
def test_lowering_leaves_mass_and_motion(name: str, format_: str) -> None:
    """Lowering keeps mass, except of links without, and the poses of links, in the drawn pose and around it."""
    robot = ROBOTS[name]()
    stated = lower(robot, FORMATS[format_], Diagnostics())
    masses = [link.mass_properties.mass for link in stated.links]
    assert sum(mass for mass in masses if mass != STAND_IN_MASS) == pytest.approx(
        sum(link.mass_properties.mass for link in robot.links), rel=1e-15
    )
    # Names and zeros may differ, the parent joint of a link may not.
    above = {joint.child: joint for joint in stated.joints}
    renamed = {joint.name: above[joint.child] for joint in robot.joints}
    for q in (initial_configuration(robot), *configurations(robot, 3)):
        q_said = dict(q)
        for name, joint in renamed.items():
            if name in q:
                shift = robot.joint_by_name[name].drawn_position - joint.drawn_position
                q_said[joint.name] = q_said.pop(name) - shift
        poses = link_poses(stated, complete(stated, q_said))
        for link, X_WL in link_poses(robot, q).items():
            assert poses[link].distance_to(X_WL) == pytest.approx((0, 0), abs=1e-12)


def test_urdf_leaves_out_closures_by_name(diagnostics: ReadDiagnostics) -> None:
    """An omitted closure is a warning that names the closure and both links."""
    stated = lower(four_bar(), FORMATS["urdf"], diagnostics)
    assert stated.closures == ()
    (message,) = [str(d) for d in diagnostics if d.code == "SB760:closure"]
    assert message.startswith("four_bar.urdf: warning[SB760:closure]: URDF: ")
    assert all(name in message for name in ("'rocker_pin'", "'coupler'", "'rocker'"))
    assert diagnostics.exit_code == 0


def test_urdf_bounds_what_is_unlimited() -> None:
    """Missing and one-sided limits get a number; a revolute joint without position limits becomes continuous."""
    stated = lowered(slider(), "urdf", "SB763:open-effort", "SB763:open-position", "SB763:spring")
    assert stated.joint_by_name["slide"].limit == Limit(-UNLIMITED, 0.25, 0.5, 30.0)
    assert stated.joint_by_name["lift"].limit == Limit(-0.02, 0.1, UNLIMITED, UNLIMITED)
    robot = pendulum()
    free = replace(robot.joints[0], kind=JointKind.REVOLUTE, limit=Limit(effort=3.0))
    stated = lowered(replace(robot, joints=(free,)), "urdf", "SB763:open-effort", "SB763:open-position")
    assert stated.joints[0].kind is JointKind.CONTINUOUS
    assert stated.joints[0].limit == Limit(-inf, inf, UNLIMITED, 3.0)


def test_springs_and_armatures_are_written_where_supported() -> None:
    """URDF has springs in an extension and no armature, SDFormat springs and no armature, MJCF both."""
    robot = pendulum()
    dynamics = JointDynamics(damping=1.0, friction=2.0, stiffness=3.0, spring_reference=0.5, armature=4.0)
    robot = replace(robot, joints=(replace(robot.joints[0], dynamics=dynamics),))
    assert lowered(robot, "urdf", "SB760:armature", "SB763:spring").joints[0].dynamics == JointDynamics(
        1.0, 2.0, 3.0, 0.5
    )
    assert lowered(robot, "sdf", "SB760:armature").joints[0].dynamics == JointDynamics(1.0, 2.0, 3.0, 0.5)
    assert lowered(robot, "mjcf").joints[0].dynamics == dynamics


@pytest.mark.parametrize(("share", "reported"), [(0.9, False), (1.1, True)])
def test_damping_beyond_the_step_of_pybullet_is_reported(share: float, reported: bool) -> None:
    """Damping c of a joint of inertia I without armature diverges in steps longer than 2 I / c."""
    robot = pendulum()
    (inertia,) = equations_of_motion(robot, {}).mass_matrix.diagonal()
    dynamics = JointDynamics(damping=share * 2.0 * inertia * 240.0, armature=100.0 * inertia)
    robot, diagnostics = replace(robot, joints=(replace(robot.joints[0], dynamics=dynamics),)), Diagnostics()
    for format_ in ("urdf", "mjcf", "sdf"):
        lower(robot, FORMATS[format_], diagnostics)
    stated = [one.message for one in diagnostics if one.code == "SB760:stiff-damping"]
    where = f"in steps longer than 3.8 ms, '{robot.joints[0].name}'"
    how = "PyBullet, whose step is 4.2 ms by default, diverges by the damping of joints"
    assert stated == reported * [f"URDF: {how}: {where}"]


@pytest.mark.parametrize("inertia", [0.1, 1e-3, 5e-7])
def test_damping_of_two_slides_along_one_line_has_no_stable_step(inertia: float) -> None:
    """Nothing is between them: their mass matrix is singular, which is no internal error, and reported elsewhere."""
    slide, turn = JointKind.PRISMATIC, JointKind.CONTINUOUS
    moves = ((slide, (1.0, 0.0, 0.0)), (slide, (0.0, 1.0, 0.0)), (slide, (1.0, 0.0, 0.0)), (turn, (0.0, 0.0, 1.0)))
    names = ("base", "a", "b", "c", "rod")
    rod = Link("rod", MassProperties.of(1.0, (0.1, 0.02, 0.01), inertia * np.eye(3)))
    joints = tuple(
        Joint(f"j{i}", kind, names[i], names[i + 1], at(), axis, dynamics=JointDynamics(damping=1e4))
        for i, (kind, axis) in enumerate(moves)
    )
    assert stiffly_damped(Robot("thin", (*map(Link, names[:-1]), rod), joints)) == []


@pytest.mark.parametrize("seed", range(12))
def test_damping_within_bounds_of_the_inertias_diverges_in_no_step(seed: int) -> None:
    """The bound never hides what the mass matrix shows, up to the damping where it no longer decides."""
    robot = drawn_robot(Random(seed), kinds=(JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.FIXED))

    def damped(scale: float) -> Robot:
        joints = []
        for i, joint in enumerate(robot.joints):
            dynamics = JointDynamics(damping=0.0 if joint.kind is JointKind.FIXED else scale * (1.0 + i))
            joints.append(replace(joint, dynamics=dynamics, mimic=None))
        return replace(robot, joints=tuple(joints))

    low, high = 1e-12, 1e9
    for _ in range(80):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if damped_softly(damped(middle)) else (low, middle)
    largest = damped(low)
    names, M = free_mass_matrix(largest)
    known = largest.joint_by_name
    damping = np.diag([known[name].dynamics.damping if name in known else 0.0 for name in names])
    rates = eigh(damping, M, eigvals_only=True)
    assert rates.max(initial=0.0) <= 2.0 * 240.0 * (1.0 + 1e-9)


@pytest.mark.parametrize("base", [Base.FIXED, Base.FLOATING])
@pytest.mark.parametrize(("share", "softly"), [(0.999, True), (1.001, False)])
def test_the_bound_of_soft_damping(share: float, base: Base, *, softly: bool) -> None:
    """A hinge about a ball of inertia I diverges from damping of 2 I / step; from I / step, the mass matrix decides."""
    ball = MassProperties.of(1.0, (0.0, 0.0, 0.0), 4e-3 * np.eye(3))
    heavy = MassProperties.of(9.0, (0.0, 0.0, 0.0), 9e-3 * np.eye(3))
    damping = JointDynamics(damping=share * 4e-3 * 240.0)
    hinge = Joint("hinge", JointKind.CONTINUOUS, "base", "wheel", at(), (0.0, 0.0, 1.0), dynamics=damping)
    robot = Robot("wheel", (Link("base", heavy), Link("wheel", ball)), (hinge,), base=base)
    assert damped_softly(robot) == softly


def test_frames_become_links_in_urdf() -> None:
    """A frame is a massless link at the end, on a fixed joint with a free name."""
    stated = lowered(two_link_arm(), "urdf", "SB760:armature", "SB762:initial-pose", "SB763:frame", "SB763:actuator")
    assert stated.links[-2:] == (Link("tool0"), Link("camera"))
    assert [joint.name for joint in stated.joints[-2:]] == ["tool0_mount", "camera_mount"]
    assert stated.links[-1].mass_properties == MassProperties()
    assert stated.frames == ()


def test_names_that_collide_are_changed_and_reported(diagnostics: ReadDiagnostics) -> None:
    """Where links, joints and frames share one namespace, duplicate joints and frames are renamed everywhere."""
    robot = odd_names()
    robot = replace(robot, frames=(*robot.frames, Frame("joint no. 1", "末端"), Frame("звено 1,5", "末端")))
    stated = lower(robot, FORMATS["sdf"], diagnostics)
    assert [joint.name for joint in stated.joints] == ["joint no. 1", "末端_joint"]
    assert [frame.name for frame in stated.frames] == ["Werkzeug (rechts)", "joint no. 1_frame", "звено 1,5_frame"]
    messages = [d.message for d in diagnostics if d.code in ("SB761:joint-name", "SB761:frame-name")]
    assert messages[0].endswith("'末端' is now '末端_joint'")
    assert len(messages) == 2
    assert lower(robot, FORMATS["mjcf"], Diagnostics()).frames == robot.frames


def test_capsules_become_cylinder_and_spheres() -> None:
    """A cylinder and two spheres have the extent of the capsule."""
    robot = primitives()
    stated = lowered(robot, "urdf", "SB763:capsule")
    (capsule,) = [c for c in robot.links[1].collisions if c.name.startswith("capsule")]
    parts = [c for c in stated.links[1].collisions if c.name.startswith("capsule")]
    assert [part.name for part in parts] == [f"capsule touched_{end}" for end in ("middle", "top", "bottom")]
    top, bottom = (part.X_LG.p for part in parts[1:])
    np.testing.assert_allclose(top - bottom, capsule.X_LG.turn((0, 0, 0.05)), atol=1e-15)
    np.testing.assert_allclose((top + bottom) / 2, capsule.X_LG.p, atol=1e-15)


def test_loop_zeros_move_only_in_loops() -> None:
    """Joints above or outside the loop keep their zero."""
    stated = lowered(four_bar_with_zeros(), "sdf", "SB763:unlimited-actuator", "SB761:loop-zero", "SB763:actuator")
    assert [joint.drawn_position for joint in stated.joints] == [0.0, 0.0, 0.0]
    robot = four_bar_with_zeros()
    extra = replace(robot.joints[0], name="turntable", child="plate", drawn_position=0.25)
    robot = replace(robot, links=(*robot.links, Link("plate")), joints=(*robot.joints, extra))
    stated = lowered(
        robot, "sdf", "SB763:unlimited-actuator", "SB762:initial-pose", "SB761:loop-zero", "SB763:actuator"
    )
    assert stated.joint_by_name["turntable"].drawn_position == 0.25


@pytest.mark.parametrize(
    ("format_", "kind", "chain"),
    [
        ("urdf", JointKind.BALL, {"_yaw": "continuous", "_pitch": "continuous", "_roll": "continuous"}),
        ("urdf", JointKind.UNIVERSAL, {"_1": "continuous", "_2": "continuous"}),
        ("urdf", JointKind.CYLINDRICAL, {"_slide": "prismatic", "_turn": "continuous"}),
        ("urdf", JointKind.SCREW, {"_slide": "prismatic", "": "continuous"}),
        ("urdf", JointKind.PLANAR, {"_x": "prismatic", "_y": "prismatic", "_turn": "continuous"}),
        ("sdf", JointKind.CYLINDRICAL, {"_slide": "prismatic", "_turn": "continuous"}),
        ("sdf", JointKind.FLOATING, {"_x": "prismatic", "_y": "prismatic", "_z": "prismatic", "_turn": "ball"}),
    ],
)
def test_joints_of_several_freedoms_are_split(
    format_: str, kind: JointKind, chain: dict[str, str], diagnostics: ReadDiagnostics
) -> None:
    """A multi-dof joint becomes single joints; the links between them have neither mass nor shape, with a warning."""
    robot = pendulum()
    stated = lower(
        replace(robot, joints=(replace(robot.joints[0], kind=kind, pitch=0.001),)), FORMATS[format_], diagnostics
    )
    assert {joint.name: joint.kind for joint in stated.joints} == {f"swing{end}": k for end, k in chain.items()}
    between = [link for link in stated.links if link.name not in robot.link_by_name]
    assert between == [Link(f"swing{end}_link") for end in list(chain)[:-1]]
    assert [joint.child for joint in stated.joints] == [*(link.name for link in between), "bob"]
    assert f"SB761:{kind}" in diagnostics.codes()


@pytest.mark.parametrize("format_", ["sdf", "mjcf"])
def test_formats_keep_the_joints_that_they_have(format_: str, diagnostics: ReadDiagnostics) -> None:
    """Ball, universal and screw joints that a format supports are unchanged."""
    for kind in (JointKind.BALL, JointKind.UNIVERSAL, JointKind.SCREW):
        robot = replace(pendulum(), joints=(replace(pendulum().joints[0], kind=kind, pitch=0.001),))
        assert lower(robot, FORMATS[format_], diagnostics).joints[0].kind is kind
    assert "SB761:ball" not in diagnostics.codes()


@pytest.mark.parametrize(("format_", "forces"), [("sdf", False), ("mjcf", True)])
def test_what_a_ball_joint_cannot_have_is_left_out(format_: str, forces: bool, diagnostics: ReadDiagnostics) -> None:
    """The effort limit of a ball joint is omitted in both formats, damping in SDFormat, each with a warning."""
    robot = ROBOTS["ball"]()
    stated = lower(robot, FORMATS[format_], diagnostics).joints[0]
    assert stated.limit == Limit()
    assert (stated.dynamics.damping == robot.joints[0].dynamics.damping) is forces
    assert "SB760:ball-limit" in diagnostics.codes()
    assert ("SB760:ball-force" in diagnostics.codes()) is not forces


def test_a_sliding_closure_is_cut_at_a_pin(diagnostics: ReadDiagnostics) -> None:
    """MJCF has no sliding constraint: the cylinder becomes a joint, and the wrist closes the loop."""
    robot = sliding_closure()
    stated = lower(robot, FORMATS["mjcf"], diagnostics)
    assert [(closure.name, closure.kind) for closure in stated.closures] == [("wrist", JointKind.REVOLUTE)]
    assert stated.joint_by_name["cylinder"].kind is JointKind.PRISMATIC
    assert (stated.joint_by_name["cylinder"].parent, stated.joint_by_name["cylinder"].child) == ("block", "piston")
    assert degrees_of_freedom(stated) == degrees_of_freedom(robot) == 1
    assert "SB763:sliding-closure" in diagnostics.codes()


@pytest.mark.parametrize("actuated", [(), ("big_end",), ("shaft",), ("wrist", "big_end")])
def test_a_loop_cut_elsewhere_moves_equally(actuated: tuple[str, ...]) -> None:
    """For any joint that closes the loop, every point and sensor of every link moves equally, masses are unchanged."""
    robot = sliding_closure()
    X_LS = Pose.from_xyz_rpy((0.01, -0.02, 0.03), (0.1, -0.2, 0.3))
    imus = tuple(Sensor(f"{link.name}_imu", SensorKind.IMU, link.name, X_LS) for link in robot.links)
    actuators = tuple(Actuator(name, name, ActuatorKind.MOTOR) for name in actuated)
    robot = replace(robot, actuators=actuators, sensors=imus)
    stated = reroot_loops(robot)
    assert stated.closures != robot.closures
    check_robot(stated, sound := Diagnostics())
    assert not list(sound)
    for way in loop_ways(robot, 6):
        for q in way:
            driven = driven_joints(robot)
            known = {name: q[name] for name in driven if name in stated.joint_by_name}
            if len(known) < len(driven):  # the driven joint closes the loop now
                continue
            guess = {name: q.get(name, 0.0) for name in stated.joint_by_name}
            closed = close_loops(stated, guess, driven)
            before, after = link_poses(robot, q), link_poses(stated, closed)
            for link in robot.links:
                com, moved = link.mass_properties.com, stated.link_by_name[link.name].mass_properties.com
                np.testing.assert_allclose(before[link.name].apply(com), after[link.name].apply(moved), atol=1e-9)
            for one, other in zip(robot.sensors, stated.sensors, strict=True):
                X_WS, moved_to = before[one.link] @ one.X_LS, after[other.link] @ other.X_LS
                np.testing.assert_allclose(X_WS.matrix, moved_to.matrix, atol=1e-9)


@pytest.mark.parametrize(
    ("kind", "q"),
    [
        (JointKind.REVOLUTE, {"j": 0.7}),
        (JointKind.PRISMATIC, {"j": 0.7}),
        (JointKind.UNIVERSAL, {"j_1": 0.7, "j_2": -0.4}),
    ],
)
def test_a_joint_with_parent_and_child_exchanged_moves_equally(kind: JointKind, q: dict[str, float]) -> None:
    """For equal coordinates, in the frames that both links get; those of a universal joint change places."""
    X_PC, X_CN = (Pose.from_xyz_rpy(xyz, rpy) for xyz, rpy in (((1, 2, 3), (0.1, 0.2, 0.3)), ((0, 1, 0), (0, 0.5, 1))))
    joint = Joint("j", kind, "p", "c", X_PC, (0.6, 0.0, 0.8), axis2=(0.0, 1.0, 0.0), limit=Limit(-1.0, 1.0))
    back = _turned(joint, {"c": X_CN, "p": X_PC})
    swapped = {"j_1": q["j_2"], "j_2": q["j_1"]} if "j_2" in q else q
    X_C = link_poses(Robot("there", (Link("p"), Link("c")), (joint,)), q)["c"]
    X_P = link_poses(Robot("back", (Link("c"), Link("p")), (back,)), swapped)["p"]
    assert X_P.matrix == pytest.approx(((X_C @ X_CN).inverse() @ X_PC).matrix, abs=1e-12)


def test_a_sliding_closure_without_a_plain_pin_is_an_error(diagnostics: ReadDiagnostics) -> None:
    """A sliding closure without a plain pin to cut is an error: a constraint has no dynamics, limits or actuator."""
    robot = sliding_closure()
    joints = tuple(replace(joint, dynamics=JointDynamics(damping=1.0)) for joint in robot.joints)
    assert render(replace(robot, joints=joints), "mjcf", diagnostics) == {}
    assert "SB764:stuck-closure" in diagnostics.codes()


def test_a_loop_is_cut_at_a_pin_with_limits_of_its_motor(diagnostics: ReadDiagnostics) -> None:
    """A default effort on all joints keeps no loop from being cut at a passive pin; a note names what is left out."""
    robot = sliding_closure()
    joints = tuple(replace(joint, limit=replace(joint.limit, effort=1.0)) for joint in robot.joints)
    stated = lower(replace(robot, joints=joints), FORMATS["mjcf"], diagnostics)
    assert [closure.name for closure in stated.closures] == ["wrist"]
    (note,) = (one for one in diagnostics if one.code == "SB763:sliding-closure")
    assert "'cylinder' at 'wrist', without its limits of effort and velocity" in note.message


@pytest.mark.parametrize(
    ("format_", "name"), [("urdf", "world"), ("sdf", "world"), ("sdf", "__model__"), ("sdf", "a::b"), ("mjcf", "world")]
)
def test_reserved_names_are_errors(format_: str, name: str, diagnostics: ReadDiagnostics) -> None:
    """A link named like a reserved word of the format is an error."""
    robot = pendulum()
    root = replace(robot.root, name=name)
    robot = replace(robot, links=(root, robot.links[1]), joints=(replace(robot.joints[0], parent=name),))
    assert render(robot, format_, diagnostics) == {}
    assert "SB764:reserved-name" in diagnostics.codes()


def test_floating_base_is_written_where_supported(diagnostics: ReadDiagnostics) -> None:
    """Only URDF leaves the base to its reader."""
    robot = replace(pendulum(), base=Base.FLOATING)
    for format_ in FORMATS:
        lower(robot, FORMATS[format_], diagnostics)
    assert [(d.span.file, d.severity) for d in diagnostics if d.code == "SB762:floating-base"] == [
        ("pendulum.urdf", "note")
    ]


@pytest.mark.parametrize("facets", [20, 2000])
def test_concave_collisions_are_named_for_mujoco(facets: int) -> None:
    """Concave collisions are reported for MuJoCo, which uses hulls, however fine their mesh is."""
    robot = one_link()
    asset = MeshAsset("trough", trough(facets))
    link = replace(robot.root, collisions=(Collision("touched", MeshRef("trough")),))
    robot = replace(robot, links=(link,), meshes=(*robot.meshes, asset))
    assert lowered(robot, "mjcf", "SB760:concave-collision") == robot
    assert lowered(robot, "urdf") == robot
    assert lowered(robot, "usd", "SB763:concave-collision") == robot


def test_links_without_mass_get_some_in_usd() -> None:
    """In USD a mass or an inertia of 0 means that an engine computes it: links without get a milligram."""
    robot = pendulum()
    point = MassProperties(2.0, (0.1, 0.2, 0.3))
    bodies = (replace(robot.root, mass_properties=MassProperties()), replace(robot.links[1], mass_properties=point))
    stated = lowered(replace(robot, links=bodies), "usd", "SB761:massless")
    base, bob = (link.mass_properties for link in stated.links)
    assert (base.mass, bob.mass, bob.com) == (STAND_IN_MASS, 2.0, point.com)
    for body in (base, bob):
        np.testing.assert_array_equal(body.inertia, STAND_IN_MOMENT * np.eye(3))


def test_a_mimic_between_an_angle_and_a_distance_is_left_out_of_usd(diagnostics: ReadDiagnostics) -> None:
    """Newton's mimics relate joints of one type; a screw's two halves are of two."""
    stated = lower(ROBOTS["screw"](), FORMATS["usd"], diagnostics)
    assert stated.joint_by_name["spindle_slide"].mimic is None
    assert stated.joint_by_name["hinge"].mimic == ROBOTS["screw"]().joint_by_name["hinge"].mimic
    assert "'spindle_slide' after 'spindle'" in next(
        one.message for one in diagnostics if one.code == "SB760:mixed-mimic"
    )


def test_usd_has_one_actuator_for_each_joint(diagnostics: ReadDiagnostics) -> None:
    """A joint with several actuators keeps the first."""
    robot = equipped()
    stated = lower(robot, FORMATS["usd"], diagnostics)
    first = {actuator.joint: actuator.name for actuator in reversed(robot.actuators)}
    assert [one.name for one in stated.actuators] == [a.name for a in robot.actuators if a.name in first.values()]
    assert len(stated.actuators) == len(first) < len(robot.actuators)


def test_friction_of_an_mjcf() -> None:
    """Friction cones are elliptic with a hundred times stiffer friction, without which a gripped cube slips slowly."""
    files = render(two_link_arm(), "mjcf", Diagnostics())
    text = next(content for name, content in files.items() if name.endswith(".xml") and "scene" not in name).decode()
    assert 'cone="elliptic" impratio="100"' in text
