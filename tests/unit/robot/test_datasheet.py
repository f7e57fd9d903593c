"""The data sheet against closed forms: a plane arm of three rods, and robots that stand."""

from dataclasses import replace
from math import inf, pi, sqrt
from random import Random

import numpy as np
import pytest

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.datasheet import accelerations, data_sheet
from stepbot.robot.dh import dh_table, forward
from stepbot.robot.kinematics import configurations, link_poses
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
    Robot,
    Sphere,
)
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
        payload = min(payload, (EFFORTS[i] - own) / (G * reached[-1]))
    assert arm.payloads[-1] == (pytest.approx(sum(LENGTHS), rel=1e-3), pytest.approx(payload, rel=2e-3))
    assert arm.dh is not None
    assert [row.a for row in arm.dh.rows] == pytest.approx([0.5, 0.4, 0.0])
    assert arm.dh.tool.position == pytest.approx((0.3, 0.0, 0.0))


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


@pytest.mark.parametrize("seed", range(6))
def test_every_robot_has_one(seed: int) -> None:
    """No robot breaks it, and masses are those of its links."""
    robot = drawn_robot(Random(seed))
    sheet = data_sheet(robot)
    assert sheet.mass == pytest.approx(sum(link.mass_properties.mass for link in robot.links))
