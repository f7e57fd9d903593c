"""Rolling bearings by their boundary dimensions: a ring of exactly these is hardly ever anything else.

Bore, outside diameter and width [mm] of radial ball bearings, by ISO 15 (series 17 to 19, 0, 2 and 3) and, below 10 mm,
of the miniature series that makers share, open and shielded.
"""

from collections.abc import Sequence

from .contacts import CoaxialLine
from .fits import HALF_ROUND
from .part import Part

_SIZES = {
    # Bore: (outside diameter, width), ...
    2: ((5, 1.5), (5, 2.3), (5, 2.5), (6, 2.3), (6, 3), (7, 2.8), (7, 3.5)),
    3: ((6, 2), (6, 2.5), (7, 2), (7, 3), (8, 2.5), (8, 3), (8, 4), (9, 3), (9, 5), (10, 4)),
    4: ((7, 2), (7, 2.5), (8, 2), (8, 3), (9, 2.5), (9, 4), (10, 3), (10, 4), (11, 4), (12, 4), (13, 5), (16, 5)),
    5: ((8, 2), (8, 2.5), (9, 2.5), (9, 3), (10, 3), (10, 4), (11, 3), (11, 4), (11, 5), (13, 4), (14, 5), (16, 5),
        (19, 6)),
    6: ((10, 2.5), (10, 3), (12, 3), (12, 4), (13, 3.5), (13, 5), (15, 5), (17, 6), (19, 6)),
    7: ((11, 2.5), (11, 3), (13, 3), (13, 4), (14, 3.5), (14, 5), (17, 5), (19, 6), (22, 7)),
    8: ((12, 2.5), (12, 3.5), (14, 3.5), (14, 4), (16, 4), (16, 5), (16, 6), (19, 6), (22, 7), (24, 8)),
    9: ((17, 4), (17, 5), (20, 6), (24, 7), (26, 8)),
    10: ((15, 3), (15, 4), (19, 5), (19, 6), (19, 7), (22, 6), (26, 8), (30, 9), (35, 11)),
    12: ((18, 4), (21, 5), (21, 7), (24, 6), (28, 8), (32, 10), (37, 12)),
    15: ((21, 4), (24, 5), (24, 7), (28, 7), (32, 9), (35, 11), (42, 13)),
    17: ((23, 4), (26, 5), (26, 7), (30, 7), (35, 10), (40, 12), (47, 14)),
    20: ((27, 4), (32, 7), (37, 9), (42, 12), (47, 14), (52, 15)),
    25: ((32, 4), (37, 7), (42, 9), (47, 12), (52, 15), (62, 17)),
    30: ((37, 4), (42, 7), (47, 9), (55, 13), (62, 16), (72, 19)),
    35: ((44, 5), (47, 7), (55, 10), (62, 14), (72, 17), (80, 21)),
    40: ((50, 6), (52, 7), (62, 12), (68, 15), (80, 18), (90, 23)),
    45: ((55, 6), (58, 7), (68, 12), (75, 16), (85, 19), (100, 25)),
    50: ((62, 6), (65, 7), (72, 12), (80, 16), (90, 20), (110, 27)),
    55: ((72, 9), (80, 13), (90, 18)),
    60: ((78, 10), (85, 13), (95, 18)),
    65: ((85, 10), (90, 13), (100, 18)),
    70: ((90, 10), (100, 16), (110, 20)),
    75: ((95, 10), (105, 16)),
    80: ((100, 10), (110, 16)),
    85: ((110, 13), (120, 18)),
    90: ((115, 13), (125, 18)),
    95: ((120, 13), (130, 18)),
    100: ((125, 13), (140, 20)),
}  # fmt: skip
_DIMENSIONS = {(bore, outside, width) for bore, rings in _SIZES.items() for outside, width in rings}
_DIGITS = 2
"""Decimals [mm] to which dimensions agree."""


def is_bearing(part: Part, lines: Sequence[CoaxialLine]) -> bool:
    """Whether a part is a ring with the dimensions of a bearing; a flange on the outer ring may add to them."""
    for line in lines:
        faces = [face for face in line.faces[part.index] if face.span > HALF_ROUND and not face.cone]
        bores = {_diameter(face.radius) for face in faces if face.bore}
        outside = {_diameter(face.radius) for face in faces if not face.bore}
        if not bores or not outside or not part.is_balanced(line.axis):
            continue
        width = _extent(part, line)
        if any((min(bores), diameter, width) in _DIMENSIONS for diameter in outside):
            return True
    return False


def _extent(part: Part, line: CoaxialLine) -> float:
    """Width [mm] of a turned part whose axis is ``line``'s, from the bounding boxes of part and line."""
    d = abs(line.axis.d)
    if d.max() > 1.0 - 1e-6:
        low, high = part.box
        return round(1e3 * float((high - low) @ d), _DIGITS)
    faces = line.faces[part.index]
    return round(1e3 * (max(face.high for face in faces) - min(face.low for face in faces)), _DIGITS)


def _diameter(radius: float) -> float:
    return round(2e3 * radius, _DIGITS)
