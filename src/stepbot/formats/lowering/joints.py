"""Joints and loops rewritten to what a format supports.

Some formats have hinges with stops around 0, and limits of effort and velocity at motors alone.
"""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import cache
from math import inf, isfinite, isinf, pi

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, perpendicular_frame
from stepbot.robot.dynamics import free_mass_matrix
from stepbot.robot.kinematics import displacement, mimic_relation
from stepbot.robot.loop_followers import loop_followers
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Base, Joint, JointDynamics, JointKind, Limit, Link, LoopClosure, Mimic, Robot
from stepbot.robot.renaming import names_of

UNLIMITED = 1e9
"""Value for an unlimited quantity if a format requires a number [rad], [m], [rad/s], [m/s], [N m] or [N]."""

_PYBULLET_STEP = 1.0 / 240.0
"""Time step [s] of PyBullet unless a program sets another one."""
_MASSLESS = 1e-12
"""Share of the largest inertia of a motion below which another one is a rounding error."""
_SHARE = 0.1
"""Share of a motion from which a joint is named."""


def joints_where(condition: Callable[[Joint], bool]) -> Callable[[Robot], list[str]]:
    """Names of the joints that satisfy a condition."""
    return lambda robot: [f"'{joint.name}'" for joint in robot.joints if condition(joint)]


def each_joint(rewrite: Callable[[Joint], Joint]) -> Callable[[Robot], Robot]:
    """The robot with every joint rewritten."""
    return lambda robot: replace(robot, joints=tuple(rewrite(joint) for joint in robot.joints))


def is_open(joint: Joint) -> bool:
    """Whether a joint with position limits lacks one of them."""
    return joint.kind.bounded and (isinf(joint.limit.lower) or isinf(joint.limit.upper))


def bound(joint: Joint) -> Joint:
    """The joint with numbers in place of missing position limits; a revolute one without any is continuous."""
    lower, upper = joint.limit.lower, joint.limit.upper
    if joint.kind is JointKind.REVOLUTE and isinf(lower) and isinf(upper):
        return replace(joint, kind=JointKind.CONTINUOUS)
    return replace(joint, limit=replace(joint.limit, lower=max(lower, -UNLIMITED), upper=min(upper, UNLIMITED)))


def lacks_effort(joint: Joint) -> bool:
    """Whether a moving joint lacks an effort or velocity limit, which its format requires beside other limits."""
    missing = (isinf(joint.limit.effort), isinf(joint.limit.velocity))
    if joint.kind is JointKind.CONTINUOUS:
        return any(missing) and (joint.limit.is_smooth or not all(missing))
    return any(missing) and joint.kind.bounded


def bound_effort(joint: Joint) -> Joint:
    """The joint with numbers in place of missing effort and velocity limits."""
    limit = replace(
        joint.limit, effort=min(joint.limit.effort, UNLIMITED), velocity=min(joint.limit.velocity, UNLIMITED)
    )
    return replace(joint, limit=limit)


def is_loaded_ball(joint: Joint) -> bool:
    """Whether a ball joint has damping, friction or a spring."""
    return joint.kind is JointKind.BALL and without_armature(joint).dynamics != JointDynamics()


def without_armature(joint: Joint) -> Joint:
    """The joint without the inertia of its motor's rotor."""
    return replace(joint, dynamics=replace(joint.dynamics, armature=0.0))


def stiffly_damped(robot: Robot) -> list[str]:
    """The longest step in which explicit damping does not diverge, if PyBullet's is longer, and the joints that do."""
    step, shaken = shaken_by_damping(robot)
    return [f"in steps longer than {1e3 * step:.2g} ms", *(f"'{name}'" for name in shaken)] if shaken else []


def shaken_by_damping(robot: Robot) -> tuple[float, tuple[str, ...]]:
    """The longest step [s] in which explicit damping does not diverge, and the joints that diverge in PyBullet's.

    A motion that damping brakes by more than twice its inertia / step is reversed and enlarged in each step. Behind a
    gear, most of the inertia is armature, which PyBullet lacks: it does not count.
    """
    robot = replace(robot, joints=tuple(without_armature(joint) for joint in robot.joints))
    damping = {joint.name: joint.dynamics.damping for joint in robot.joints}
    if not any(damping.values()) or damped_softly(robot):
        return inf, ()
    names, M = free_mass_matrix(robot)
    root = np.sqrt([damping.get(name, 0.0) for name in names])
    moments, modes = np.linalg.eigh(M) if np.isfinite(M).all() else (np.zeros(1), M)
    with np.errstate(all="ignore"):
        braked = root[:, None] * (modes / moments @ modes.T) * root
    if moments[0] <= _MASSLESS * moments[-1] or not np.isfinite(braked).all():  # a massless link moves: it is reported
        return inf, ()
    rates, shapes = np.linalg.eigh(braked)
    fast = shapes[:, rates > 2.0 / _PYBULLET_STEP] ** 2
    shaken = (name for name, share in zip(names, fast, strict=True) if share.max(initial=0.0) > _SHARE)
    return 2.0 / float(rates[-1]), tuple(shaken)


def damped_softly(robot: Robot) -> bool:
    """Whether bounds of the inertias suffice to tell that no step diverges: a mass matrix of 1,000 joints takes 20 s.

    A joint's speed is the difference of its links' angular velocities w, of which v'Dv has at most 2 d w^2 each, and
    v'Mv has at least the smallest moment of inertia x w^2 of each rigid group of links.
    """
    fixed_to = {joint.child: joint.parent for joint in robot.joints if joint.kind is JointKind.FIXED}

    @cache
    def group(link: str) -> str:
        while link in fixed_to:
            link = fixed_to[link]
        return link

    torques, moments = defaultdict[str, float](float), defaultdict[str, float](float)
    for joint in robot.joints:
        if joint.dynamics.damping and joint.kind.slides:
            return False
        for link in (joint.parent, joint.child):
            torques[group(link)] += joint.dynamics.damping
    for one in robot.links:
        moments[group(one.name)] += float(np.linalg.eigvalsh(np.array(one.mass_properties.inertia))[0])
    moving = torques if robot.base is Base.FLOATING else torques.keys() - {group(robot.root.name)}
    return all(torques[one] <= moments[one] / _PYBULLET_STEP for one in moving)


def chained_mimics(robot: Robot) -> list[str]:
    """Joints that mimic a mimicking joint."""
    mimics = {joint.name: joint.mimic for joint in robot.joints if joint.mimic is not None}
    return [f"'{name}' after '{mimic.joint}'" for name, mimic in mimics.items() if mimic.joint in mimics]


def flatten_mimics(robot: Robot) -> Robot:
    """The robot with every mimic referring to the first joint of its chain."""

    def flat(joint: Joint) -> Joint:
        return replace(joint, mimic=Mimic(*mimic_relation(robot, joint.name))) if joint.mimic is not None else joint

    return each_joint(flat)(robot)


def mixed_mimics(robot: Robot) -> list[str]:
    """Joints that turn and mimic one that slides, or the other way round."""
    return [
        f"'{joint.name}' after '{joint.mimic.joint}'"
        for joint in robot.joints
        if joint.mimic and _is_mixed(robot, joint)
    ]


def without_mixed_mimics(robot: Robot) -> Robot:
    """The robot without mimics between angles and distances."""
    return each_joint(lambda joint: replace(joint, mimic=None) if _is_mixed(robot, joint) else joint)(robot)


def _is_mixed(robot: Robot, joint: Joint) -> bool:
    kinds = [] if joint.mimic is None else [joint.kind, robot.joint_by_name[joint.mimic.joint].kind]
    return len({kind is JointKind.PRISMATIC for kind in kinds}) > 1


def describe_closures(condition: Callable[[LoopClosure], bool]) -> Callable[[Robot], list[str]]:
    """The closures that satisfy a condition, with their links."""
    return lambda robot: [
        f"'{closure.name}' ({closure.kind}, '{closure.link_a}' to '{closure.link_b}')"
        for closure in robot.closures
        if condition(closure)
    ]


def describe_followers(robot: Robot) -> list[str]:
    """The joints that follow a driven one through a loop, with their lines and deviations."""
    lines = []
    for follower in loop_followers(robot):
        prismatic = robot.joint_by_name[follower.joint].kind is JointKind.PRISMATIC
        mimic, unit = follower.mimic, "m" if prismatic else "rad"
        line = f"{mimic.multiplier:g} x '{mimic.joint}'" + (f" {mimic.offset:+g}" if mimic.offset else "")
        deviation = max(round(follower.deviation, 9), 1e-9)
        lines.append(f"'{follower.joint}' = {line}, within {deviation:.2g} {unit}")
    return lines


def mimic_followers(robot: Robot) -> Robot:
    """The robot with a mimic in each joint that follows a driven one through a loop."""
    mimics = {follower.joint: follower.mimic for follower in loop_followers(robot)}
    return each_joint(lambda joint: replace(joint, mimic=mimics.get(joint.name, joint.mimic)))(robot)


def loop_zeros(robot: Robot) -> list[str]:
    """Joints of loops that are drawn at a position other than q = 0."""
    moved = joints_in_loops(robot)
    return [
        f"'{joint.name}' by {joint.drawn_position:.6g}"
        for joint in robot.joints
        if joint.name in moved and joint.drawn_position != 0.0
    ]


def with_moved_zeros(robot: Robot, in_loops: Collection[str]) -> Robot:
    """The robot with q = 0 at the drawn position for some joints; limits, springs and mimics are shifted."""
    shift = {joint.name: joint.drawn_position if joint.name in in_loops else 0.0 for joint in robot.joints}

    def moved(joint: Joint) -> Joint:
        by, mimic, passive = shift[joint.name], joint.mimic, joint.dynamics
        if mimic is not None:
            mimic = replace(mimic, offset=mimic.offset + mimic.multiplier * shift[mimic.joint] - by)
        if by == 0.0:
            return replace(joint, mimic=mimic)
        return replace(
            joint,
            X_PC=joint.X_PC @ displacement(joint, by),
            limit=replace(joint.limit, lower=joint.limit.lower - by, upper=joint.limit.upper - by),
            dynamics=replace(passive, spring_reference=passive.spring_reference - (by if passive.stiffness else 0.0)),
            mimic=mimic,
            drawn_position=0.0,
        )

    return each_joint(moved)(robot)


def joints_in_loops(robot: Robot) -> set[str]:
    """Joints on the path through the tree from one side of a closure to the other."""
    above = {joint.child: joint for joint in robot.joints}
    ways = ([{joint.name for joint in way_up(link, above)} for link in (c.link_a, c.link_b)] for c in robot.closures)
    # The common part of both paths to the root is above the loop.
    return {name for a, b in ways for name in a ^ b}


def way_up(link: str, above: Mapping[str, Joint]) -> Iterator[Joint]:
    """The joints from a link up to the root.

    Args:
        above: By their children.
    """
    while link in above:
        yield above[link]
        link = above[link].parent


def closure_points(closure: LoopClosure) -> list[Array]:
    """Points of F [m] that represent a closure by what constrains points: one, two of an axis, three of a body.

    They are as far from F as F is from the frames of the links, so that all constraints weigh the same.
    """
    reach = max(float(np.linalg.norm(X.p)) for X in (closure.X_AF, closure.X_BF)) or 0.1
    if closure.kind is JointKind.BALL:
        return [np.zeros(3)]
    if closure.kind is JointKind.FIXED:
        x, y, _ = perpendicular_frame(closure.axis).T
        return [np.zeros(3), reach * x, reach * y]
    return [np.zeros(3), reach * np.array(closure.axis)]


def frames_as_links(robot: Robot) -> Robot:
    """The robot with a massless link on a fixed joint for every frame."""
    taken = set(names_of(robot, "joints", "closures"))
    joints = tuple(
        Joint(
            free_name(f"{frame.name}_mount", "_joint", taken),
            JointKind.FIXED,
            frame.link,
            frame.name,
            frame.X_LF,
            limit=Limit(-inf, inf),
        )
        for frame in robot.frames
    )
    links = tuple(Link(frame.name) for frame in robot.frames)
    return replace(robot, links=robot.links + links, joints=robot.joints + joints, frames=())


def has_stops(joint: Joint) -> bool:
    """Whether a joint has limits that stops can represent: those of a hinge include 0 and lie within ±180°."""
    lower, upper = joint.limit.lower, joint.limit.upper
    if not joint.kind.bounded or (isinf(lower) and isinf(upper)):
        return False
    return joint.kind is JointKind.PRISMATIC or -pi <= lower <= 0.0 <= upper <= pi


def without_far_limits(robot: Robot) -> Robot:
    """The robot without limits that stops cannot represent, except where a motor has them."""
    driven = _driven(robot)

    def freed(joint: Joint) -> Joint:
        free = replace(joint, limit=replace(joint.limit, lower=-inf, upper=inf))
        return free if is_far(joint) and joint.name not in driven else joint

    return each_joint(freed)(robot)


def passive_limits(robot: Robot) -> list[str]:
    """Joints without a motor that have an effort or a velocity limit."""
    return [f"'{joint.name}'" for joint in robot.joints if _is_passive(joint, _driven(robot))]


def without_passive_limits(robot: Robot) -> Robot:
    """The robot without these limits."""
    driven = _driven(robot)

    def freed(joint: Joint) -> Joint:
        unlimited = replace(joint.limit, effort=inf, velocity=inf)
        return replace(joint, limit=unlimited) if _is_passive(joint, driven) else joint

    return each_joint(freed)(robot)


def is_far(joint: Joint) -> bool:
    """Whether a hinge has limits that stops cannot represent."""
    bounded = not (isinf(joint.limit.lower) and isinf(joint.limit.upper))
    return joint.kind is JointKind.REVOLUTE and bounded and not has_stops(joint)


def _is_passive(joint: Joint, driven: set[str]) -> bool:
    limited = isfinite(joint.limit.effort) or isfinite(joint.limit.velocity)
    return joint.kind is not JointKind.FIXED and limited and joint.name not in driven


def _driven(robot: Robot) -> set[str]:
    driven = {actuator.joint for actuator in robot.actuators}
    followers = {joint.name: joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    while more := {name for name, leader in followers.items() if leader in driven} - driven:
        driven |= more
    return driven
