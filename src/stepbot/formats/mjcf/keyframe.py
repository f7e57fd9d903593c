"""The keyframe ``home``: the drawn pose, in which a floating robot stands on the floor at z = 0."""

from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import ActuatorKind, Base, Joint, JointKind, Robot
from stepbot.robot.multi_dof import steps_by_child
from stepbot.robot.standing import standing_height

from ..xml import Element, element

HOME = "home"
"""Name of the keyframe."""


def keyframe(top: Element, robot: Robot) -> None:
    """Add the drawn pose, if it is not q = 0, a loop must close, or the base floats; position actuators hold it."""
    drawn = initial_configuration(robot)
    floats = robot.base is Base.FLOATING
    if not (robot.closures or floats or any(drawn.values())):
        return
    base = [0.0, 0.0, standing_height(robot, drawn), 1.0, 0.0, 0.0, 0.0] if floats else []
    steps = steps_by_child(robot)
    qpos = base + [value for link in _depth_first(robot) for step in steps[link] for value in _drawn(step)]
    control = [
        drawn[actuator.joint] * actuator.gear if actuator.kind is ActuatorKind.POSITION else 0.0
        for actuator in robot.actuators
    ]
    element(element(top, "keyframe"), "key", name=HOME, qpos=qpos, **({"ctrl": control} if any(control) else {}))


def _drawn(step: Joint) -> list[float]:
    """MuJoCo's coordinates of a joint as drawn; multi-dof joints are drawn at 0."""
    if step.kind is JointKind.BALL:
        return [1.0, 0.0, 0.0, 0.0]
    return [] if step.kind is JointKind.FIXED else [step.drawn_position]


def _depth_first(robot: Robot) -> list[str]:
    """Names of the links below the root in the order of MuJoCo's coordinates: that of the nested bodies."""
    below: dict[str, list[Joint]] = {link.name: [] for link in robot.links}
    for joint in robot.joints:
        below[joint.parent].append(joint)
    order: list[str] = []
    stack = list(reversed(below[robot.root.name]))
    while stack:
        joint = stack.pop()
        order.append(joint.child)
        stack += reversed(below[joint.child])
    return order
