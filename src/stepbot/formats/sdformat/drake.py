"""The SDFormat that Drake reads of a robot with loops: https://drake.mit.edu, ``drake:ball_constraint``.

Drake does not support joints that close loops, and no engine reads a file with both Drake's elements and such a joint:
hence a separate file. A constraint makes a point of one body coincide with a point of another. Drake requires a
discrete plant with the SAP solver for them.
"""

from collections.abc import Sequence

from msgspec.structs import replace

from stepbot.robot.model import JointKind, MeshFormats, Robot

from ..lowering.joints import closure_points
from ..xml import Element, element

URI = "http://drake.mit.edu"
"""Namespace of the elements, bound to the prefix that Drake expects."""
PREFIX = "drake"
FORMAT = "drake.sdf"
"""The name of the file's format for engines."""


def for_drake(robot: Robot) -> Robot:
    """The robot as Drake reads it: without sensors and actuators of universal joints, with OBJ meshes.

    Drake creates an actuator for any limit but 0, and supports none on multi-dof joints. Its renderer ignores STL,
    COLLADA and binary glTF, and it makes no collision shapes of them.
    """
    joints = tuple(
        replace(joint, limit=replace(joint.limit, effort=0.0)) if joint.kind is JointKind.UNIVERSAL else joint
        for joint in robot.joints
    )
    return replace(robot, joints=joints, sensors=(), mesh_formats=MeshFormats())


def constrain(model: Element, robot: Robot) -> None:
    """Add the constraints of the loop closures; no closure is prismatic."""
    for closure in robot.closures:
        for p_F in closure_points(closure):
            held = element(model, f"{{{URI}}}ball_constraint")
            _say(held, "body_A", closure.link_a)
            _say(held, "p_AP", closure.X_AF.apply(p_F).tolist())
            _say(held, "body_B", closure.link_b)
            _say(held, "p_BQ", closure.X_BF.apply(p_F).tolist())


def _say(held: Element, name: str, value: str | Sequence[float]) -> None:
    element(held, f"{{{URI}}}ball_constraint_{name}", value)
