"""The data sheet against closed forms: a plane arm of three rods, and robots that stand."""

from math import inf, pi, sin, sqrt
from random import Random

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.report.words import sheet_blocks
from stepbot.robot.datasheet import accelerations, data_sheet
from stepbot.robot.dh import dh_table, forward
from stepbot.robot.kinematics import configurations, link_poses
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Collision,
    ComponentMass,
    Frame,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    Robot,
    Sphere,
)
from stepbot.robot.motors import Motor
from stepbot.sidecar.motors import find_motor, fitted
from tests.random_robots import drawn_robot

G = 9.81
LENGTHS, MASSES, EFFORTS = (0.5, 0.4, 0.3), (2.0, 1.5, 1.0), (60.0, 30.0, 9.0)


def plane_arm() -> Robot:
    """Three rods in the plane x, z, whose joints turn about y by half a turn each way."""
    links, joints = [Link("base")], []
    for i, (length, mass) in enumerate(zip(LENGTHS, MASSES, strict=True)):
        across = mass * length**2 / 12.0
        inertia = ((0.0, 0.0, 0.0), (0.0, across, 0.0), (0.0, 0.0, across))
        links.append(Link(f"rod{i}", MassProperties(mass, (0.5 * length, 0.0, 0.0), inertia)))
        place = Pose.of(position=(LENGTHS[i - 1] if i else 0.0, 0.0, 0.0))
        limit = Limit(-0.5 * pi, 0.5 * pi, 2.0, EFFORTS[i])
        joint = Joint(f"j{i}", JointKind.REVOLUTE, links[-2].name, f"rod{i}", place, (0.0, 1.0, 0.0))
        joints.append(replace(joint, limit=limit, dynamics=JointDynamics(armature=0.01)))
    servo = Actuator("servo", "j2", ActuatorKind.POSITION, kp=40.0, kv=1.0)
    tip = Frame("tip", "rod2", Pose.of(position=(LENGTHS[2], 0.0, 0.0)))
    return Robot("arm", tuple(links), tuple(joints), frames=(tip,), actuators=(servo,))


def test_plane_arm() -> None:
    """Gravity, inertia, acceleration, frequency, reach and payload of a plane arm are those of the stretched arm."""
    sheet = data_sheet(plane_arm())
    last = sheet.joints[2]
    held = MASSES[2] * G * 0.5 * LENGTHS[2]
    inertia = MASSES[2] * LENGTHS[2] ** 2 / 3.0 + 0.01
    assert last.inertia == pytest.approx((inertia, inertia), rel=1e-3)
    assert last.gravity == pytest.approx(held, rel=1e-3)
    assert last.frequency == pytest.approx((sqrt(40.0 / inertia) / (2.0 * pi),) * 2, rel=1e-3)
    assert last.acceleration is not None
    assert 0.0 < last.acceleration <= (EFFORTS[2] - held) / inertia * (1.0 + 1e-3)
    (arm,) = sheet.arms
    assert (arm.tip, arm.joints) == ("tip", ("j0", "j1", "j2"))
    assert arm.reach == pytest.approx(sum(LENGTHS), rel=1e-3)
    payload = inf
    for i in range(3):
        reached = np.cumsum((0.0, *LENGTHS[i:]))
        own = sum(m * G * (x + 0.5 * a) for m, x, a in zip(MASSES[i:], reached[:-1], LENGTHS[i:], strict=True))
        assert sheet.joints[i].gravity == pytest.approx(own, rel=1e-3)
        payload = min(payload, (EFFORTS[i] - own) / (G * reached[-1]))
    assert arm.payloads[-1] == (pytest.approx(sum(LENGTHS), rel=1e-3), pytest.approx(payload, rel=2e-3))
    assert arm.dh is not None
    assert [row.a for row in arm.dh.rows] == pytest.approx([0.5, 0.4, 0.0])
    assert arm.dh.tool.position == pytest.approx((0.3, 0.0, 0.0))


@pytest.mark.parametrize("scale", [1e-3, 1e-2])
def test_figures_of_a_tiny_arm(scale: float) -> None:
    """Of one density, torques of weight go with the fourth power of the size, and inertias with the fifth."""
    arm = plane_arm()
    links = [
        replace(
            link,
            mass_properties=MassProperties(
                scale**3 * link.mass_properties.mass,
                tuple(scale * x for x in link.mass_properties.com),
                tuple(tuple(scale**5 * x for x in row) for row in link.mass_properties.inertia),
            ),
        )
        for link in arm.links
    ]
    joints = [
        replace(
            joint,
            X_PC=Pose.of(position=tuple(scale * x for x in joint.X_PC.p)),
            dynamics=JointDynamics(armature=scale**5 * 0.01),
            limit=replace(joint.limit, effort=scale**4 * joint.limit.effort),
        )
        for joint in arm.joints
    ]
    tiny = data_sheet(replace(arm, links=tuple(links), joints=tuple(joints), frames=(), actuators=()))
    for one, large in zip(tiny.joints, data_sheet(arm).joints, strict=True):
        assert one.gravity == pytest.approx(scale**4 * large.gravity, rel=1e-2)
        assert one.inertia == pytest.approx(tuple(scale**5 * x for x in large.inertia), rel=1e-2)


def parallelogram() -> Robot:
    """Two upright rods of 0.4 m, 0.6 m apart, kept parallel by a coupler; the first one turns by 60 degrees."""

    def rod(name: str, mass: float, length: float, along: tuple[float, float, float]) -> Link:
        across = mass * length**2 / 12.0
        inertia = tuple(tuple(across * (i == j and not along[i]) for j in range(3)) for i in range(3))
        return Link(name, MassProperties(mass, tuple(0.5 * length * one for one in along), inertia))

    y, up, end = (0.0, 1.0, 0.0), Pose.of(position=(0.0, 0.0, 0.4)), Pose.of(position=(0.6, 0.0, 0.0))
    links = (Link("base"), rod("crank", 2.0, 0.4, (0, 0, 1)), rod("coupler", 3.0, 0.6, (1, 0, 0)))
    links = (*links, rod("rocker", 1.0, 0.4, (0, 0, 1)))
    joints = (
        Joint("crank_turn", JointKind.REVOLUTE, "base", "crank", axis=y, limit=Limit(-pi / 3, pi / 3, 2.0, 30.0)),
        Joint("pin", JointKind.CONTINUOUS, "crank", "coupler", up, y),
        Joint("rocker_turn", JointKind.CONTINUOUS, "base", "rocker", end, y),
    )
    closure = LoopClosure("last_pin", JointKind.REVOLUTE, "coupler", end, "rocker", up, y)
    motor = Actuator("motor", "crank_turn", ActuatorKind.POSITION, kp=100.0, kv=1.0)
    return Robot("parallelogram", links, joints, (closure,), actuators=(motor,))


def test_a_joint_that_drives_a_loop_moves_all_of_it() -> None:
    """The coupler of a parallelogram moves as a point at the end of the crank, and the rocker as the crank."""
    sheet = data_sheet(parallelogram())
    (crank,) = sheet.joints
    inertia = (2.0 + 1.0) * 0.4**2 / 3.0 + 3.0 * 0.4**2
    held = G * 0.4 * (0.5 * 2.0 + 0.5 * 1.0 + 3.0) * sin(pi / 3)
    assert crank.name == "crank_turn"
    assert crank.inertia == pytest.approx((inertia, inertia), rel=1e-6)
    assert 0.98 * held < crank.gravity <= held * (1.0 + 1e-6)
    assert crank.acceleration == pytest.approx((30.0 - crank.gravity) / inertia, rel=0.01)
    assert crank.frequency == pytest.approx((sqrt(100.0 / inertia) / (2.0 * pi),) * 2, rel=1e-3)


def test_an_arm_with_a_closed_hand_has_its_reach_and_payload() -> None:
    """A loop on the last rod of the plane arm is its load, and hides neither its reach nor what it carries."""
    arm, hand = plane_arm(), parallelogram()
    base = replace(hand.joints[0], parent="rod2"), hand.joints[1], replace(hand.joints[2], parent="rod2")
    light = tuple(replace(one, mass_properties=one.mass_properties.scaled(1e-6)) for one in hand.links[1:])
    whole = replace(
        arm,
        links=(*arm.links, *light),
        joints=(*arm.joints, *base),
        closures=hand.closures,
        actuators=(*arm.actuators, *hand.actuators),
    )
    (alone,), (carrying,) = data_sheet(arm).arms, data_sheet(whole).arms
    assert (carrying.tip, carrying.joints, carrying.reach) == (alone.tip, alone.joints, alone.reach)
    assert carrying.payloads[-1][1] == pytest.approx(alone.payloads[-1][1], rel=0.01)


@pytest.mark.slow
def test_jerk_is_what_the_gains_follow() -> None:
    """In MuJoCo the acceleration of a servo lags behind that of a target of constant jerk by acceleration / jerk.

    A limit of the joint takes precedence.
    """
    mujoco = pytest.importorskip("mujoco")
    arm = plane_arm()
    last = data_sheet(arm).joints[2]
    assert last.jerk is not None
    assert last.acceleration is not None
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.0001" gravity="0 0 0"/><worldbody><body>
        <joint name="j" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="0.03 {last.inertia[1]} 0.03"/>
        </body></worldbody><actuator><position joint="j" kp="40" kv="1"/></actuator></mujoco>"""
    )
    data = mujoco.MjData(model)
    while data.time < 1.0:
        data.ctrl[0] = data.time**3 / 6.0
        mujoco.mj_step(model, data)
    assert data.time - data.qacc[0] == pytest.approx(last.acceleration / last.jerk, rel=0.01)
    limit = replace(arm.joints[2].limit, jerk=7.0)
    limited = replace(arm, joints=(*arm.joints[:2], replace(arm.joints[2], limit=limit)))
    assert data_sheet(limited).joints[2].jerk == 7.0
    assert data_sheet(arm).joints[0].jerk is None  # without a position actuator


def test_workspace_is_within_the_reach() -> None:
    """Bands of a plane arm of half turns lie within the circle of its reach, and come near to it at their height."""
    (plane,) = data_sheet(plane_arm()).arms
    reach, tall = sum(LENGTHS), plane.workspace[1][0] - plane.workspace[0][0]
    assert len(plane.workspace) == 24
    for z, near, far in plane.workspace:
        assert 0.0 <= near <= far
        assert far <= sqrt(reach**2 - max(0.0, abs(z) - 0.5 * tall) ** 2) + 1e-3
    assert max(far for _, _, far in plane.workspace) > 0.97 * reach


@pytest.mark.slow
def test_masses_by_material() -> None:
    """Components are summed by motor, by material, by density without a name; the table is heaviest first."""
    parts = (
        ComponentMass("case", 0.2, 2700.0, 1e-4, "defaults", "exact", "aluminium"),
        ComponentMass("lid", 0.1, 2700.0, 1e-4, "parts rule 'lid'", "exact", "aluminium"),
        ComponentMass("print", 0.05, 1040.0, 1e-4, "parts rule 'print'", "exact"),
        ComponentMass("servo/case", 0.04, None, 1e-5, "motor of actuator 'servo'", "given"),
        ComponentMass("servo/horn", 0.017, None, 1e-5, "motor of actuator 'servo'", "given"),
        ComponentMass("battery", 0.4, None, 1e-4, "parts rule 'battery'", "given", "lead"),
    )
    arm = plane_arm()
    links = (replace(arm.links[0], masses=parts[:3]), replace(arm.links[1], masses=parts[3:]), *arm.links[2:])
    servo = replace(arm.actuators[0], motor=Motor("XL430-W250"))
    sheet = data_sheet(replace(arm, links=links, actuators=(servo,)))
    assert [name for name, _ in sheet.materials] == ["given masses", "aluminium", "motor XL430-W250", "1040 kg/m^3"]
    assert [mass for _, mass in sheet.materials] == pytest.approx([0.4, 0.3, 0.057, 0.05])
    assert data_sheet(arm).materials == ()


def test_the_play_of_a_joint_is_the_backlash_of_its_motor_after_the_gear() -> None:
    """A motor that turns three times as far has a third of its backlash at the joint, 2 pi / lead of it on a slide."""
    arm, play = plane_arm(), 0.004363
    for kind, gear, expected, unit in (
        (JointKind.REVOLUTE, 3.0, play / 3.0, "rad"),
        (JointKind.PRISMATIC, -500.0, play / 500.0, "m"),
    ):
        servo = replace(arm.actuators[0], motor=fitted(find_motor("XM430-W350"), kind, None, gear))
        sheet = data_sheet(replace(arm, actuators=(servo,)))
        assert sheet.backlash == ((servo.joint, pytest.approx(expected, rel=1e-3), unit),)
        assert f"- {servo.joint}: play of {expected:.3g} {unit}, the backlash of its motor" in [*sheet_blocks(sheet)]
    without = fitted(find_motor("STS3215-7.4V"), JointKind.REVOLUTE, None, 1.0)
    sheet = data_sheet(replace(arm, actuators=(replace(arm.actuators[0], motor=without),)))
    assert sheet.backlash == ()


def test_acceleration_of_a_pendulum() -> None:
    """A rod that its effort holds level accelerates upwards by what is left: (tau - m g l / 2) / (m l^2 / 3)."""
    arm = plane_arm()
    rod = replace(arm, links=arm.links[:2], joints=arm.joints[:1], frames=(), actuators=())
    inertia = MASSES[0] * LENGTHS[0] ** 2 / 3.0 + 0.01
    expected = (EFFORTS[0] - 0.5 * MASSES[0] * G * LENGTHS[0]) / inertia
    found = accelerations(rod)["j0"]
    assert found == pytest.approx(expected, rel=0.01)
    assert found <= expected
    free = replace(rod, joints=(replace(rod.joints[0], limit=Limit(-1.0, 1.0)),))
    assert accelerations(free) == {}


def test_acceleration_of_a_joint_that_drives_a_loop() -> None:
    """The crank of a parallelogram moves all of it; the joints that follow have none."""
    inertia = (2.0 + 1.0) * 0.4**2 / 3.0 + 3.0 * 0.4**2
    held = G * 0.4 * (0.5 * 2.0 + 0.5 * 1.0 + 3.0) * sin(pi / 3)
    found = accelerations(parallelogram())
    assert set(found) == {"crank_turn"}
    assert found["crank_turn"] == pytest.approx((30.0 - held) / inertia, rel=0.02)
    robot = parallelogram()
    (closure,) = robot.closures
    far = replace(closure, X_BF=Pose.of(position=(0.0, 0.0, 9.0)))
    assert accelerations(replace(robot, closures=(far,))) == {}  # convert reports the open loop


@pytest.mark.parametrize("seed", range(12))
def test_tables_are_the_kinematics(seed: int) -> None:
    """A table exists for every chain of turning and sliding joints, and gives the pose of its tip."""
    random = np.random.default_rng(seed)
    links, joints = [Link("l0")], []
    for i in range(1, 7):
        kind = JointKind.PRISMATIC if random.random() < 0.25 else JointKind.CONTINUOUS
        rpy = tuple(random.choice([0.0, pi / 2, -pi / 2, pi, random.uniform(-3, 3)]) for _ in range(3))
        xyz = tuple(random.choice([0.0, random.uniform(-1, 1)]) for _ in range(3))
        links.append(Link(f"l{i}"))
        joints.append(Joint(f"j{i}", kind, f"l{i - 1}", f"l{i}", Pose.from_xyz_rpy(xyz, rpy), (0.0, 0.6, 0.8)))  # type: ignore[arg-type]
    robot = Robot("chain", tuple(links), tuple(joints))
    tip = Frame("tip", "l6", Pose.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)))
    table = dh_table(robot, [joint.name for joint in joints], tip)
    assert table is not None
    for q in configurations(robot, 4, seed=seed):
        distance, angle = forward(table, dict(q)).distance_to(link_poses(robot, q)["l6"] @ tip.X_LF)
        assert distance < 1e-6
        assert angle < 1e-6


def test_com_of_a_tripod_is_inside_of_its_feet() -> None:
    """The margin is the distance of the com to the nearest edge of the triangle of the feet."""
    feet = [(0.3, 0.0), (-0.3, 0.3), (-0.3, -0.3)]
    ball = Sphere(0.05)
    body = Link("body", MassProperties(1.0, (0.0, 0.0, 0.3), ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))))
    links = [Link(f"foot{i}", collisions=(Collision(f"c{i}", ball),)) for i in range(3)]
    joints = [
        Joint(f"j{i}", JointKind.FIXED, "body", f"foot{i}", Pose.of(position=(x, y, -0.4)))
        for i, (x, y) in enumerate(feet)
    ]
    sheet = data_sheet(Robot("tripod", (body, *links), tuple(joints), base=Base.FLOATING))
    assert sheet.standing is not None
    height, margin = sheet.standing
    assert height == pytest.approx(0.45)
    # The edge from (0.3, 0) to (-0.3, 0.3) is x + 2 y = 0.3.
    assert margin == pytest.approx(0.3 / sqrt(5.0), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_every_robot_has_one(seed: int) -> None:
    """No robot breaks it, and masses are those of its links."""
    robot = drawn_robot(Random(seed))
    sheet = data_sheet(robot)
    assert sheet.mass == pytest.approx(sum(link.mass_properties.mass for link in robot.links))
