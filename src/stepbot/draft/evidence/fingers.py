"""Fingers of a gripper: two equal bodies, named so, that face each other on one body.

Grippers are often drawn without what guides their fingers; a finger that two screws or rails hold has other evidence.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import BY_NAME, Evidence, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import largest
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array
from stepbot.robot.model import JointKind
from stepbot.step.faces import FaceKind

_SCORE = 0.6
_ACROSS = 0.1
"""Cosine up to which a face is along the motion."""
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


@rule(160)
def finger_evidence(survey: Survey, evidence: Evidence) -> None:
    """Two equal fingers that only lie on one body slide on it towards each other."""
    fingers = [i for i, part in survey.parts.items() if Role.JAW in part.roles and i not in survey.small]
    for one, two in combinations(fingers, 2):
        along = direction_between(survey, [one], [two])
        hosts = _hosts(survey, one) & _hosts(survey, two)
        if along is None or len(hosts) != 1:
            continue
        (host,) = hosts
        for finger in (one, two):
            relation = survey.relation(finger, host)
            if relation is None or any(abs(float(p.normal @ along)) > _ACROSS for p in relation.patches):
                continue
            axis = Axis(centroid(survey, [finger]), along)
            a, b = sorted((finger, host))
            why = "one of two equal fingers by name, on one face"
            evidence.joint(JointEvidence(_SCORE, a, b, JointKind.PRISMATIC, axis, why, relation, review=BY_NAME))


def _hosts(survey: Survey, finger: int) -> set[int]:
    """The larger bodies that a finger touches with plane faces alone."""
    touching = list(survey.around(finger))
    return {other for other, r in touching if r.patches} if not any(r.fits for _, r in touching) else set()
