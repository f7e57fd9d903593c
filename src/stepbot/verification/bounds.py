"""Numbers that stand in for none: formats that require a limit get an unreachable one, or a mass, a tiny one."""

from dataclasses import replace
from math import inf

import numpy as np

from stepbot.engines.observation import NEVER_ZERO, Observation, ObservedJoint, ObservedLink
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.formats.lowering.masses import LEAST_MASS, LEAST_MOMENT, STAND_IN_MASS, STAND_IN_MOMENT
from stepbot.geometry.spatial import ZERO3, ZERO33
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.model import Limit

_STAND_INS = ((STAND_IN_MASS, STAND_IN_MOMENT), (LEAST_MASS, LEAST_MOMENT))
_ROUNDING = 1e-6
"""Relative error of numbers in single precision."""


def without_stand_ins(observation: Observation) -> Observation:
    """The observation with infinite limits, and massless links, in place of such numbers."""
    return replace(
        observation,
        links=tuple(_massless(link) if _has_stand_in(link) else link for link in observation.links),
        joints=tuple(_freed(joint) for joint in observation.joints),
    )


def _has_stand_in(link: ObservedLink) -> bool:
    """Whether mass and inertia are those of a stand-in: links of other programs may have the same mass alone."""
    return link.mass is not None and any(
        abs(link.mass - mass) < _ROUNDING * mass
        and (link.inertia is None or np.allclose(link.inertia, moment * np.eye(3), rtol=0.0, atol=_ROUNDING * moment))
        for mass, moment in _STAND_INS
    )


def _massless(link: ObservedLink) -> ObservedLink:
    return replace(link, mass=0.0, com=ZERO3, inertia=ZERO33)


def _freed(joint: ObservedJoint) -> ObservedJoint:
    return replace(
        joint,
        limit=None if joint.limit is None else _free(joint.limit),
        steps=tuple(_freed(step) for step in joint.steps),
    )


def _free(limit: Limit) -> Limit:
    zero = [name for name in NEVER_ZERO if getattr(limit, name) == 0.0]
    limit = replace(limit, **dict.fromkeys(zero, inf))
    return replace(
        limit,
        lower=-inf if limit.lower <= -NO_BOUND else limit.lower,
        upper=inf if limit.upper >= NO_BOUND else limit.upper,
        velocity=inf if limit.velocity >= UNLIMITED else limit.velocity,
        effort=inf if limit.effort >= UNLIMITED else limit.effort,
    )
