"""What a robot can do, found in its model: motors, wheels, limbs, and links that may be fingers or jaws."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations
from math import inf, pi
from typing import Any

import numpy as np
from msgspec import Struct

from stepbot.engines.simulation import Mechanism, Motor
from stepbot.formats.lowering.joints import shaken_by_damping
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.gains import actuator_limit
from stepbot.robot.kinematics import link_poses, mimic_relation, rigid_bodies
from stepbot.robot.model import ActuatorKind, Base, Joint, JointKind, Robot
from stepbot.robot.multi_dof import ball_coordinates, unfolded
from stepbot.robot.posing import NotReached, posed
from stepbot.robot.tuning import BANDWIDTH

_LEVEL = 0.1
"""Cosine of the angle between an axle and the vertical up to which the axle counts as horizontal."""
_NUDGE = 0.01
"""Motion [rad] or [m] of a motor by which the joints that it moves are found."""
_STILL = 1e-5
"""Motion [rad] or [m] of a joint that does not move with it."""
_IN_LINE = 0.02
"""Distance of axles along the base, relative to that of the wheels from its middle, up to which they are in line."""
_FEWEST_LIMBS = 2
_FEWEST_ROLLERS = 3


class Wheel(Struct, frozen=True):
    """A driven wheel."""

    motor: str
    link: str
    forwards: float
    """1 if a positive speed drives forwards, else -1."""


class Wheels(Struct, frozen=True):
    """The driven wheels of a base."""

    wheels: tuple[Wheel, ...]
    direction: tuple[float, float, float]
    """Direction of driving forwards, in the root link."""
    rollers: tuple[tuple[str, ...], ...] = ()
    """Joints of the rollers of each wheel, if all wheels have some: mecanum wheels, which can drive sideways."""
    turns: bool = False
    """Whether they turn the base on the spot without slipping: by rollers, or on one axle line."""
    apart: float = 0.0
    """Largest distance [m] of two axles along the direction."""
    dragged: frozenset[str] = frozenset()
    """Links that roll on axles fixed to the base that do not point at the middle of the driven wheels: they slip
    sideways when the base turns on the spot."""


class Fingers(Struct, frozen=True):
    """Two groups of links that motors move relative to each other."""

    motors: tuple[str, ...]
    """All move by the same amount."""
    one: frozenset[str]
    """Links rigidly connected to each other."""
    other: frozenset[str]
    hand: str
    """The link that the fingers move on."""
    fixed: bool = False
    """Whether the other group is the hand itself: ``one`` is a single jaw."""


def mechanism_of(robot: Robot, constraints: tuple[Mapping[str, Any], ...]) -> Mechanism:
    """A robot as simulations need it.

    Args:
        constraints: The list ``robot.pybullet`` of ``report.json``.
    """
    motors = tuple(
        Motor(
            actuator.name,
            actuator.joint,
            actuator.kind,
            actuator.kp,
            actuator.kv,
            actuator.gear,
            actuator_limit(actuator, robot.joint_by_name[actuator.joint]),
            robot.joint_by_name[actuator.joint].kind is not JointKind.PRISMATIC,
            actuator.tuning is not None and actuator.tuning.bandwidth >= BANDWIDTH,
            actuator.tuning is not None and actuator.tuning.braked,
        )
        for actuator in robot.actuators
        if actuator.joint in robot.joint_by_name
    )
    mimics = {joint.name: joint.mimic for joint in unfolded(robot).joints if joint.mimic is not None}
    stiff = frozenset(shaken_by_damping(robot)[1])
    return Mechanism(robot, motors, posed(robot, {}), ball_coordinates(robot), mimics, constraints, stiff)


def wheels_of(mechanism: Mechanism) -> Wheels | None:
    """The driven wheels: motors on continuous joints with horizontal axles, under a floating base; None without."""
    robot = mechanism.robot
    if robot.base is not Base.FLOATING:
        return None
    poses = link_poses(robot, mechanism.home)
    driven: list[tuple[Motor, str, Array]] = []
    for motor in mechanism.motors:
        joint = robot.joint_by_name[motor.joint]
        axis = poses[joint.child].turn(joint.axis)
        if joint.kind is JointKind.CONTINUOUS and motor.kind is ActuatorKind.VELOCITY and abs(axis[2]) < _LEVEL:
            driven.append((motor, joint.child, np.cross(axis, (0.0, 0.0, 1.0))))
    if not driven:
        return None
    ahead = driven[0][2] / np.linalg.norm(driven[0][2])
    ahead = ahead if ahead @ (1.0, 1e-3, 0.0) > 0.0 else -ahead
    wheels = tuple(Wheel(motor.name, link, float(np.sign(way @ ahead))) for motor, link, way in driven)
    rollers = tuple(_rollers(robot, wheel.link) for wheel in wheels)
    all_have = all(len(names) >= _FEWEST_ROLLERS for names in rollers)
    places = np.array([poses[link].p for _, link, _ in driven])
    middle = places.mean(axis=0)
    places -= middle
    width = float(np.abs(places @ np.cross((0.0, 0.0, 1.0), ahead)).max())
    in_line = float(np.abs(places @ ahead).max()) < _IN_LINE * width
    direction = (float(ahead[0]), float(ahead[1]), float(ahead[2]))
    dragged = frozenset(_dragged(robot, poses, middle, _IN_LINE * width))
    turns = width > 0.0 and (all_have or in_line)
    return Wheels(wheels, direction, rollers if all_have else (), turns, float(np.ptp(places @ ahead)), dragged)


def _dragged(robot: Robot, poses: Mapping[str, Pose], middle: Array, near: float) -> Iterator[str]:
    """Links that turn without a motor on horizontal axles of the base that pass a point (3,) [m] at a distance."""
    driven, body = {actuator.joint for actuator in robot.actuators}, rigid_bodies(robot.root.name, robot.joints)
    for joint in robot.joints:
        X = poses[joint.child]
        axle = X.turn(joint.axis)
        is_free = joint.kind is JointKind.CONTINUOUS and joint.name not in driven
        is_level = body[joint.parent] == body[robot.root.name] and abs(axle[2]) < _LEVEL
        if is_free and is_level and abs(float(np.cross(axle, middle - X.p)[2])) > near:
            yield joint.child


def _rollers(robot: Robot, wheel: str) -> tuple[str, ...]:
    """Continuous joints without a motor on a wheel."""
    driven = {actuator.joint for actuator in robot.actuators}
    return tuple(
        joint.name
        for joint in robot.joints
        if joint.parent == wheel and joint.kind is JointKind.CONTINUOUS and joint.name not in driven
    )


def limbs_of(mechanism: Mechanism) -> tuple[str, ...]:
    """The first links of limbs: branches of a floating base that two or more motors move."""
    robot = mechanism.robot
    if robot.base is not Base.FLOATING:
        return ()
    driven = {motor.joint for motor in mechanism.motors if motor.kind is ActuatorKind.POSITION}
    count: dict[str, int] = {}
    branch: dict[str, str] = {}
    for joint in robot.joints:
        if joint.parent == robot.root.name:
            branch[joint.child] = joint.child
        else:
            branch[joint.child] = branch[joint.parent]
        count[branch[joint.child]] = count.get(branch[joint.child], 0) + (joint.name in driven)
    limbs = tuple(first for first, motors in count.items() if motors >= 2)
    return limbs if len(limbs) >= _FEWEST_LIMBS else ()


def finger_candidates(mechanism: Mechanism) -> tuple[Fingers, ...]:
    """Pairs of links that may be fingers: both at the end of the tree, moved in opposite ways on one hand.

    Either one motor moves both, by a mimic, or two motors with equal limits on the same hand move one each; or a motor
    without such a pair moves both through closed loops, as a crank two jaws on one guide.
    """
    robot = mechanism.robot
    rigid = rigid_bodies(robot.root.name, robot.joints)
    tips = _tips(robot, rigid)
    drivers = [motor for motor in mechanism.motors if motor.kind is ActuatorKind.POSITION]
    candidates: dict[Fingers, None] = {}
    for motor in drivers:
        hand = robot.joint_by_name[motor.joint].parent
        moved = [joint for joint in robot.joints if joint.kind.is_pair]
        followers = [
            j for j in moved if mimic_relation(robot, j.name)[0] == motor.joint and rigid[j.parent] == rigid[hand]
        ]
        for one, other in combinations(followers, 2):
            candidates.update(dict.fromkeys(_pairs((motor.name,), one, other, tips, rigid, hand)))
    for first, second in combinations(drivers, 2):
        one, other = (robot.joint_by_name[motor.joint] for motor in (first, second))
        alike = one.kind is other.kind and one.parent == other.parent and first.limit == second.limit
        bounded = np.isfinite([first.limit.lower, first.limit.upper]).all()
        if alike and bounded and _is_tip(one.child, tips, rigid) and _is_tip(other.child, tips, rigid):
            names = (first.name, second.name)
            candidates.update(dict.fromkeys(_pairs(names, one, other, tips, rigid, one.parent)))
    paired = {name for fingers in candidates for name in fingers.motors}
    for motor in drivers if robot.closures else ():
        if motor.name not in paired:
            candidates.update(dict.fromkeys(_looped_pairs(mechanism, motor, rigid)))
    return tuple(candidates)


def _looped_pairs(mechanism: Mechanism, motor: Motor, rigid: Mapping[str, str]) -> Iterator[Fingers]:
    """Pairs of links without a motor on one hand that a motor moves through closed loops.

    What follows in the tree is a rod of the linkage, not the end of a finger.
    """
    robot, home = mechanism.robot, mechanism.home
    driven = {one.joint for one in mechanism.motors}
    after = _nudged(mechanism, motor)
    passive = [joint for joint in robot.joints if joint.name not in driven and joint.mimic is None]
    moved = [j for j in passive if abs(after.get(j.name, 0.0) - home.get(j.name, 0.0)) > _STILL and j.name in after]
    for one, other in combinations(moved, 2):
        if one.kind is other.kind and rigid[one.parent] == rigid[other.parent]:
            jaw, opposite = (_together(rigid, rigid[joint.child]) for joint in (one, other))
            yield Fingers((motor.name,), jaw, opposite, one.parent)


def _nudged(mechanism: Mechanism, motor: Motor) -> dict[str, float]:
    """The configuration after a small motion of a motor, in a direction that the loops allow; empty without."""
    start = mechanism.home[motor.joint]
    for way in (_NUDGE, -_NUDGE):
        if not motor.limit.lower <= start + way <= motor.limit.upper:
            continue
        try:
            return posed(mechanism.robot, {motor.joint: start + way})
        except NotReached:
            continue
    return {}


def jaw_candidates(mechanism: Mechanism, pairs: Iterable[Fingers]) -> tuple[Fingers, ...]:
    """Links that may be single jaws: at the end of the tree, moved on the link that carries them by a motor of no pair.

    A jaw turns by at most half a turn: farther, and it would come out on the other side of its hand. Links of closed
    loops are parts of a mechanism, no jaws.

    Args:
        pairs: The pairs of links that may be fingers.
    """
    robot = mechanism.robot
    rigid = rigid_bodies(robot.root.name, robot.joints)
    tips = _tips(robot, rigid)
    paired = {motor for pair in pairs for motor in pair.motors}
    looped = {rigid[link] for closure in robot.closures for link in (closure.link_a, closure.link_b)}
    candidates: dict[Fingers, None] = {}
    for motor in mechanism.motors:
        joint = robot.joint_by_name[motor.joint]
        bounded = motor.limit.upper - motor.limit.lower <= (pi if motor.angular else inf)
        alone = motor.kind is ActuatorKind.POSITION and motor.name not in paired and rigid[joint.child] not in looped
        if alone and bounded and _is_tip(joint.child, tips, rigid):
            jaw, hand = (_together(rigid, rigid[link]) for link in (joint.child, joint.parent))
            candidates[Fingers((motor.name,), jaw, hand, joint.parent, fixed=True)] = None
    return tuple(candidates)


def _together(rigid: Mapping[str, str], name: str) -> frozenset[str]:
    """The links of a rigid body."""
    return frozenset(link for link, body in rigid.items() if body == name)


def _is_tip(link: str, tips: Mapping[str, frozenset[str]], rigid: Mapping[str, str]) -> bool:
    """Whether nothing moves below a link."""
    return tips[link] == {link} or all(rigid[tip] == rigid[link] for tip in tips[link])


def _pairs(
    motors: tuple[str, ...],
    one: Joint,
    other: Joint,
    tips: Mapping[str, frozenset[str]],
    rigid: Mapping[str, str],
    hand: str,
) -> Iterator[Fingers]:
    groups = [sorted({rigid[tip] for tip in tips[joint.child]}) for joint in (one, other)]
    for a in groups[0]:
        for b in groups[1]:
            yield Fingers(motors, _together(rigid, a), _together(rigid, b), hand)


def _tips(robot: Robot, rigid: Mapping[str, str]) -> dict[str, frozenset[str]]:
    """For each link the links at the end of the tree below it, itself included."""
    below: dict[str, frozenset[str]] = {}
    for link in reversed(robot.links):
        children = [joint.child for joint in robot.joints if joint.parent == link.name]
        moving = [child for child in children if rigid[child] != rigid[link.name]]
        fixed = [child for child in children if rigid[child] == rigid[link.name]]
        ends = frozenset(tip for child in moving for tip in below[child])
        beyond = frozenset(tip for child in fixed for tip in below[child])
        own = frozenset() if ends or any(rigid[tip] != rigid[link.name] for tip in beyond) else frozenset({link.name})
        below[link.name] = ends | frozenset(tip for tip in beyond if rigid[tip] != rigid[link.name]) | own
    return below
