"""Gains of actuators from the inertia that they move.

A position actuator and the inertia I of its joint are an oscillator with kp = I w^2 and kv = 2 z I w, where w = 2 pi *
bandwidth and z is the damping ratio; passive damping of the joints is subtracted from kv. A velocity actuator is a
first-order system with kv = I w.

A target that moves at a speed is followed at the distance c / kp times that speed, where c is the whole damping: with
c / kp <= 2 z / w, the error of a sine of frequency f is at most 2 z f / bandwidth of its amplitude.

A position actuator whose joint has limits T of effort and v of velocity has no force left at that speed: the line from
T at rest to nothing at v, a damping of T / v, which is a part of its kv that the effort limit does not cut off
(:func:`line_damping`). An actuator at its effort limit accelerates and brakes no faster than T allows, so that a large
step overshoots in spite of its damping: kv is raised until a simulated step overshoots by :data:`OVERSHOOT` at most.

``gains: auto`` takes the largest I and weight g in the range of the robot, each in its own worst posture, and w as a
lower bound: kp is larger where g would let the joint sag by more than :data:`SAG`, where dry friction would hold it
back by more than :data:`STUCK`, and where the damping alone would make it slower than w. A wheel moves the base that it
carries: :func:`_load_on_wheel`.

In a mechanism, I is the entry of the driven joint in the mass matrix of the driven joints, mimics and loops followed:
the other motors hold. The base is held, too. With loops, and in robots of more than some 70 joints, the posture is the
drawn pose.
"""

from collections.abc import Callable, Mapping
from math import copysign, floor, inf, isfinite, log10, pi, sqrt

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array

from .bounding_boxes import standing_height
from .closures import Loops, driven_joints, following
from .dynamics import equations_of_motion
from .kinematics import initial_configuration, link_poses
from .model import Actuator, ActuatorKind, Base, Joint, JointKind, Limit, Robot
from .multi_dof import unfolded
from .sampling import worst_postures

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
"""Step [rad] and [m] that an actuator at its effort limit brakes in time, or half of the joint's range."""
OVERSHOOT = 0.04
"""Overshoot of that step, as a share of it."""
SAG, SINKING = 0.008, 3.2e-4
"""Error [rad] and [m] that the weight of a joint may cause: four fifths of what drive tests allow."""
STUCK, STICKING = 0.002, 8e-5
"""Error [rad] and [m] that its dry friction may cause."""
CREEP = 0.005
"""Share of the speed of a velocity actuator that the passive damping of its joint may cost."""
DROOP = 0.02
"""Error of a wheel's speed at its effort limit, relative to its velocity limit: both wheels of a base that turns drive
against their casters and against each other."""
_SHORTEST = 2e-3
"""Least time constant [s] of a wheel's speed: with a shorter one a motor at its effort limit leaps from one side of its
target to the other in the time steps of simulators."""
_RESIDUE = 9
"""Decimals [N m] or [N] of weights: smaller ones are rounding of axes that point up."""
_DIGITS = 4
"""Significant digits of gains, which do not depend on the last bits of the linear algebra below."""
_ROUNDING = 1e-9
"""Share of the slope of a torque-speed line that is rounding: a motor's damping may be that slope."""
_LEAST = 1e-30
"""Effort [N m] or [N] below which a motor moves nothing in any time, so that nothing brakes it."""
_CARRIED = 0.95
"""Largest share of the effort limit that a weight takes after a step: what is left still brakes."""
_STEPS = 2000
"""Number of time steps of a simulated step response."""
_HALVINGS = 12
"""Number of halvings of the interval in which the damping that brakes in time is sought."""


def line_damping(actuator: Actuator, joint: Joint) -> float:
    """Damping [N m s/rad] or [N s/m] at the joint that uses up a position actuator's effort at its velocity limit.

    That of the joint is subtracted; 0 without both limits, and for other actuators: a velocity actuator does not drive
    beyond its range. 0 also for a velocity limit of 0, which many URDFs state for want of a number.
    """
    limit = actuator_limit(actuator, joint)
    is_limited = isfinite(limit.effort) and 0.0 < limit.velocity < inf
    if actuator.kind is not ActuatorKind.POSITION or not is_limited:
        return 0.0
    slope = limit.effort / limit.velocity
    lacking = slope - joint.dynamics.damping
    return lacking if lacking > _ROUNDING * slope else 0.0


class _Driven(Struct, frozen=True, eq=False):
    """The driven joints, all others following them."""

    names: tuple[str, ...]
    inertia: Array
    """Diagonal of the mass matrix (n,) in the drawn pose, armatures included."""
    weight: Array
    """Gravity forces (n,) in the drawn pose."""
    largest: Array
    """Largest entry of that diagonal over all postures (n,)."""
    heaviest: Array
    """Largest magnitude of each gravity force over all postures (n,)."""
    damping: Array
    """Diagonal of the passive damping (n,)."""
    stepped: Array
    """Gravity force of each joint in the drawn pose, after a step of it forwards, and after one backwards (n, 3)."""


def tuned(robot: Robot, too_weak: Callable[[Actuator, float, float], None]) -> Robot:
    """The robot with the gains of all actuators that have a :class:`Tuning`; they stay 0 where nothing moves.

    An actuator with the kp of its motor's firmware gets the kv of the torque-speed line, :func:`line_damping`.

    Args:
        too_weak: Called for each of these actuators whose effort limit does not hold its joint in the drawn pose, with
            the limit and the weight [N m] or [N]; its gains ignore the limit.
    """
    on_line = tuple(_with_line(one, robot) for one in robot.actuators)
    robot = robot if on_line == robot.actuators else replace(robot, actuators=on_line)
    if all(actuator.tuning is None for actuator in robot.actuators):
        return robot
    driven = _driven(robot)

    def gains(actuator: Actuator) -> Actuator:
        if actuator.tuning is None:
            return actuator
        # Of more actuators than degrees of freedom, each moves the loop as if it were alone.
        moving = driven if actuator.joint in driven.names else _driven(replace(robot, actuators=(actuator,)))
        return _tuned(robot, actuator, moving, too_weak)

    return replace(robot, actuators=tuple(map(gains, robot.actuators)))


def _with_line(actuator: Actuator, robot: Robot) -> Actuator:
    """The actuator; with the kp of a firmware and no kv, its motor would drive the joint beyond the no-load speed."""
    firmware = actuator.motor.figure("kp") if actuator.motor is not None and actuator.tuning is None else None
    if firmware is None or (actuator.kp, actuator.kv) != (firmware.value, 0.0):
        return actuator
    line = line_damping(actuator, robot.joint_by_name[actuator.joint])
    return replace(actuator, kv=line / actuator.gear**2)  # not rounded: what is beyond the line would be written as kv


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

    def seen(q: Mapping[str, float]) -> tuple[Array, Array]:
        equations = equations_of_motion(robot, q, tree=tree)
        return np.diag(S.T @ (equations.mass_matrix + np.diag(armature)) @ S), S.T @ equations.gravity

    inertia, weight = seen(home)
    largest, heaviest = inertia, np.abs(weight)
    searched = {
        actuator.joint for actuator in robot.actuators if actuator.tuning is not None and actuator.tuning.at_least
    }
    of = [drive for drive in drives if tree.independent[drive] in searched]
    if of and (worst := worst_postures(robot, tree, of)) is not None:
        _, driven, held = worst
        armatures = ((armature[:, None] * tree.B**2)[:, of]).sum(axis=0)
        largest, heaviest = inertia.copy(), heaviest.copy()
        largest[of] = np.maximum(largest[of], driven + armatures)
        heaviest[of] = np.maximum(heaviest[of], held)
    stepped, tuned_joints = (
        np.stack([weight] * 3, axis=1),
        {actuator.joint for actuator in robot.actuators if actuator.tuning},
    )
    for index, name in enumerate(names):
        if robot.closures or name not in tuned_joints:
            continue
        for column, way in ((1, _step(joints[name])), (2, -_step(joints[name]))):
            limit = joints[name].limit
            moved_by = min(max(home[name] + way, limit.lower), limit.upper) - home[name]
            with_mimics = zip(tree.joints, tree.B[:, drives[index]].tolist(), strict=True)
            q = {joint: home[joint] + share * moved_by for joint, share in with_mimics}
            stepped[index, column] = seen(q)[1][index]
    return _Driven(names, inertia, weight, largest, heaviest, np.diag(S.T @ np.diag(damping) @ S), stepped)


def _tuned(
    robot: Robot, actuator: Actuator, driven: _Driven, too_weak: Callable[[Actuator, float, float], None]
) -> Actuator:
    if actuator.tuning is None or actuator.joint not in driven.names:
        return actuator
    index, tuning = driven.names.index(actuator.joint), actuator.tuning
    inertia = float((driven.largest if tuning.at_least else driven.inertia)[index])
    passive = float(driven.damping[index])
    weight = round(abs(float(driven.weight[index])), _RESIDUE)
    joint = robot.joint_by_name[actuator.joint]
    w = 2.0 * pi * tuning.bandwidth
    stiffened = braked = False
    if actuator.kind is ActuatorKind.POSITION:
        line = line_damping(actuator, joint)
        kp = wanted = inertia * w**2
        if tuning.at_least:
            heaviest = round(float(driven.heaviest[index]), _RESIDUE)
            slow = (passive + line) * w / (2.0 * tuning.damping_ratio)
            kp = max(kp, slow, _holding_stiffness(joint, heaviest))
        stiffened = kp > wanted
        damping = 2.0 * tuning.damping_ratio * sqrt(kp * inertia)
        if tuning.at_least:
            damping = max(damping, passive + line)
        uncut = passive + min(line, max(damping - passive, 0.0))
        effort = actuator_limit(actuator, joint).effort
        if effort <= weight:
            too_weak(actuator, effort, weight)
        elif isfinite(effort) and inertia > 0.0 and effort >= _LEAST:
            drawn, most = float(driven.inertia[index]), max(weight, _CARRIED * effort)
            first, up, down = (
                min(max(round(float(one), _RESIDUE), -most), most) for one in driven.stepped[index].tolist()
            )
            friction, critical = joint.dynamics.friction, damping
            for pulls in ((-first, -up), (first, down)):
                step = _Step(drawn, effort, pulls, kp, uncut, friction, _step(joint))
                damping = _braking(step, damping)
            braked = damping > critical
    else:
        kp = 0.0
        damping = 0.0
        if tuning.at_least:
            load = _load_on_wheel(robot, joint)
            limit = actuator_limit(actuator, joint)
            is_limited = load > 0.0 and isfinite(limit.effort) and 0.0 < limit.velocity < inf
            droop = limit.effort / (DROOP * limit.velocity) if is_limited else 0.0
            inertia = max(inertia, load)
            damping = max(passive / CREEP, min(droop, inertia / _SHORTEST)) + passive
        damping = max(inertia * w, damping)
    square = actuator.gear**2
    tuned = replace(tuning, inertia=_rounded(inertia), weight=_rounded(weight), stiffened=stiffened, braked=braked)
    kp, kv = kp / square, max(damping - passive, 0.0) / square
    return replace(actuator, kp=_rounded(kp), kv=_rounded(kv), tuning=tuned)


def _holding_stiffness(joint: Joint, heaviest: float) -> float:
    """The kp that holds a joint against its weight and its dry friction."""
    sag, stuck = (SINKING, STICKING) if joint.kind is JointKind.PRISMATIC else (SAG, STUCK)
    return max(heaviest / sag, joint.dynamics.friction / stuck)


class _Step(Struct, frozen=True):
    """A step of a joint whose effort is limited, from rest in the drawn pose."""

    inertia: float
    effort: float
    pulls: Bounds
    """Weight in the direction of the step, at its beginning and at its end; in between it changes with the way.

    Where it falls, by half as much only: from other postures the same step is heavier.
    """
    kp: float
    passive: float
    """Damping that the effort limit does not cut off."""
    friction: float
    """Dry friction."""
    size: float

    def overshoot(self, damping: float) -> float:
        """The largest position beyond the target, as a share of the step.

        Args:
            damping: The whole damping, ``passive`` included.
        """
        if not self.size:
            return 0.0
        # Long enough to cover the way at the effort limit and back.
        slowest = max(self.effort + min(self.pulls) - self.friction, (1.0 - _CARRIED) * self.effort)
        seconds = 4.0 * sqrt(2.0 * self.size * self.inertia / slowest) + 4.0 * damping / self.kp
        h, x, v, most = seconds / _STEPS, 0.0, 0.0, self.size
        first, last = self.pulls
        last = max(last, 0.5 * (first + last))
        slowed = h * self.friction / (self.inertia + h * self.passive)
        for _ in range(_STEPS):
            wanted = self.kp * (self.size - x) - (damping - self.passive) * v
            pull = first + (last - first) * min(max(x / self.size, 0.0), 1.0)
            force = min(max(wanted, -self.effort), self.effort) + pull
            v = (v + h * force / self.inertia) / (1.0 + h * self.passive / self.inertia)
            v = copysign(max(abs(v) - slowed, 0.0), v)
            x += h * v
            most = max(most, x)
        return (most - self.size - max(last, 0.0) / self.kp) / self.size


def _braking(step: _Step, damping: float) -> float:
    """The damping, at least the given one, with which a step overshoots by no more than :data:`OVERSHOOT`."""
    if step.overshoot(damping) <= OVERSHOOT:
        return damping
    # With this one it does not overshoot at all: the deceleration from the fastest approach is within the limit.
    weight = max(0.0, *step.pulls)
    margin = (step.effort - weight) / (step.effort + weight) * (3.0 * step.effort + weight) / 2.0
    low, high = damping, max(damping, step.kp * sqrt(step.inertia * step.size / margin))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if step.overshoot(middle) <= OVERSHOOT else (middle, high)
    return high


def _load_on_wheel(robot: Robot, joint: Joint) -> float:
    """Inertia [kg m^2] at the axle of a driven wheel of a floating base: its share of the robot's mass, times radius^2.

    The radius is the height of the axle above the floor on which the robot stands. 0 for what is no wheel.
    """
    wheels = {actuator.joint for actuator in robot.actuators if actuator.kind is ActuatorKind.VELOCITY}
    if robot.base is not Base.FLOATING or joint.kind is not JointKind.CONTINUOUS or joint.name not in wheels:
        return 0.0
    home = initial_configuration(robot)
    radius = link_poses(robot, home)[joint.child].position[2] + standing_height(robot, home)
    mass = exact_sum(link.mass_properties.mass for link in robot.links)
    return mass * max(radius, 0.0) ** 2 / len(wheels)


def _step(joint: Joint) -> float:
    """The step [rad] or [m] that must not overshoot; 0 between equal limits."""
    widest = TRAVEL if joint.kind is JointKind.PRISMATIC else STEP
    return min(widest, 0.5 * (joint.limit.upper - joint.limit.lower))


def _rounded(value: float) -> float:
    """The value to its significant digits."""
    return round(value, _DIGITS - 1 - floor(log10(abs(value)))) if value else 0.0
