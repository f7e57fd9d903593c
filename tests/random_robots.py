"""Robots drawn at random, with the numbers at which engines change their behaviour: tiny, huge, nearly aligned.

``drawn_robot`` takes a :class:`random.Random`, so that Hypothesis can draw it (``st.randoms``) and a loop can count
through seeds.
"""

import math
from collections.abc import Sequence
from itertools import combinations
from math import inf
from random import Random

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose, Vector3, matrix3, rotation_about, turn_inertia, vector3
from stepbot.robot.kinematics import without_contacts
from stepbot.robot.model import (
    GREY,
    Actuator,
    ActuatorKind,
    Base,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Frame,
    Geometry,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    MeshAsset,
    MeshRef,
    Mimic,
    Robot,
    Sphere,
    Visual,
)
from stepbot.robot.renaming import renamed
from stepbot.robot.sensors import Sensor, SensorKind, View
from stepbot.robot.surfaces import Surface

TINY = (0.0, 1e-12, 1e-9, 4e-7, 1e-6, 3e-6, 1e-4)
"""Distances [m] and angles [rad] around thresholds of engines."""
SINGLE = (JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC)
SEVERAL = (
    JointKind.BALL,
    JointKind.UNIVERSAL,
    JointKind.CYLINDRICAL,
    JointKind.SCREW,
    JointKind.PLANAR,
    JointKind.FLOATING,
)


def drawn_robot(random: Random, kinds: Sequence[JointKind] = (*SINGLE * 3, JointKind.FIXED, *SEVERAL)) -> Robot:
    """A valid robot of two to six links, with joints of these types.

    Args:
        random: The source of every choice.
        kinds: Types of joints; the more often one is listed, the more likely it is.
    """
    size = 10.0 ** random.uniform(-2.5, 0.5)
    meshes = [MeshAsset(f"mesh_{n}", _mesh(random, size)) for n in range(random.randint(1, 2))]
    names = ["base", *(f"link_{n}" for n in range(1, random.randint(2, 6)))]
    links = tuple(_link(random, name, size, meshes) for name in names)
    joints: list[Joint] = []
    for n, child in enumerate(names[1:], start=1):
        joints.append(_joint(random, f"joint_{n}", random.choice(kinds), random.choice(names[:n]), child, size))
    joints = _with_a_mimic(random, joints)
    free = [joint for joint in joints if joint.kind in SINGLE and joint.mimic is None]
    used = {one.geometry.name for link in links for one in (*link.visuals, *link.collisions) if _is_mesh(one.geometry)}
    return Robot(
        "drawn",
        links,
        tuple(joints),
        frames=tuple(
            Frame(f"frame_{n}", random.choice(names), _pose(random, size)) for n in range(random.randint(0, 2))
        ),
        actuators=tuple(_actuator(random, joint) for joint in free if random.random() < 0.5),
        meshes=tuple(one for one in meshes if one.name in used),
        base=random.choice((Base.FIXED, Base.FIXED, Base.FLOATING)),
        source="drawn.step",
        sensors=tuple(_sensors(random, names, free, size)),
    )


def _is_mesh(geometry: Geometry) -> bool:
    return isinstance(geometry, MeshRef)


def _number(random: Random, size: float) -> float:
    """A length [m] or an angle [rad]: any, or near a threshold."""
    sign = random.choice((-1.0, 1.0))
    return sign * (random.choice(TINY) if random.random() < 0.4 else size * random.uniform(0.01, 1.0))


def _vector(random: Random, size: float) -> Vector3:
    return vector3([_number(random, size) for _ in range(3)])


def _direction(random: Random) -> Vector3:
    """A unit vector: any, an axis of the frame, or nearly one."""
    if random.random() < 0.5:
        direction = np.zeros(3)
        direction[random.randrange(3)] = random.choice((-1.0, 1.0))
        direction = direction + np.array(_vector(random, 0.0)) * random.choice((0.0, 1.0))
    else:
        direction = np.array([random.gauss(0.0, 1.0) for _ in range(3)]) + 1e-3
    return vector3(direction / np.linalg.norm(direction))


def _turn(random: Random) -> np.ndarray:
    """A rotation (3, 3): any, near none, a quarter turn, or near one in which roll and yaw are about one axis."""
    angle = random.choice((0.0, random.choice(TINY), math.pi / 2, math.pi, random.uniform(-3.0, 3.0)))
    R = rotation_about(_direction(random), angle)
    return R @ rotation_about((0.0, 1.0, 0.0), math.pi / 2 - random.choice(TINY)) if random.random() < 0.1 else R


def _pose(random: Random, size: float) -> Pose:
    return Pose.of(_turn(random), _vector(random, size))


def _mesh(random: Random, size: float) -> TriMesh:
    """A box with corners moved at random."""
    import trimesh

    box = trimesh.creation.box(extents=[size * random.uniform(0.2, 1.0) for _ in range(3)])
    moved = box.vertices * np.array([[random.uniform(0.8, 1.2) for _ in range(3)] for _ in box.vertices])
    return TriMesh.of(moved, box.faces)


def _geometry(random: Random, size: float, meshes: Sequence[MeshAsset]) -> Geometry:
    def length() -> float:
        return size * random.uniform(0.05, 1.0)

    made = (
        lambda: Box((length(), length(), length())),
        lambda: Sphere(length()),
        lambda: Cylinder(length(), length()),
        lambda: Capsule(length(), length()),
        lambda: MeshRef(random.choice(meshes).name),
    )
    return random.choice(made)()


def _body(random: Random, size: float) -> MassProperties:
    """Mass properties of points within a size: any, flat, round, or nearly aligned with the frame."""
    mass = 10.0 ** random.uniform(-4.0, 3.0)
    spread = [size * random.uniform(0.05, 0.5) for _ in range(3)]
    if random.random() < 0.3:
        spread[1] = spread[0]  # round
    if random.random() < 0.1:
        spread[2] = size * 1e-3  # flat
    a, b, c = (length**2 for length in spread)
    inertia = turn_inertia(_turn(random), np.diag([b + c, a + c, a + b]) * mass)
    return MassProperties(mass, _vector(random, size), matrix3(0.5 * (inertia + inertia.T)))


def _link(random: Random, name: str, size: float, meshes: Sequence[MeshAsset]) -> Link:
    def pose() -> Pose:
        return _pose(random, size)

    seen = [_geometry(random, size, meshes) for _ in range(random.randint(0, 2))]
    touched = [_geometry(random, size, meshes) for _ in range(random.randint(0, 2))]
    r, g, b = (random.choice((0.0, 1.0, random.random())) for _ in range(3))
    return Link(
        name,
        _body(random, size),
        tuple(Visual(f"{name}_visual_{n}", one, pose(), (r, g, b, 1.0)) for n, one in enumerate(seen)),
        tuple(Collision(f"{name}_collision_{n}", one, pose()) for n, one in enumerate(touched)),
    )


def _limit(random: Random, kind: JointKind) -> Limit:
    lower, upper = -random.uniform(0.01, 3.0), random.uniform(0.01, 3.0)
    if random.random() < 0.2:
        lower = random.choice((0.0, -1e-6, -2 * math.pi, -10.0))
    velocity, effort = (random.choice((inf, 10.0 ** random.uniform(-3.0, 3.0))) for _ in range(2))
    if kind is JointKind.CONTINUOUS or kind in SEVERAL or (kind is JointKind.PRISMATIC and random.random() < 0.1):
        return Limit(velocity=velocity, effort=effort)
    return Limit(lower, upper, velocity, effort)


def _joint(random: Random, name: str, kind: JointKind, parent: str, child: str, size: float) -> Joint:
    X_PC = _pose(random, size)
    if kind is JointKind.FIXED:
        return Joint(name, kind, parent, child, X_PC)
    axis = _direction(random)
    across = np.cross(axis, (0.3, 0.5, 0.8) if abs(axis[0]) > 0.5 else (1.0, 0.2, 0.1))

    def some(greatest: float) -> float:
        return random.choice((0.0, 10.0 ** random.uniform(-6.0, math.log10(greatest))))

    dynamics = JointDynamics(some(10.0), some(10.0))
    if kind in SINGLE:
        dynamics = JointDynamics(some(10.0), some(10.0), some(100.0), 0.0, some(1.0))
    if dynamics.stiffness:
        dynamics = JointDynamics(*(dynamics.damping, dynamics.friction, dynamics.stiffness), 0.1, dynamics.armature)
    return Joint(
        name,
        kind,
        parent,
        child,
        X_PC,
        axis,
        vector3(across / np.linalg.norm(across)),
        limit=_limit(random, kind) if kind not in (JointKind.FLOATING, JointKind.PLANAR) else Limit(),
        dynamics=dynamics if kind not in (JointKind.FLOATING, JointKind.PLANAR) else JointDynamics(),
        pitch=random.choice((-1.0, 1.0)) * 10.0 ** random.uniform(-4.0, -1.0) if kind is JointKind.SCREW else 0.0,
    )


def _with_a_mimic(random: Random, joints: Sequence[Joint]) -> list[Joint]:
    """One joint follows an earlier one of its kind, without limits of its own."""
    turning = [joint for joint in joints if joint.kind is JointKind.CONTINUOUS]
    if len(turning) < 2 or random.random() < 0.5:
        return list(joints)
    leader, follower = turning[:2]
    mimic = Mimic(leader.name, random.choice((-1.0, 1.0, 0.5, random.uniform(0.1, 3.0))), random.choice((0.0, 0.3)))
    return [
        replace(joint, mimic=mimic, dynamics=JointDynamics(), limit=Limit()) if joint is follower else joint
        for joint in joints
    ]


def _actuator(random: Random, joint: Joint) -> Actuator:
    kind = random.choice(tuple(ActuatorKind))
    gain = 10.0 ** random.uniform(-3.0, 4.0)
    gear = random.choice((1.0, -1.0, 50.0, random.uniform(0.1, 200.0)))
    return Actuator(
        f"{joint.name}_drive",
        joint.name,
        kind,
        kp=gain if kind is ActuatorKind.POSITION else 0.0,
        kv=0.0 if kind is ActuatorKind.MOTOR else gain / 10.0,
        gear=gear,
    )


def _sensors(random: Random, links: Sequence[str], joints: Sequence[Joint], size: float) -> list[Sensor]:
    made = []
    if random.random() < 0.4:
        made.append(Sensor("imu", SensorKind.IMU, random.choice(links), _pose(random, size), rate=100.0))
    if random.random() < 0.3:
        view = View(random.uniform(0.2, 1.5), 64, 48, 0.1 * size, 100.0 * size)
        made.append(Sensor("camera", SensorKind.CAMERA, random.choice(links), _pose(random, size), view=view))
    if joints and random.random() < 0.3:
        joint = random.choice(joints)
        made.append(Sensor("encoder", SensorKind.JOINT, joint.child, joint=joint.name, rate=50.0))
    return made


def widened(random: Random, robot: Robot) -> Robot:
    """A robot as more of those in the field are: with what :func:`drawn_robot` never draws.

    It starts away from q = 0; slides, and hinges with limits, follow others; a tool has no mass; shapes are
    transparent and have contact properties, one by one; pairs of links do not touch; names are of other languages;
    sensors feel and see.
    """
    joints = _started(random, _with_followers(random, robot.joints))
    links = [_with_surfaces(random, link) for link in robot.links]
    if random.random() < 0.5:
        links.append(Link("tool"))
        joints.append(Joint("mount", JointKind.FIXED, random.choice(links[:-1]).name, "tool", _pose(random, 0.1)))
    size = max(abs(float(x)) for joint in joints for x in joint.X_PC.position) or 0.1
    moving = [joint for joint in joints if joint.kind in SINGLE]
    sensors = [*robot.sensors]
    if moving and random.random() < 0.4:
        joint = random.choice(moving)
        sensors.append(
            Sensor("wrench", SensorKind.FORCE_TORQUE, joint.child, _pose(random, size), joint=joint.name, rate=200.0)
        )
    if random.random() < 0.3:
        rays = View(random.uniform(0.5, 6.0), random.randint(8, 360), 1, 0.05, 20.0)
        sensors.append(Sensor("scan", SensorKind.LIDAR, random.choice(links).name, _pose(random, size), view=rays))
    wide = replace(
        robot,
        links=tuple(links),
        joints=tuple(joints),
        actuators=tuple(one for one in robot.actuators if any(one.joint == j.name and not j.mimic for j in joints)),
        sensors=tuple(sensors),
    )
    solid = [link.name for link in links if link.collisions]
    apart = [
        (a, b)
        for a, b in combinations(sorted(solid), 2)
        if frozenset((a, b)) not in without_contacts(wide) and random.random() < 0.3
    ]
    wide = replace(wide, excluded_contacts=tuple(apart))
    if random.random() < 0.3:
        words = ("Unterarm äöü", "手首", "основание", "a.b-c", "0_first")

        def other(name: str) -> str:
            return f"{words[len(name) % len(words)]}_{name}"

        wide = renamed(wide, link=other, joint=other)
    return wide


def _with_followers(random: Random, joints: Sequence[Joint]) -> list[Joint]:
    """Hinges and slides with limits follow the first of their kind, within what their leader moves them."""
    made: list[Joint] = []
    leaders: dict[JointKind, Joint] = {}
    for joint in joints:
        leader = leaders.get(joint.kind)
        if joint.kind in (JointKind.REVOLUTE, JointKind.PRISMATIC) and joint.mimic is None:
            if leader is None:
                leaders[joint.kind] = joint
            elif random.random() < 0.5:
                times, offset = random.choice((-1.0, 0.5, random.uniform(0.1, 3.0))), random.choice((0.0, 0.2))
                ends = sorted(times * bound + offset for bound in (leader.limit.lower, leader.limit.upper))
                joint = replace(
                    joint,
                    mimic=Mimic(leader.name, times, offset),
                    dynamics=JointDynamics(),
                    limit=replace(joint.limit, lower=ends[0], upper=ends[1]),
                )
        made.append(joint)
    return made


def _started(random: Random, joints: Sequence[Joint]) -> list[Joint]:
    """The joints at an initial position, followers where their leader puts them."""
    at: dict[str, float] = {}
    for joint in (*(one for one in joints if one.mimic is None), *(one for one in joints if one.mimic is not None)):
        if joint.mimic is not None:
            at[joint.name] = joint.mimic.multiplier * at[joint.mimic.joint] + joint.mimic.offset
        elif joint.kind in SINGLE:
            low, high = max(joint.limit.lower, -1.0), min(joint.limit.upper, 1.0)
            at[joint.name] = random.choice((low, high, random.uniform(low, high), min(max(0.0, low), high)))
    return [replace(joint, drawn_position=at.get(joint.name, 0.0)) for joint in joints]


def _with_surfaces(random: Random, link: Link) -> Link:
    def some(greatest: float) -> float | None:
        return random.choice((None, random.uniform(0.01, greatest)))

    seen = (replace(one, rgba=(*(one.rgba or GREY)[:3], random.choice((1.0, 0.4)))) for one in link.visuals)
    touched = (replace(one, surface=Surface(some(1.5), some(0.01), some(0.01))) for one in link.collisions)
    return replace(link, visuals=tuple(seen), collisions=tuple(touched))
