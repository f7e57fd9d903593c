"""Fasteners by shape: small, turned about one line, with a head and a drive recess; and nuts."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from stepbot.geometry.spatial import cross
from stepbot.step.faces import Face, FaceKind

from .contacts import CoaxialLine, LineFace
from .fits import HALF_ROUND
from .part import Part

_MOST_VOLUME, _LONGEST = 8e-6, 0.1
"""[m^3], [m]: an M16 of 100 mm."""
_HEAD = (1.25, 3.0)
"""Ratio of the radii of head and shank."""
_NUT = 12.0
"""Maximum ratio of a nut's size to the radius of its bore."""
_HEXAGON = 6
_SIXTY_DEGREES = 2e-3
_ACROSS = 1e-3


def is_screw(part: Part, lines: Sequence[CoaxialLine], faces: Sequence[Face]) -> bool:
    """Whether a part is a screw, a nut, or a plain pin with a head, by its faces."""
    if not 0.0 < part.volume < _MOST_VOLUME or part.size > _LONGEST:
        return False
    full = [
        (line, face) for line in lines for face in line.faces[part.index] if face.span > HALF_ROUND and not face.cone
    ]
    if not full:
        return False
    line = max(full, key=lambda row: (not row[1].bore, row[1].radius))[0]
    own = [face for other, face in full if other is line]
    widest = max(face.radius for face in own)
    # A part with holes elsewhere has other parts fastened to it.
    if any(line.axis.distance(other.axis.point) > 0.95 * widest for other, _ in full if other is not line):
        return False
    return part.is_balanced(line.axis) and (
        _has_head_and_drive(own, len({id(at) for at, _ in full}), faces) or _is_nut(part, own, faces)
    )


def _has_head_and_drive(own: Sequence[LineFace], lines: int, faces: Sequence[Face]) -> bool:
    outer = _shanks(own)
    length = max(face.high for face in own) - min(face.low for face in own)
    drive = _most_flats(faces) >= _HEXAGON - 1 or lines >= 3 or any(face.bore for face in own)
    return _has_head(outer) and drive and length > outer[-1]


def _is_nut(part: Part, own: Sequence[LineFace], faces: Sequence[Face]) -> bool:
    bores = [face.radius for face in own if face.bore]
    if not bores or _has_head(_shanks(own)) or part.size >= _NUT * min(bores):
        return False
    return _most_flats(faces) >= _HEXAGON


def _shanks(own: Sequence[LineFace]) -> list[float]:
    return sorted({round(face.radius, 5) for face in own if not face.bore})


def _has_head(outer: Sequence[float]) -> bool:
    return len(outer) >= 2 and _HEAD[0] * outer[0] < outer[-1] < _HEAD[1] * outer[0]


def _most_flats(faces: Sequence[Face]) -> int:
    """Maximum number of planes along one direction at angles of 60 degrees to each other; counted to six."""
    normals = np.array([face.direction for face in faces if face.kind == FaceKind.PLANE]).reshape(-1, 3)
    best = 0
    for i, j in combinations(range(len(normals)), 2):
        if abs(abs(float(normals[i] @ normals[j])) - 0.5) < _SIXTY_DEGREES:
            along = cross(normals[i], normals[j])
            best = max(best, int((np.abs(normals @ (along / np.linalg.norm(along))) < _ACROSS).sum()))
            if best >= _HEXAGON:
                break
    return best
