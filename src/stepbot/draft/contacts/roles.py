"""The parts of an assembly with the roles that their names and shapes indicate.

By shape: fasteners (small, turned about one line, with a head and a drive recess, and nuts), and rolling bearings, by
their boundary dimensions: a ring of exactly these is hardly ever anything else.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from itertools import combinations

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.contacts import CoaxialLine, Contacts, LineFace
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.contacts.teeth import teeth_of
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role, is_spoken, roles
from stepbot.draft.parts.parts import Part
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.spatial import cross, perpendicular_frame, turn_inertia
from stepbot.step.assembly import Component
from stepbot.step.faces import Face, FaceKind


def read_parts(scene: Scene, contacts: Contacts, *, use_names: bool) -> dict[int, Part]:
    """All parts by the index of their component."""
    lines_of: dict[int, list[int]] = defaultdict(list)
    for number, line in enumerate(contacts.lines):
        for index in line.faces:
            lines_of[index].append(number)
    parts = {}
    for index in scene.parts:
        part = _part(scene, index, use_names=use_names)
        lines = [contacts.lines[n] for n in lines_of[index]]
        rings = _rings(part, lines) if part.role is None else frozenset()
        if rings & _DIMENSIONS:
            part = replace(part, role=Role.BEARING)
        elif rings & _LINEAR:
            part = replace(part, role=Role.BEARING, is_linear=True)
        elif part.role is None and is_screw(part, lines, scene.body(index).faces):
            # The flanks of a pinion are at the angles of a nut's sides.
            role = None if scene.of_definition(index, teeth_of).rims else Role.FASTENER
            part = replace(part, role=role)
        parts[index] = part
    return parts


def _part(scene: Scene, index: int, *, use_names: bool) -> Part:
    component, body = scene.component(index), scene.body(index)
    names = spoken_names(component)
    if not names and component.parent >= 0:
        names = spoken_names(scene.component(component.parent))
    own_roles = tuple(dict.fromkeys(role for name in names for role in roles(name))) if use_names else ()
    box = scene.boxes.get(index, np.zeros((2, 3)))
    volume, com, inertia = 0.0, box.mean(axis=0), np.eye(3)
    if body.exact is not None:
        X, unit = component.X_WC, body.exact.unit_density
        volume, com = body.exact.volume, X.apply(unit.com)
        inertia = np.asarray(turn_inertia(X.R, np.array(unit.inertia)))
    size = float(np.linalg.norm(scene.extent(index)))
    name = names[0] if names else ""
    return Part(
        *(index, component.path, name, own_roles, next(iter(own_roles), None), component.definition),
        *(volume, size, box, com, inertia),
    )


def spoken_names(component: Component) -> list[str]:
    """The meaningful names of a component."""
    return [name for name in (component.product, component.occurrence) if is_spoken(name)]


_MOST_VOLUME, _LONGEST = 8e-6, 0.1
"""[m^3], [m]: an M16 of 100 mm."""
_HEAD = (1.25, 3.0)
"""Ratio of the radii of head and shank."""
_NUT = 12.0
"""Maximum ratio of a nut's size to the radius of its bore."""
_FLANGE, _BESIDE = 0.9, 1e-6
"""Share of the largest radius from which a face is one of two flanges; overlap [m] of faces beside each other."""
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
    # A part with holes elsewhere, such as in a flange around its hub, has other parts fastened to it.
    inside = min([0.95 * widest, *_shanks(own)[:1]])
    if any(line.axis.distance(other.axis.point) > inside for other, _ in full if other is not line):
        return False
    return part.is_balanced(line.axis) and (
        _has_head_and_drive(own, len({id(at) for at, _ in full}), faces) or _is_nut(part, own, faces)
    )


def _has_head_and_drive(own: Sequence[LineFace], lines: int, faces: Sequence[Face]) -> bool:
    outer = _shanks(own)
    length = max(face.high for face in own) - min(face.low for face in own)
    drive = _most_flats(faces) >= _HEXAGON - 1 or lines >= 3 or (any(face.bore for face in own) and not _is_spool(own))
    return _has_head(outer) and drive and length > outer[-1]


def _is_spool(own: Sequence[LineFace]) -> bool:
    """Whether a narrower face is between two of the largest radius: a spool, a pulley, a bobbin."""
    outside = [face for face in own if not face.bore]
    widest = max((face.radius for face in outside), default=0.0)
    flanges = [face for face in outside if face.radius > _FLANGE * widest]
    return any(
        face not in flanges
        and any(flange.high < face.low + _BESIDE for flange in flanges)
        and any(face.high < flange.low + _BESIDE for flange in flanges)
        for face in outside
    )


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


_BAND, _LOOP, _SAME_BAND, _AROUND = 0.35, 5e-4, 1e-5, 6.0
"""Thickness of a belt in radii of what it runs around, at most; distances [m] up to which it lies on it, and is equally
thick and wide everywhere; angle [rad] from which a face is around it.
"""
_TEETH = 0.15
"""Share of the radius up to which teeth reach into a belt or a track, or end before it."""


def find_loops(
    scene: Scene, parts: Mapping[int, Part], lines: Sequence[CoaxialLine], named: Collection[int]
) -> dict[int, dict[int, Axis]]:
    """What belts run around, by belt: those named so, and bands around two or more turned bodies on parallel lines."""
    loops: dict[int, dict[int, Axis]] = {i: {} for i in named}
    bands: dict[int, list[tuple[Axis, float, float]]] = defaultdict(list)
    full: set[int] = set()
    for line in lines:
        for i, faces in line.faces.items():
            arcs = [face for face in faces if not face.cone]
            if any(face.span > _AROUND for face in faces):
                full.add(i)
                continue
            band = _band(arcs)
            arcs = arcs if i in named else [arc for arc in arcs if arc.bore and band]
            around = {
                other for other in line.faces for arc in arcs if other != i and _fills(scene, parts, line, other, arc)
            }
            if around:
                loops.setdefault(i, {}).update(dict.fromkeys(sorted(around), line.axis))
            if around and band:
                bands[i].append((line.axis, *band))
    for i, wound in bands.items():
        axis, thick, wide = wound[0]
        is_even = all(
            axis.is_along(other.d) and max(abs(thickness - thick), abs(width - wide)) < _SAME_BAND
            for other, thickness, width in wound[1:]
        )
        if i not in named and (i in full or len(wound) < 2 or not is_even or parts[i].role is not None):
            del loops[i]
    return dict(sorted(loops.items()))


def _band(arcs: Sequence[LineFace]) -> tuple[float, float] | None:
    """Thickness and width [m] of a thin band around a line; None for others."""
    inside, outside = ([arc for arc in arcs if arc.bore == bore] for bore in (True, False))
    if len(inside) != 1 or len(outside) != 1:
        return None
    (bore,), (back,) = inside, outside
    thickness, width = back.radius - bore.radius, bore.high - bore.low
    is_band = 0.0 < thickness < _BAND * bore.radius and abs(back.high - back.low - width) <= _SAME_BAND
    return (thickness, width) if is_band else None


def _fills(scene: Scene, parts: Mapping[int, Part], line: CoaxialLine, other: int, arc: LineFace) -> bool:
    """Whether a turned body fills an arc on its line: with a round face, or with its teeth."""
    if not parts[other].is_balanced(line.axis):
        return False
    beside = [f for f in line.faces[other] if min(f.high, arc.high) > max(f.low, arc.low)]
    if any(not f.bore and abs(f.radius - arc.radius) < _LOOP for f in beside):
        return True
    across = perpendicular_frame(line.axis.d)[:, 0]
    reach = 0.5 * float(np.ptp(scene.span(other, across)))
    return bool(beside) and abs(reach - arc.radius) < _TEETH * arc.radius


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


_LINEAR = frozenset({
    (3, 7, 10), (4, 8, 12), (5, 10, 15), (6, 12, 19), (6, 12, 35), (8, 15, 17), (8, 15, 24), (8, 15, 45), (8, 16, 25),
    (10, 19, 29), (10, 19, 55), (12, 21, 30), (12, 21, 57), (12, 22, 32), (13, 23, 32), (13, 23, 61), (16, 26, 36),
    (16, 28, 37), (16, 28, 70), (20, 32, 42), (20, 32, 45), (20, 32, 80), (25, 40, 58), (25, 40, 59), (25, 40, 112),
    (30, 45, 64), (30, 45, 123),
})  # fmt: skip
"""Bore, outside diameter and length [mm] of linear bearings: balls (LM8UU, LM8LUU) and polymer (RJM)."""


def _rings(part: Part, lines: Sequence[CoaxialLine]) -> frozenset[tuple[float, float, float]]:
    """Bore, outside diameter and width [mm] of a turned ring; a flange may add to its outside diameters."""
    rings = set()
    for line in lines:
        faces = [face for face in line.faces[part.index] if face.span > HALF_ROUND and not face.cone]
        bores = {_diameter(face.radius) for face in faces if face.bore}
        outside = {_diameter(face.radius) for face in faces if not face.bore}
        if bores and outside and part.is_balanced(line.axis):
            width = _extent(part, line)
            rings |= {(min(bores), diameter, width) for diameter in outside}
    return frozenset(rings)


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
