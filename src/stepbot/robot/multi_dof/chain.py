"""Replaces joints by chains of joints, common to all multi-dof kinds."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from stepbot.geometry.spatial import Pose, Vector3

from ..model import Joint, JointKind, Limit, Link, Robot
from ..sensors import Sensor, SensorKind
from ..unique_names import free_name

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
