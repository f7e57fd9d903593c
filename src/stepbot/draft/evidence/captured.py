"""Slides that are captured on four sides: a tube in a tube, a carriage around a rail, a quill in its guide.

Their faces may be drawn with clearance, so that nothing touches; that alone says that one is to move in the other.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stepbot.draft.contacts.contacts import Pair, Patch
from stepbot.draft.contacts.planes import GAP, Planes
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.draft.parts.names import Role
from stepbot.geometry.spatial import Array, cross
from stepbot.robot.model import JointKind
from stepbot.step.faces import FaceKind

REVIEW = "captured on four sides and free along one direction: it may be fastened"
"""What to review of each such joint."""
_CLEARANCE = 3e-4
"""Gap [m] between faces of a slide up to which they guide it."""
_DEEP = 1e-3
"""Overlap [m] of two bounding boxes, in all directions, from which one part may be in the other."""
_ENGAGED = 1.0
"""Engaged length, in widths of what is captured, from which it slides and is not only placed."""
_LOOSE, _TIGHT, _ACROSS = 0.72, 0.67, 0.05
"""Scores with clearance and without, and what is added for parts of two subassemblies."""
_STRAIGHT, _SKEW = 1e-2, 0.5
"""Cosine up to which a face is along a slide; sine of the least angle between its two directions across."""
_MOST_PLANES = 2000
"""Number of planes of a part above which it is not looked at."""


@dataclass(frozen=True, eq=False)
class _Facing:
    """Two planes that face each other."""

    normal: Array
    """Shape (3,): outward normal of the first part."""
    gap: float
    patch: Patch


@dataclass(frozen=True, eq=False)
class _Captured:
    """A direction in which a part is held on both sides."""

    normal: Array
    width: float
    """[m], as ``play``."""
    play: float


def captured_evidence(survey: Survey, motors: Sequence[Motor], structure: Structure, found: Evidence) -> None:
    """Add a joint for each pair of parts of which one is captured in the other, free along one direction."""
    in_motor = {i for motor in motors for i in motor.parts}
    planes: Planes | None = None
    for pair in _overlapping(survey, in_motor):
        planes = planes or Planes(survey.scene)
        facing = list(_facing(planes, pair))
        by_name = any(Role.SLIDE in survey.parts[i].roles for i in pair)
        slide = _slide(facing, by_name=by_name)
        if slide is None or _is_fastened(survey, pair) or structure.are_together(*pair):
            continue
        axis, has_play = slide
        score = (_LOOSE if has_play else _TIGHT) + _ACROSS * structure.are_across(*pair)
        why = "captured on four sides" + (" with clearance" if has_play else "")
        relation = survey.relation(*pair)
        found.joint(JointEvidence(score, *pair, JointKind.PRISMATIC, axis, why, relation, review=REVIEW))


def _overlapping(survey: Survey, in_motor: Collection[int]) -> Iterator[Pair]:
    """Pairs of larger parts whose boxes overlap, and that nothing locks."""
    ids = [i for i, part in survey.parts.items() if i not in survey.small and i not in in_motor and part.size]
    counts = {i: len(survey.scene.columns(i, FaceKind.PLANE).faces) for i in ids}
    if any(count > _MOST_PLANES for count in counts.values()):
        survey.cut[f"parts with more than {_MOST_PLANES} plane faces were not tried as slides in others"] = None
    ids = [i for i in ids if 0 < counts[i] <= _MOST_PLANES]
    boxes = np.array([survey.parts[i].box for i in ids]).reshape(-1, 2, 3)
    for n, a in enumerate(ids):
        low, high = np.maximum(boxes[n, 0], boxes[n + 1 :, 0]), np.minimum(boxes[n, 1], boxes[n + 1 :, 1])
        for m in np.flatnonzero(((high - low) > _DEEP).all(axis=1)).tolist():
            pair = min(a, ids[n + 1 + m]), max(a, ids[n + 1 + m])
            relation = survey.relations.get(pair)
            if relation is None or not (relation.fits or relation.sockets or relation.is_rigid):
                yield pair


def _facing(planes: Planes, pair: Pair) -> Iterator[_Facing]:
    rows = [planes.of(part) for part in pair]
    one, two = rows
    normals, others = planes.normals[one], planes.normals[two]
    heights = (planes.points[one] * normals).sum(axis=1)
    gaps = planes.points[two] @ normals.T - heights[None]
    near = ((others @ normals.T) < -1.0 + 5e-7) & (gaps > -GAP) & (gaps < _CLEARANCE)
    for m, n in np.argwhere(near).tolist():
        patch = planes.patch(int(one[n]), int(two[m]))
        if patch is not None:
            yield _Facing(normals[n], float(gaps[m, n]), patch)


def _slide(facing: Sequence[_Facing], *, by_name: bool) -> tuple[Axis, bool] | None:
    """The one direction that is free between captured ones across, and whether any of these has clearance.

    With a name that says that it slides, faces on one side only are enough in one of the two directions across.
    """
    captured, resting = _captured(facing), [one.normal for one in facing]
    if len(captured) == 1 and by_name:
        u = captured[0].normal
        captured += [_Captured(n, captured[0].width, 0.0) for n in resting if abs(float(n @ u)) < _STRAIGHT][:1]
    if len(captured) != 2:
        return None
    one, two = captured
    along = cross(one.normal, two.normal)
    if float(np.linalg.norm(along)) < _SKEW:
        return None
    along = along / np.linalg.norm(along)
    if any(abs(float(normal @ along)) > _STRAIGHT for normal in resting):
        return None
    reach = np.concatenate([one.patch.hull for one in facing]) @ along
    if float(np.ptp(reach)) < _ENGAGED * min(one.width, two.width):
        return None
    return Axis(facing[0].patch.point, along), max(one.play, two.play) > 2.0 * GAP


def _captured(facing: Sequence[_Facing]) -> list[_Captured]:
    """The directions in which faces on both sides hold one part in the other."""
    found: list[_Captured] = []
    for n, one in enumerate(facing):
        for other in facing[n + 1 :]:
            opposite = are_parallel(one.normal, other.normal) and float(one.normal @ other.normal) < 0.0
            if opposite and not any(are_parallel(one.normal, known.normal) for known in found):
                width = abs(float((other.patch.point - one.patch.point) @ one.normal))
                found.append(_Captured(one.normal, width, one.gap + other.gap))
    return found


def _is_fastened(survey: Survey, pair: Pair) -> bool:
    """Whether a screw or the like is in both parts."""
    near = [{r.other(i) for r in survey.near.get(i, ()) if r.fits} & survey.small for i in pair]
    return bool(near[0] & near[1])
