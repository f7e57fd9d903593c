"""Bounds of an actuator's input and force: its own limits combined with those of its joint.

Limits are given at the joint. A gear multiplies positions and velocities from joint to actuator, and divides forces.
"""

from .model import Actuator, ActuatorKind, Joint, Limit

Bounds = tuple[float, float]


def actuator_limit(actuator: Actuator, joint: Joint) -> Limit:
    """The narrower of the actuator's and the joint's limits, at the joint [rad, rad/s, N m] or [m, m/s, N]."""
    a, b = actuator.limit, joint.limit
    return Limit(max(a.lower, b.lower), min(a.upper, b.upper), min(a.velocity, b.velocity), min(a.effort, b.effort))


def joint_range(actuator: Actuator, joint: Joint) -> Bounds:
    """Lowest and highest input at the joint, after the gear, in SI; infinite without a limit."""
    limit = actuator_limit(actuator, joint)
    match actuator.kind:
        case ActuatorKind.POSITION:
            return limit.lower, limit.upper
        case ActuatorKind.VELOCITY:
            return -limit.velocity, limit.velocity
        case ActuatorKind.MOTOR:
            return -limit.effort, limit.effort


def control_range(actuator: Actuator, joint: Joint) -> Bounds:
    """Lowest and highest input at the actuator: position, velocity or effort, in SI; infinite without a limit."""
    scale = 1.0 / actuator.gear if actuator.kind is ActuatorKind.MOTOR else actuator.gear
    low, high = sorted(scale * bound for bound in joint_range(actuator, joint))
    return low, high


def force_range(actuator: Actuator, joint: Joint) -> Bounds:
    """Lowest and highest force at the actuator [N m or N]; infinite without a limit."""
    effort = actuator_limit(actuator, joint).effort / abs(actuator.gear)
    return -effort, effort
