"""Cuts loops at another joint: a prismatic closure becomes a joint of the tree, a revolute joint the closure.

Cutting a loop at any of its joints gives the same mechanism. The links below the new cut become children of the other
side of the old one, so the joints in between are reversed, and the links on the path get the frames of the joints that
are now above them.
"""

from collections.abc import Mapping
from math import inf

from msgspec.structs import replace

from stepbot.geometry.inertia import without_residue
from stepbot.geometry.spatial import Pose, Vector3, tidy
from stepbot.robot.model import Collision, Joint, JointDynamics, JointKind, Limit, Link, LoopClosure, Robot, Visual
from stepbot.robot.sensors import PLACED, SensorKind

from .joints import way_up

_CLOSES_AS = {
    JointKind.REVOLUTE: JointKind.REVOLUTE,
    JointKind.CONTINUOUS: JointKind.REVOLUTE,
    JointKind.BALL: JointKind.BALL,
    JointKind.FIXED: JointKind.FIXED,
}
"""Types of joints at which a loop can be cut, and the closures that they become."""


def sliding_closures(robot: Robot) -> list[str]:
    """Prismatic closures, and the joint at which their loop can be cut instead, if there is one."""
    names = []
    for closure in robot.closures:
        if closure.kind is JointKind.PRISMATIC:
            way = _way_to_cut(robot, closure)
            limits = ", without its limits of effort and velocity" if way and way[-1].limit != Limit() else ""
            names.append(f"'{closure.name}'" + (f" at '{way[-1].name}'{limits}" if way else ""))
    return names


def reroot_loops(robot: Robot) -> Robot:
    """The robot with every prismatic closure replaced by a cut at a joint without stops, forces or actuator.

    Loops without such a joint are unchanged.
    """
    for closure in robot.closures:
        way = _way_to_cut(robot, closure) if closure.kind is JointKind.PRISMATIC else ()
        if way:
            robot = _reroot(robot, closure, way)
    return robot


def _way_to_cut(robot: Robot, closure: LoopClosure) -> tuple[Joint, ...]:
    """The joints from one side of a closure up to the nearest one at which the loop can be cut; empty without one."""
    above = {joint.child: joint for joint in robot.joints}
    # A reversed joint would report the opposite force.
    weighed = {sensor.joint for sensor in robot.sensors if sensor.kind is SensorKind.FORCE_TORQUE}
    up_a, up_b = (list(way_up(link, above)) for link in (closure.link_a, closure.link_b))
    shared = {joint.name for joint in up_a} & {joint.name for joint in up_b}
    ways = []
    for joints in ([joint for joint in up if joint.name not in shared] for up in (up_b, up_a)):
        ends = [i for i, joint in enumerate(joints) if _can_close(robot, joint)]
        plain = [i for i in ends if joints[i].limit == Limit()]
        way = tuple(joints[: (plain or ends)[0] + 1]) if ends else ()
        if way and not any(joint.name in weighed for joint in way):
            ways.append(way)
    return min(ways, key=lambda way: (way[-1].limit != Limit(), len(way)), default=())


def _can_close(robot: Robot, joint: Joint) -> bool:
    """Whether a closure can represent what a joint does: limits of effort and velocity bound its motor alone."""
    involved = {actuator.joint for actuator in robot.actuators}
    involved |= {sensor.joint for sensor in robot.sensors}
    involved |= {other.mimic.joint for other in robot.joints if other.mimic is not None}
    unlimited = replace(joint.limit, effort=inf, velocity=inf) == Limit()
    plain = unlimited and joint.dynamics == JointDynamics() and joint.mimic is None
    return joint.kind in _CLOSES_AS and plain and joint.name not in involved


def _reroot(robot: Robot, closure: LoopClosure, way: tuple[Joint, ...]) -> Robot:
    """Cut at the last joint of the path instead of at the closure; the other joints are reversed."""
    from_b = way[0].child == closure.link_b
    holder, X_PF = (closure.link_a, closure.X_AF) if from_b else (closure.link_b, closure.X_BF)
    X_LN = {way[0].child: closure.X_BF if from_b else closure.X_AF}  # new frames of the links on the path
    X_LN |= {joint.parent: joint.X_PC for joint in way[:-1]}
    axis = closure.axis if from_b else _opposite(closure.axis)
    slide = Joint(closure.name, closure.kind, holder, way[0].child, X_PF, axis)
    turned = {joint.name: _turned(joint, X_LN) for joint in way[:-1]}
    cut = way[-1]
    pin = LoopClosure(
        cut.name, _CLOSES_AS[cut.kind], cut.parent, cut.X_PC, cut.child, X_LN[cut.child].inverse(), cut.axis
    )
    kept = (joint for joint in robot.joints if joint.name != cut.name)
    joints = [turned.get(one.name) or replace(one, X_PC=_moved(one.parent, one.X_PC, X_LN)) for one in kept]
    closures = [pin if one.name == closure.name else _moved_closure(one, X_LN) for one in robot.closures]
    links = [_moved_link(link, X_LN[link.name].inverse()) if link.name in X_LN else link for link in robot.links]
    frames = [replace(f, X_LF=_moved(f.link, f.X_LF, X_LN)) for f in robot.frames]
    turned_child = {joint.name: joint.child for joint in turned.values()}
    sensors = []
    for sensor in robot.sensors:
        X_LS = _moved(sensor.link, sensor.X_LS, X_LN) if sensor.kind in PLACED else sensor.X_LS
        sensors.append(replace(sensor, link=turned_child.get(sensor.joint, sensor.link), X_LS=X_LS))
    rebuilt = replace(robot, closures=tuple(closures), frames=tuple(frames), sensors=tuple(sensors))
    return _in_tree_order(rebuilt, links, [*joints, slide])


def _turned(joint: Joint, X_LN: Mapping[str, Pose]) -> Joint:
    """The joint with parent and child exchanged: its frame stays in place, and a positive q moves the same way."""
    turned = replace(joint, parent=joint.child, child=joint.parent, X_PC=X_LN[joint.child].inverse())
    if joint.kind is JointKind.UNIVERSAL:
        return replace(turned, axis=_opposite(joint.axis2), axis2=_opposite(joint.axis))
    return replace(turned, axis=_opposite(joint.axis))


def _opposite(axis: Vector3) -> Vector3:
    x, y, z = axis
    return (-x, -y, -z)


def _moved(link: str, X_LF: Pose, X_LN: Mapping[str, Pose]) -> Pose:
    """A pose on a link, in the link's new frame."""
    return tidy(X_LN[link].inverse() @ X_LF) if link in X_LN else X_LF


def _moved_closure(closure: LoopClosure, X_LN: Mapping[str, Pose]) -> LoopClosure:
    X_AF, X_BF = _moved(closure.link_a, closure.X_AF, X_LN), _moved(closure.link_b, closure.X_BF, X_LN)
    return replace(closure, X_AF=X_AF, X_BF=X_BF)


def _moved_link(link: Link, X_NL: Pose) -> Link:
    visuals: tuple[Visual, ...] = tuple(replace(shape, X_LG=tidy(X_NL @ shape.X_LG)) for shape in link.visuals)
    collisions: tuple[Collision, ...] = tuple(replace(shape, X_LG=tidy(X_NL @ shape.X_LG)) for shape in link.collisions)
    moved = without_residue(link.mass_properties.moved(X_NL))
    return replace(link, mass_properties=moved, visuals=visuals, collisions=collisions)


def _in_tree_order(robot: Robot, links: list[Link], joints: list[Joint]) -> Robot:
    """The robot with parents before their children; the order of siblings is kept."""
    link_of = {link.name: link for link in links}
    ordered: list[Joint] = []
    waiting = [joint for joint in reversed(joints) if joint.parent == robot.root.name]
    while waiting:
        joint = waiting.pop()
        ordered.append(joint)
        waiting += [below for below in reversed(joints) if below.parent == joint.child]
    tree = (robot.root.name, *(joint.child for joint in ordered))
    return replace(robot, links=tuple(link_of[name] for name in tree), joints=tuple(ordered))
