"""Numbers that mean unlimited: formats that require a number get an unreachable one."""

from dataclasses import replace
from math import inf

from stepbot.engines.observation import Observation, ObservedJoint
from stepbot.formats.lowering import UNLIMITED
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.model import Limit


def without_stand_ins(observation: Observation) -> Observation:
    """The observation with infinite limits in place of such numbers."""
    return replace(observation, joints=tuple(_freed(joint) for joint in observation.joints))


def _freed(joint: ObservedJoint) -> ObservedJoint:
    return replace(
        joint,
        limit=None if joint.limit is None else _free(joint.limit),
        steps=tuple(_freed(step) for step in joint.steps),
    )


def _free(limit: Limit) -> Limit:
    return Limit(
        -inf if limit.lower <= -NO_BOUND else limit.lower,
        inf if limit.upper >= NO_BOUND else limit.upper,
        inf if limit.velocity >= UNLIMITED else limit.velocity,
        inf if limit.effort >= UNLIMITED else limit.effort,
    )
