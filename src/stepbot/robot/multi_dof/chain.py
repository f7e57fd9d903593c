"""Replaces joints by chains of joints, common to all multi-dof kinds."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import isinf

from stepbot.geometry.spatial import Pose, Vector3, perpendicular_frame, vector3

from ..mesh_names import free_name
from ..model import Joint, JointKind, Limit, Link, Mimic, Robot
from ..sensors import Sensor, SensorKind

Steps = Mapping[str, Joint]
"""For each joint of the chain, from the parent on, the suffix of its name and its own fields."""


def chained(robot: Robot, kind: JointKind, steps_of: Callable[[Joint], Steps]) -> Robot:
    """The robot with a chain in place of every joint of a kind; the links between have neither mass nor shape.

    All frames of a chain coincide at q = 0: the first joint is placed where the joint was, the others in that frame.
    A joint sensor becomes one per independent joint of the chain; a force-torque sensor moves to the last joint, which
    has the same child.
    """
    if not any(joint.kind is kind for joint in robot.joints):
        return robot
    taken = {*robot.link_by_name, *robot.joint_by_name}
    taken |= {closure.name for closure in robot.closures} | {frame.name for frame in robot.frames}
    joints: list[Joint] = []
    links = [robot.root]
    chains: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        chain = _chain(joint, steps_of(joint), taken) if joint.kind is kind else [joint]
        chains[joint.name] = chain
        joints += chain
        links += [Link(step.child) for step in chain[:-1]]
        links.append(robot.link_by_name[joint.child])
    sensors = tuple(part for sensor in robot.sensors for part in _sensors(sensor, chains.get(sensor.joint, [])))
    return replace(robot, links=tuple(links), joints=tuple(joints), sensors=sensors)


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


def cylindrical_to_two(robot: Robot) -> Robot:
    """The robot with a prismatic and a revolute joint in place of every cylindrical joint."""
    return chained(robot, JointKind.CYLINDRICAL, _cylindrical_steps)


def _cylindrical_steps(joint: Joint) -> Steps:
    return {"_slide": slide(joint, joint.axis), "_turn": turn(joint, joint.axis)}


def ball_to_revolutes(robot: Robot) -> Robot:
    """The robot with three revolute joints in place of every ball joint."""
    return chained(robot, JointKind.BALL, _ball_steps)


def _ball_steps(joint: Joint) -> Steps:
    return {
        "_yaw": turn(joint, (0.0, 0.0, 1.0)),
        "_pitch": turn(joint, (0.0, 1.0, 0.0)),
        "_roll": turn(joint, (1.0, 0.0, 0.0)),
    }


def floating_to_slides_and_ball(robot: Robot) -> Robot:
    """The robot with three prismatic joints and a ball joint in place of every floating joint."""
    return chained(robot, JointKind.FLOATING, _floating_steps)


def _floating_steps(joint: Joint) -> Steps:
    return {
        "_x": slide(joint, (1.0, 0.0, 0.0)),
        "_y": slide(joint, (0.0, 1.0, 0.0)),
        "_z": slide(joint, (0.0, 0.0, 1.0)),
        "_turn": replace(joint, kind=JointKind.BALL),
    }


def planar_to_three(robot: Robot) -> Robot:
    """The robot with three joints in place of every planar joint."""
    return chained(robot, JointKind.PLANAR, _planar_steps)


def _planar_steps(joint: Joint) -> Steps:
    x, y, _ = perpendicular_frame(joint.axis).T
    return {"_x": slide(joint, vector3(x)), "_y": slide(joint, vector3(y)), "_turn": turn(joint, joint.axis)}


def screw_to_mimic(robot: Robot) -> Robot:
    """The robot with a following prismatic joint and a revolute joint in place of every screw joint."""
    return chained(robot, JointKind.SCREW, _screw_steps)


def _screw_steps(joint: Joint) -> Steps:
    lower, upper = sorted((joint.pitch * joint.limit.lower, joint.pitch * joint.limit.upper))
    endless = isinf(joint.limit.lower) and isinf(joint.limit.upper)
    advance = replace(
        slide(joint, joint.axis),
        limit=Limit(lower, upper),
        mimic=Mimic(joint.name, joint.pitch),
        drawn_position=joint.pitch * joint.drawn_position,
    )
    turned = replace(joint, kind=JointKind.CONTINUOUS if endless else JointKind.REVOLUTE, pitch=0.0)
    return {"_slide": advance, "": turned}


def universal_to_revolutes(robot: Robot) -> Robot:
    """The robot with two revolute joints in place of every universal joint."""
    return chained(robot, JointKind.UNIVERSAL, _universal_steps)


def _universal_steps(joint: Joint) -> Steps:
    return {"_1": turn(joint, joint.axis), "_2": turn(joint, joint.axis2)}
