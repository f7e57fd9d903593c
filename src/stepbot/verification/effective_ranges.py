"""Ranges of actuators as far as their joints let them have an effect.

A force beyond the effort limit of the joint is cut there, and so is the input of a motor, which is a force. The model
holds what remains; a description may have wider ranges, or none.
"""

from dataclasses import replace
from math import inf, isnan

from stepbot.engines.observation import Observation, ObservedActuator, ObservedJoint
from stepbot.robot.model import ActuatorKind, Limit

Bounds = tuple[float, float]


def with_effective_ranges(observation: Observation) -> Observation:
    """The observation with inputs and forces of actuators within the limits of their joints."""
    if observation.actuators is None:
        return observation
    limits = {step.name: step.limit or Limit() for joint in observation.joints for step in _with_steps(joint)}
    actuators = tuple(_effective(one, limits.get(one.joint, Limit())) for one in observation.actuators)
    return replace(observation, actuators=actuators)


def _with_steps(joint: ObservedJoint) -> tuple[ObservedJoint, ...]:
    return joint, *joint.steps


def _effective(actuator: ObservedActuator, limit: Limit) -> ObservedActuator:
    gear = actuator.gear or 1.0
    force = _within(actuator.force, _symmetric(limit.effort / gear))
    if actuator.kind == ActuatorKind.MOTOR:
        control = _within(_within(actuator.control, _symmetric(limit.effort / gear)), force)
        return replace(actuator, control=control, force=_within(force, control))
    if actuator.kind == ActuatorKind.POSITION:
        low, high = sorted((limit.lower * gear, limit.upper * gear))
        return replace(actuator, control=_within(actuator.control, (low, high)), force=force)
    if actuator.kind == ActuatorKind.VELOCITY:
        return replace(actuator, control=_within(actuator.control, _symmetric(limit.velocity * gear)), force=force)
    return actuator


def _symmetric(bound: float) -> Bounds:
    return -abs(bound), abs(bound)


def _within(bounds: Bounds | None, limits: Bounds | None) -> Bounds | None:
    """The common part of two ranges; unknown bounds have none, and limits that an engine cannot express are ignored."""
    if bounds is None or limits is None:
        return bounds
    low, high = (-inf if isnan(limits[0]) else limits[0]), (inf if isnan(limits[1]) else limits[1])
    return max(bounds[0], low), min(bounds[1], high)
