"""Multi-dof joints as chains of joints of one degree of freedom each, with massless links in between.

One file with one function, Robot to Robot, per kind. The joints of a chain are named like the coordinates of the joint
that it represents, so that a configuration is the same whether a format supports the joint or not.

| kind | chain, from the parent on |
| --- | --- |
| ball | ``_yaw`` about z, ``_pitch`` about y, ``_roll`` about x: fixed-axis roll, pitch, yaw |
| universal | ``_1`` about the axis, ``_2`` about the second one |
| cylindrical | ``_slide`` and ``_turn``, along and about the axis |
| planar | ``_x`` and ``_y`` in the plane, ``_turn`` about its normal |
| floating | ``_x``, ``_y``, ``_z``, then the ball ``_turn`` |
| screw | ``_slide``, which follows the turning joint of the screw's own name |
"""

from dataclasses import replace

from ..model import Joint, JointKind, Limit, Robot
from .chain import (
    ball_to_revolutes,
    cylindrical_to_two,
    floating_to_slides_and_ball,
    planar_to_three,
    screw_to_mimic,
    universal_to_revolutes,
)


def unfolded(robot: Robot) -> Robot:
    """The robot with joints of at most one degree of freedom: fixed, revolute, continuous, prismatic and screw."""
    if not any(joint.kind.coordinates > 1 for joint in robot.joints):
        return robot
    robot = planar_to_three(cylindrical_to_two(universal_to_revolutes(robot)))
    return ball_to_revolutes(floating_to_slides_and_ball(robot))


def ball_coordinates(robot: Robot) -> dict[str, tuple[str, str, str]]:
    """For each ball joint, including those of floating joints, the names of its coordinates: yaw, pitch, roll."""
    folded = floating_to_slides_and_ball(robot)
    names = iter(joint.name for joint in ball_to_revolutes(folded).joints if joint.name not in folded.joint_by_name)
    balls = [joint.name for joint in folded.joints if joint.kind is JointKind.BALL]
    return {ball: (next(names), next(names), next(names)) for ball in balls}


def universal_coordinates(robot: Robot) -> dict[str, tuple[str, str]]:
    """For each universal joint, the names of its coordinates: about the first axis, about the second."""
    names = iter(joint.name for joint in universal_to_revolutes(robot).joints if joint.name not in robot.joint_by_name)
    return {joint.name: (next(names), next(names)) for joint in robot.joints if joint.kind is JointKind.UNIVERSAL}


def steps_by_child(robot: Robot) -> dict[str, tuple[Joint, ...]]:
    """For each link but the root, the joints between it and its parent: joints of one degree of freedom, or balls.

    The prismatic joint of a screw has no limits of its own: the screw's revolute joint has them.
    """
    split = planar_to_three(cylindrical_to_two(universal_to_revolutes(robot)))
    split = screw_to_mimic(floating_to_slides_and_ball(split))
    screws = {joint.name for joint in robot.joints if joint.kind is JointKind.SCREW}
    steps: dict[str, tuple[Joint, ...]] = {}
    chain: list[Joint] = []
    for joint in split.joints:
        follows = joint.name not in robot.joint_by_name and joint.mimic is not None and joint.mimic.joint in screws
        chain.append(replace(joint, limit=Limit()) if follows else joint)
        if joint.child in robot.link_by_name:
            steps[joint.child] = tuple(chain)
            chain = []
    return steps


__all__ = [
    "ball_coordinates",
    "ball_to_revolutes",
    "cylindrical_to_two",
    "floating_to_slides_and_ball",
    "planar_to_three",
    "screw_to_mimic",
    "steps_by_child",
    "unfolded",
    "universal_coordinates",
    "universal_to_revolutes",
]
