"""Multi-dof joints as chains of joints of one degree of freedom each, with massless links in between.

The joints of a chain are named like the coordinates of the joint that it represents, so that a configuration is the
same whether a format supports the joint or not.

| kind | chain, from the parent on |
| --- | --- |
| ball | ``_yaw`` about z, ``_pitch`` about y, ``_roll`` about x: fixed-axis roll, pitch, yaw |
| universal | ``_1`` about the axis, ``_2`` about the second one |
| cylindrical | ``_slide`` and ``_turn``, along and about the axis |
| planar | ``_x`` and ``_y`` in the plane, ``_turn`` about its normal |
| floating | ``_x``, ``_y``, ``_z``, then the ball ``_turn`` |
| screw | ``_slide``, which follows the turning joint of the screw's own name |
"""

from collections.abc import Callable, Mapping
from math import isinf

from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, Vector3, perpendicular_frame, vector3

from .mesh_names import free_name
from .model import Joint, JointKind, Limit, Link, Mimic, Robot
from .renaming import names_of
from .sensors import Sensor, SensorKind

Steps = Mapping[str, Joint]
"""For each joint of the chain, from the parent on, the suffix of its name and its own fields."""


def split(robot: Robot, *kinds: JointKind) -> Robot:
    """The robot with a chain in place of every joint of some kinds, one kind after the other.

    All frames of a chain coincide at q = 0: the first joint is placed where the joint was, the others in that frame.
    A joint sensor becomes one per independent joint of the chain; a force-torque sensor moves to the last joint, which
    has the same child. The links between have neither mass nor shape, and are in the modules that have both the joint's
    links.
    """
    for kind in kinds:
        if any(joint.kind is kind for joint in robot.joints):
            robot = _split(robot, kind)
    return robot


def _split(robot: Robot, kind: JointKind) -> Robot:
    taken = set(names_of(robot, "links", "joints", "closures", "frames"))
    joints: list[Joint] = []
    links = [robot.root]
    chains: dict[str, list[Joint]] = {}
    modules = {module: list(module.links) for module in robot.modules}
    for joint in robot.joints:
        chain = _chain(joint, _STEPS[kind](joint), taken) if joint.kind is kind else [joint]
        chains[joint.name] = chain
        joints += chain
        between = [step.child for step in chain[:-1]]
        links += [*map(Link, between), robot.link_by_name[joint.child]]
        for module, members in modules.items() if between else ():
            members += between if {joint.parent, joint.child} <= set(module.links) else ()
    sensors = tuple(part for sensor in robot.sensors for part in _sensors(sensor, chains.get(sensor.joint, [])))
    with_links = tuple(replace(module, links=tuple(members)) for module, members in modules.items())
    return replace(robot, links=tuple(links), joints=tuple(joints), sensors=sensors, modules=with_links)


def _sensors(sensor: Sensor, chain: list[Joint]) -> list[Sensor]:
    """The sensors of a chain in place of a sensor on the joint that it represents."""
    if len(chain) < 2:
        return [sensor]
    if sensor.kind is not SensorKind.JOINT:
        return [replace(sensor, joint=chain[-1].name)]
    free = [step for step in chain if step.mimic is None]
    if len(free) == 1:
        return [replace(sensor, joint=free[0].name, link=free[0].child)]
    stem = sensor.joint
    return [
        replace(sensor, name=f"{sensor.name}{step.name.removeprefix(stem)}", joint=step.name, link=step.child)
        for step in free
    ]


def turn(joint: Joint, axis: Vector3) -> Joint:
    """A continuous joint with the velocity, effort and passive forces of the joint that it is part of."""
    limit = Limit(velocity=joint.limit.velocity, effort=joint.limit.effort)
    return replace(joint, kind=JointKind.CONTINUOUS, axis=axis, limit=limit)


def slide(joint: Joint, axis: Vector3) -> Joint:
    """A prismatic joint without limits and forces."""
    return Joint(joint.name, JointKind.PRISMATIC, joint.parent, joint.child, axis=axis)


def _chain(joint: Joint, steps: Steps, taken: set[str]) -> list[Joint]:
    names = [free_name(f"{joint.name}{suffix}", "_joint", taken) if suffix else joint.name for suffix in steps]
    between = [free_name(f"{name}_link", "_link", taken) for name in names[:-1]]
    parents, children = [joint.parent, *between], [*between, joint.child]
    poses = [joint.X_PC, *(Pose() for _ in between)]
    return [
        replace(step, name=name, parent=parent, child=child, X_PC=X_PC)
        for step, name, parent, child, X_PC in zip(steps.values(), names, parents, children, poses, strict=True)
    ]


def _planar_steps(joint: Joint) -> Steps:
    x, y, _ = perpendicular_frame(joint.axis).T
    return {"_x": slide(joint, vector3(x)), "_y": slide(joint, vector3(y)), "_turn": turn(joint, joint.axis)}


def _screw_steps(joint: Joint) -> Steps:
    # Without a pitch nothing advances, however far it turns.
    lower, upper = sorted(joint.pitch * end if joint.pitch else 0.0 for end in (joint.limit.lower, joint.limit.upper))
    endless = isinf(joint.limit.lower) and isinf(joint.limit.upper)
    advance = replace(
        slide(joint, joint.axis),
        limit=Limit(lower, upper),
        mimic=Mimic(joint.name, joint.pitch),
        drawn_position=joint.pitch * joint.drawn_position,
    )
    turned = replace(joint, kind=JointKind.CONTINUOUS if endless else JointKind.REVOLUTE, pitch=0.0)
    return {"_slide": advance, "": turned}


_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_STEPS: Mapping[JointKind, Callable[[Joint], Steps]] = {
    JointKind.BALL: lambda joint: {"_yaw": turn(joint, _Z), "_pitch": turn(joint, _Y), "_roll": turn(joint, _X)},
    JointKind.UNIVERSAL: lambda joint: {"_1": turn(joint, joint.axis), "_2": turn(joint, joint.axis2)},
    JointKind.CYLINDRICAL: lambda joint: {"_slide": slide(joint, joint.axis), "_turn": turn(joint, joint.axis)},
    JointKind.PLANAR: _planar_steps,
    JointKind.FLOATING: lambda joint: {
        "_x": slide(joint, _X),
        "_y": slide(joint, _Y),
        "_z": slide(joint, _Z),
        "_turn": replace(joint, kind=JointKind.BALL),
    },
    JointKind.SCREW: _screw_steps,
}


_SEVERAL = (JointKind.UNIVERSAL, JointKind.CYLINDRICAL, JointKind.PLANAR, JointKind.FLOATING)
"""Kinds of several degrees of freedom but the ball, in the order in which they are split."""


def unfolded(robot: Robot) -> Robot:
    """The robot with joints of at most one degree of freedom: fixed, revolute, continuous, prismatic and screw."""
    if not any(joint.kind.coordinates > 1 for joint in robot.joints):
        return robot
    return split(robot, *_SEVERAL, JointKind.BALL)


def ball_coordinates(robot: Robot) -> dict[str, tuple[str, str, str]]:
    """For each ball joint, including those of floating joints, the names of its coordinates: yaw, pitch, roll."""
    folded = split(robot, JointKind.FLOATING)
    unfolded_balls = split(folded, JointKind.BALL)
    names = iter(joint.name for joint in unfolded_balls.joints if joint.name not in folded.joint_by_name)
    balls = [joint.name for joint in folded.joints if joint.kind is JointKind.BALL]
    return {ball: (next(names), next(names), next(names)) for ball in balls}


def universal_coordinates(robot: Robot) -> dict[str, tuple[str, str]]:
    """For each universal joint, the names of its coordinates: about the first axis, about the second."""
    turning = split(robot, JointKind.UNIVERSAL)
    names = iter(joint.name for joint in turning.joints if joint.name not in robot.joint_by_name)
    return {joint.name: (next(names), next(names)) for joint in robot.joints if joint.kind is JointKind.UNIVERSAL}


def steps_by_child(robot: Robot) -> dict[str, tuple[Joint, ...]]:
    """For each link but the root, the joints between it and its parent: joints of one degree of freedom, or balls.

    The prismatic joint of a screw has no limits of its own: the screw's revolute joint has them.
    """
    screws = {joint.name for joint in robot.joints if joint.kind is JointKind.SCREW}
    steps: dict[str, tuple[Joint, ...]] = {}
    chain: list[Joint] = []
    for joint in split(robot, *_SEVERAL, JointKind.SCREW).joints:
        follows = joint.name not in robot.joint_by_name and joint.mimic is not None and joint.mimic.joint in screws
        chain.append(replace(joint, limit=Limit()) if follows else joint)
        if joint.child in robot.link_by_name:
            steps[joint.child] = tuple(chain)
            chain = []
    return steps
