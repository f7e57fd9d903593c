"""Values that formats write where the robot has none: mass and inertia of frames, and bounds that mean unlimited."""

from math import inf

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import NEVER_ZERO, Observation, ObservedJoint, ObservedLink
from stepbot.formats import format_named
from stepbot.formats.features import Feature, Level
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.formats.lowering.masses import LEAST_MASS, LEAST_MOMENT, STAND_IN_MASS, STAND_IN_MOMENT
from stepbot.geometry.spatial import ZERO3, ZERO33
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.surfaces import Surface

_STAND_INS = ((STAND_IN_MASS, STAND_IN_MOMENT), (LEAST_MASS, LEAST_MOMENT))
_OWN_FRICTION = 1.0
"""What MuJoCo reports of a shape that states other contact properties, and no friction."""
_ROUNDING = 1e-6
"""Relative error of numbers in single precision."""


def without_stand_ins(observation: Observation) -> Observation:
    """The observation with infinite limits, massless links and point masses, in place of such numbers."""
    return replace(
        observation,
        links=tuple(_without_stand_in(link) for link in observation.links),
        joints=tuple(freed(_without_zeros(joint)) for joint in observation.joints),
    )


def _without_zeros(joint: ObservedJoint) -> ObservedJoint:
    zero = [name for name in NEVER_ZERO if joint.limit is not None and getattr(joint.limit, name) == 0.0]
    limit = joint.limit and replace(joint.limit, **dict.fromkeys(zero, inf))
    return replace(joint, limit=limit, steps=tuple(map(_without_zeros, joint.steps)))


def _without_stand_in(link: ObservedLink) -> ObservedLink:
    """A massless link, or a point mass: links of other programs may have the same mass alone."""
    for mass, moment in _STAND_INS if link.mass is not None else ():
        is_mass, is_moment = abs((link.mass or 0.0) - mass) < _ROUNDING * mass, _has_moment(link, moment)
        if is_mass and (is_moment or link.inertia is None):
            return replace(link, mass=0.0, com=ZERO3, inertia=ZERO33)
        if is_moment and (link.mass or 0.0) < mass:  # lighter than any link that has this inertia itself
            return replace(link, inertia=ZERO33)
    return link


def _has_moment(link: ObservedLink, moment: float) -> bool:
    same = link.inertia is not None and np.allclose(link.inertia, moment * np.eye(3), rtol=0.0, atol=_ROUNDING * moment)
    return bool(same)


def with_points_of(a: Observation, b: Observation) -> Observation:
    """One side without the moments that its format needs where the other side has point masses."""
    points = {link.name for link in b.links if link.mass and link.inertia == ZERO33}
    if not points or format_named(a.format).expresses[Feature.MASSLESS].level is Level.EXACT:
        return a
    links = (
        replace(link, inertia=ZERO33) if link.name in points and _has_moment(link, STAND_IN_MOMENT) else link
        for link in a.links
    )
    return replace(a, links=tuple(links))


def with_surfaces_of(a: Observation, b: Observation) -> Observation:
    """One side with one surface per link, that of the shape with most friction, if the other's format has no more."""
    mixed = any(len({shape.surface for shape in link.collisions or ()}) > 1 for link in a.links)
    if not mixed or format_named(b.format).expresses[Feature.MIXED_SURFACE].level is Level.EXACT:
        return a
    others = {link.name: link.collisions[0].surface for link in b.links if link.collisions}
    return replace(a, links=tuple(_with_one_surface(link, others.get(link.name)) for link in a.links))


def _with_one_surface(link: ObservedLink, other: Surface | None) -> ObservedLink:
    surfaces = {
        collision.surface: collision.surface.friction
        for collision in link.collisions or ()
        if collision.surface is not None
    }
    frictions = sorted({friction for friction in surfaces.values() if friction is not None})
    if other is None or len(surfaces) < 2 or not frictions:
        return link
    most = frictions[-1]
    if most == _OWN_FRICTION and len(frictions) > 1 and other.friction == frictions[-2]:
        most = frictions[-2]
    surface = next(one for one, friction in surfaces.items() if friction == most)
    return replace(link, collisions=tuple(replace(collision, surface=surface) for collision in link.collisions or ()))


def freed(joint: ObservedJoint) -> ObservedJoint:
    """A joint without bounds that mean unlimited; a hinge without any is continuous."""
    far = joint.limit is not None and -inf < joint.limit.lower <= -NO_BOUND and NO_BOUND <= joint.limit.upper < inf
    joint = replace(joint, kind="continuous") if joint.kind == "revolute" and far else joint
    limit = joint.limit and joint.limit.without_beyond(NO_BOUND, UNLIMITED)
    return replace(joint, limit=limit, steps=tuple(map(freed, joint.steps)))
