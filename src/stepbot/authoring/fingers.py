"""The sliding direction of two equal fingers of a gripper."""

from collections.abc import Sequence

import numpy as np

from stepbot.geometry.spatial import Array
from stepbot.geometry.sums import exact_sum
from stepbot.step.faces import FaceKind

from .part import largest
from .survey import Survey

_EQUAL_VOLUME = 1e-3
"""Relative difference of volume up to which two fingers are equal."""
_APART = 1e-3
"""Distance [m] of two centroids from which it defines a direction."""
_FACING = 0.9
"""Cosine of the angle up to which a face points towards the other finger."""


def direction_between(survey: Survey, one: Sequence[int], two: Sequence[int]) -> Array | None:
    """The normal of a face of one finger that points towards or away from the other, equal finger."""
    volumes = survey.total_volume(one), survey.total_volume(two)
    apart = centroid(survey, two) - centroid(survey, one)
    distance = float(np.linalg.norm(apart))
    if abs(volumes[0] - volumes[1]) > _EQUAL_VOLUME * volumes[0] or distance < _APART:
        return None
    main = largest([survey.parts[i] for i in one]).index
    normals = survey.scene.columns(main, FaceKind.PLANE).directions
    best = max(normals, key=lambda n: round(abs(float(n @ apart)), 12), default=None)
    if best is None or abs(float(best @ apart)) < _FACING * distance:
        return None
    return np.asarray(best * np.sign(best @ apart))


def centroid(survey: Survey, members: Sequence[int]) -> Array:
    """Centroid of parts, weighted by volume [m]."""
    parts = [survey.parts[i] for i in members]
    total = exact_sum(p.volume for p in parts)
    if not total:
        return np.asarray(survey.box_of(members).mean(axis=0))
    return np.asarray(np.sum([p.volume * p.com for p in parts], axis=0) / total)
