"""Gains of actuators from the inertia that they move in the drawn pose.

A position actuator and the inertia I of its joint are an oscillator with kp = I w^2 and kv = 2 z I w, where w = 2 pi *
bandwidth and z is the damping ratio; passive damping of the joints is subtracted from kv. A velocity actuator is a
first-order system with kv = I w.

An actuator at its effort limit T accelerates and brakes no faster than T allows, so that a large step overshoots in
spite of its damping. With velocity v and error e, it brakes from v = (kp / kv) e on, which takes the deceleration
(kp / kv)^2 e. With the joint's weight g against it, T suffices after a step s from rest if

    (kp / kv)^2 <= (T - g) (3 T + g) / (2 (T + g) I s)

and kv is raised until it does.

Where the bandwidth is only a lower bound, kp is larger than I w^2 in two cases. The weight g of the joint, the largest
over its own range, must not let it sag by more than :data:`SAG`: kp >= g / SAG. And passive damping d beyond 2 I w
makes the joint slower than w: kp = d w - I w^2 puts the slower of its two poles at w again. Then kv = 2 z sqrt(kp I).

In a mechanism, I is the entry of the driven joint in the mass matrix of the driven joints, mimics and loops followed:
the other motors hold. The base is held, too.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import floor, isfinite, log10, pi, sqrt

import numpy as np

from stepbot.geometry.spatial import Array

from .closures import Loops, driven_joints, following
from .dynamics import equations_of_motion
from .kinematics import initial_configuration, leader_range
from .model import Actuator, ActuatorKind, Joint, JointKind, Limit, Robot
from .multi_dof import unfolded

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


STEP, TRAVEL = 0.5, 0.1
"""Step [rad] and [m] that an actuator at its effort limit brakes without overshoot, or half of the joint's range."""
SAG, SINKING = 0.04, 1.6e-3
"""Error [rad] and [m] that the weight of a joint may cause: four fifths of what drive tests allow."""
_POSITIONS = 5
"""Number of positions over a joint's range in which its weight is computed; in a full turn, one each 90 degrees."""
_RESIDUE = 9
"""Decimals [N m] or [N] of weights: smaller ones are rounding of axes that point up."""
_DIGITS = 4
"""Significant digits of gains, which do not depend on the last bits of the linear algebra below."""


@dataclass(frozen=True, eq=False)
class _Driven:
    """The driven joints in the drawn pose, all others following them."""

    names: tuple[str, ...]
    inertia: Array
    """Diagonal of the mass matrix (n,), armatures included."""
    weight: Array
    """Gravity forces (n,)."""
    heaviest: Array
    """Largest magnitude of each gravity force over its joint's range, others as drawn; with loops in that pose (n,)."""
    damping: Array
    """Diagonal of the passive damping (n,)."""


def tuned(robot: Robot, too_weak: Callable[[Actuator, float, float], None]) -> Robot:
    """The robot with the gains of all actuators that have a :class:`Tuning`.

    Args:
        robot: The robot.
        too_weak: Called for each of these actuators whose effort limit does not hold its joint in the drawn pose, with
            the limit and the weight [N m] or [N]; its gains ignore the limit.
    """
    if all(actuator.tuning is None for actuator in robot.actuators):
        return robot
    driven = _driven(robot)
    return replace(robot, actuators=tuple(_tuned(robot, actuator, driven, too_weak) for actuator in robot.actuators))


def _driven(robot: Robot) -> _Driven:
    """Inertia, weight and damping of the driven joints."""
    loops, home = Loops(robot), initial_configuration(robot)
    tree = loops.tree
    _, J = loops.constraints(tree.vector(home))
    names = driven_joints(robot) if robot.closures else tree.independent
    drives = [tree.independent.index(name) for name in names]
    follow = following(tree, names)
    T = np.zeros((len(tree.independent), len(drives)))
    T[drives, range(len(drives))] = 1.0
    if follow and robot.closures:
        T[follow] = -np.linalg.lstsq(J[:, follow], J[:, drives], rcond=None)[0]
    S = tree.B @ T
    joints = unfolded(robot).joint_by_name
    armature, damping = (
        np.array([getattr(joints[name].dynamics, field) for name in tree.joints]) for field in ("armature", "damping")
    )
    equations = equations_of_motion(robot, home)
    inertia = S.T @ (equations.mass_matrix + np.diag(armature)) @ S
    weight = S.T @ equations.gravity
    heaviest = np.abs(weight)
    wanted = {one.joint for one in robot.actuators if one.tuning is not None and one.tuning.at_least}
    for i, name in enumerate(names):
        for position in np.linspace(*leader_range(robot, name), _POSITIONS) if name in wanted and not follow else ():
            moved = equations_of_motion(robot, {**home, name: float(position)}, tree=tree).gravity
            heaviest[i] = max(heaviest[i], abs(float(S[:, i] @ moved)))
    return _Driven(names, np.diag(inertia), weight, heaviest, np.diag(S.T @ np.diag(damping) @ S))


def _tuned(
    robot: Robot, actuator: Actuator, driven: _Driven, too_weak: Callable[[Actuator, float, float], None]
) -> Actuator:
    if actuator.tuning is None or actuator.joint not in driven.names:
        return actuator
    index = driven.names.index(actuator.joint)
    inertia, passive = float(driven.inertia[index]), float(driven.damping[index])
    weight = round(abs(float(driven.weight[index])), _RESIDUE)
    joint = robot.joint_by_name[actuator.joint]
    w = 2.0 * pi * actuator.tuning.bandwidth
    kp, kv, stiffened, braked = 0.0, inertia * w, False, False
    if actuator.kind is ActuatorKind.POSITION:
        heaviest = round(float(driven.heaviest[index]), _RESIDUE)
        kp = _stiffness(inertia, passive, heaviest, w, joint) if actuator.tuning.at_least else inertia * w**2
        stiffened, kv = kp > inertia * w**2, 2.0 * actuator.tuning.damping_ratio * sqrt(kp * inertia)
        effort = actuator_limit(actuator, joint).effort
        if effort <= weight:
            too_weak(actuator, effort, weight)
        elif isfinite(effort):
            braking = kp * sqrt(inertia * _step(joint) / _fastest_braking(effort, weight))
            braked, kv = braking > kv, max(kv, braking)
    square = actuator.gear**2
    found = replace(
        actuator.tuning, inertia=_rounded(inertia), weight=_rounded(weight), stiffened=stiffened, braked=braked
    )
    kp, kv = kp / square, max(kv - passive, 0.0) / square
    return replace(actuator, kp=_rounded(kp), kv=_rounded(kv), tuning=found)


def _stiffness(inertia: float, passive: float, heaviest: float, w: float, joint: Joint) -> float:
    """The kp that holds the joint's weight, and is no slower than ``w`` [rad/s] in spite of passive damping."""
    sag = SINKING if joint.kind is JointKind.PRISMATIC else SAG
    overcome = passive * w - inertia * w**2 if passive > 2.0 * inertia * w else 0.0
    return max(inertia * w**2, overcome, heaviest / sag)


def _fastest_braking(effort: float, weight: float) -> float:
    """Square of the largest kp / kv that brakes without overshoot, times inertia and step."""
    # The quotient first: the product of two small efforts would underflow to 0.
    return (effort - weight) / (effort + weight) * (3.0 * effort + weight) / 2.0


def _step(joint: Joint) -> float:
    """The step [rad] or [m] that must not overshoot; 0 between equal limits."""
    widest = TRAVEL if joint.kind is JointKind.PRISMATIC else STEP
    return min(widest, 0.5 * (joint.limit.upper - joint.limit.lower))


def _rounded(value: float) -> float:
    """The value to its significant digits."""
    return round(value, _DIGITS - 1 - floor(log10(abs(value)))) if value else 0.0
