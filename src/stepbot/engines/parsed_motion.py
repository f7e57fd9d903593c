"""Poses and equations of motion of a parsed file, by stepbot's own kinematics: for parsers, which cannot compute them.

They confirm the values in the file, not the behaviour of an engine.
"""

from collections.abc import Callable, Mapping

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose, Vector3, matrix3, vector3
from stepbot.robot.dynamics import equations_at
from stepbot.robot.kinematics import MOVING, Configuration, Tree, link_poses_at
from stepbot.robot.model import Joint, JointKind, Limit, Link, Robot

from .observation import Dynamics, EngineCannotRead, EngineRefused, Observation, Quantity, Request

NOTE = "read by stepbot's own parser, with stepbot's own kinematics"
"""Of the parsers that use it, for the report."""

Frames = Mapping[str, tuple[Pose, Pose]]
"""For each link with a parent, the pose of the joint above it with q = 0: in its parent, and in itself."""

_MOVED = MOVING | {JointKind.FIXED, JointKind.BALL, JointKind.UNIVERSAL}
"""Joint types that formats and the model have."""


def with_motion(
    observation: Observation, frames: Frames, gravity: Callable[[str], Vector3], request: Request
) -> Observation:
    """The observation with poses and equations of motion; mimics move like other joints, as in engines.

    Args:
        gravity: Acceleration of gravity [m/s^2] in the frame of the root, by its name.

    Raises:
        EngineRefused: A joint refers to a link that does not exist.
        EngineCannotRead: The links do not form a single tree.
    """
    strange = sorted({joint.kind for joint in observation.joints} - {kind.value for kind in _MOVED})
    if strange:
        reason = f"stepbot has no kinematics for {', '.join(strange)} joints"
        moving = (Quantity.POSES, Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS)
        not_run = dict.fromkeys(moving, reason)
        return replace(observation, not_run={**observation.not_run, **not_run})
    robot = _robot(observation, frames)
    layout = Tree(robot)

    def known(q: Configuration) -> dict[str, float]:
        return {name: q.get(name, 0.0) for name in layout.joints}

    poses = tuple(
        {name: X @ _X_LJ(frames, name).inverse() for name, X in X_WJ.items()}
        for X_WJ in link_poses_at(robot, [known(q) for q in (*request.configurations, *request.closed)], layout)
    )
    moments = [(known(q), rates) for q, rates in request.moments]
    equations = equations_at(robot, moments, gravity=gravity(robot.root.name), tree=layout)
    dynamics = tuple(Dynamics(equation.mass_matrix, equation.gravity, equation.inverse) for equation in equations)
    return replace(observation, coordinates=layout.joints, poses=poses, dynamics=dynamics)


def _X_LJ(frames: Frames, link: str) -> Pose:
    """Pose of the joint above a link in the link; the identity for the root."""
    return frames[link][1] if link in frames else Pose()


def _robot(observation: Observation, frames: Frames) -> Robot:
    """The parsed robot with each link frame at the joint above."""
    links = {link.name: link for link in observation.links}
    joint_of = {joint.child: joint for joint in observation.joints}
    for joint in observation.joints:
        for name in (joint.parent, joint.child):
            if name not in links:
                raise EngineRefused(f"joint '{joint.name}': no link '{name}'")
    roots = [name for name in links if name not in joint_of]
    if len(roots) != 1:
        raise EngineCannotRead(f"{len(roots)} root links, one expected: {', '.join(roots)}")
    order = list(roots)
    for name in order:  # grows during the loop
        order += [joint.child for joint in observation.joints if joint.parent == name]

    def joint_above(name: str) -> Joint:
        seen, (X_PJ, X_LJ) = joint_of[name], frames[name]
        return Joint(
            seen.name,
            JointKind(seen.kind),
            seen.parent,
            name,
            _X_LJ(frames, seen.parent).inverse() @ X_PJ,
            vector3(X_LJ.inverse().turn(seen.axis or (0.0, 0.0, 1.0))),
            vector3(X_LJ.inverse().turn(seen.axis2 or (1.0, 0.0, 0.0))),
            limit=seen.limit or Limit(),
            pitch=seen.pitch or 0.0,
        )

    bodies = []
    for name in order:
        link = links[name]
        body = MassProperties(link.mass or 0.0, link.com or (0.0, 0.0, 0.0), link.inertia or matrix3(np.zeros((3, 3))))
        bodies.append(Link(name, body.moved(_X_LJ(frames, name).inverse())))
    return Robot("model", tuple(bodies), tuple(joint_above(name) for name in order[1:]))
