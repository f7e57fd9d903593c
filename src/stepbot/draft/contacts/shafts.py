"""Finds coaxial cylinders of different parts, and how they meet; and balls in sockets.

Lines are found by sorting (``step.features.coaxial``); on a line only parts that overlap or nearly do are compared.
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.contacts import CoaxialLine, Contacts, Fit, FitKind, LineFace, Socket
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.scene import PlacedFace, Scene
from stepbot.geometry.spatial import Array
from stepbot.step.faces import Face, FaceKind
from stepbot.step.features.axes import ANGLE_TOLERANCE, DISTANCE_TOLERANCE
from stepbot.step.features.axis_contacts import BESIDE, LOOSEST, SLACK_SHARE, fits
from stepbot.step.features.coaxial import Rays, coaxial, signed

HALF_ROUND = 3.2
"""Angle [rad] above which a face covers more than half of the circumference."""

HOLE_RATIO = 2.5
"""Ratio of the radii of two coaxial holes up to which one screw could be in both."""
_FLUSH_GAP = 5e-4
_NEAR = 3e-3
"""Gap [m] along a line up to which two parts are compared."""
_EQUAL = 1e-7


def find_fits(scene: Scene, contacts: Contacts) -> None:
    """Add all lines, and the fits on them, to the contacts."""
    columns = [(part, scene.columns(part, kind)) for kind in (FaceKind.CYLINDER, FaceKind.CONE) for part in scene.parts]
    faces = [(part, face) for part, column in columns for face in column.faces]
    if not faces:
        return
    rays = Rays(
        *(np.concatenate([getattr(column, name) for _, column in columns]) for name in ("points", "directions"))
    )
    for group in coaxial(rays, DISTANCE_TOLERANCE, ANGLE_TOLERANCE):
        line = _line([faces[i] for i in group.tolist()], rays.rows(group))
        contacts.lines.append(line)
        for a, b in neighbours_on(line):
            contacts.fits[a, b] += _pair_fits(line, a, b)
    for pair in [pair for pair, pair_fits in contacts.fits.items() if not pair_fits]:
        del contacts.fits[pair]


def _line(rows: Sequence[tuple[int, Face]], rays: Rays) -> CoaxialLine:
    """The line through the widest of some faces of parts, with their rays."""
    faces = [face for _, face in rows]
    best = max(range(len(faces)), key=lambda k: (faces[k].kind == FaceKind.CYLINDER, faces[k].radius))
    axis = Axis(rays.centers[best], signed(rays.directions[best : best + 1])[0])
    by_part: dict[int, list[LineFace]] = defaultdict(list)
    for (part, face), along in zip(rows, ((rays.centers - axis.point) @ axis.d).tolist(), strict=True):
        low, high = along - 0.5 * face.length, along + 0.5 * face.length
        by_part[part].append(LineFace(face.radius, low, high, face.bore, face.span, face.kind == FaceKind.CONE))
    return CoaxialLine(axis, {part: _joined(faces) for part, faces in sorted(by_part.items())})


def _joined(faces: list[LineFace]) -> tuple[LineFace, ...]:
    """Faces of one part on one line; halves of one cylinder, and pieces end to end, are merged."""
    joined: list[LineFace] = []
    for face in sorted(faces, key=lambda f: (f.cone, f.bore, round(f.radius, 8), f.low, f.high)):
        for n, other in enumerate(joined):
            same = (other.cone, other.bore) == (face.cone, face.bore) and abs(other.radius - face.radius) < _EQUAL
            if same and face.low <= other.high + _EQUAL and other.low <= face.high + _EQUAL:
                low, high = min(other.low, face.low), max(other.high, face.high)
                joined[n] = LineFace(other.radius, low, high, other.bore, other.span + face.span, other.cone)
                break
        else:
            joined.append(face)
    return tuple(joined)


def neighbours_on(line: CoaxialLine) -> list[tuple[int, int]]:
    """Pairs of parts whose faces on the line overlap or nearly do."""
    spans = sorted((min(f.low for f in faces), max(f.high for f in faces), part) for part, faces in line.faces.items())
    pairs = set()
    active: list[tuple[float, int]] = []
    for low, high, part in spans:
        active = [(end, other) for end, other in active if end >= low - _NEAR]
        pairs |= {(min(part, other), max(part, other)) for _, other in active}
        active.append((high, part))
    return sorted(pairs)


def _pair_fits(line: CoaxialLine, a: int, b: int) -> list[Fit]:
    """The strongest fit of each kind."""
    best: dict[FitKind, Fit] = {}
    inside: list[tuple[float, float]] = []
    for face_a in line.faces[a]:
        for face_b in line.faces[b]:
            fit = None if face_a.cone or face_b.cone else _fit(line.axis, a, b, face_a, face_b)
            if fit is not None and (fit.kind not in best or _rank(fit) > _rank(best[fit.kind])):
                best[fit.kind] = fit
            if fit is not None and fit.kind == FitKind.SHAFT and fit.full:
                inside.append((max(face_a.low, face_b.low), min(face_a.high, face_b.high)))
    if inside and FitKind.SHAFT in best:
        guided = max(high for _, high in inside) - min(low for low, _ in inside)
        best[FitKind.SHAFT] = replace(best[FitKind.SHAFT], guided=guided)
    return [best[kind] for kind in sorted(best)]


def _fit(axis: Axis, a: int, b: int, face_a: LineFace, face_b: LineFace) -> Fit | None:
    low, high = max(face_a.low, face_b.low), min(face_a.high, face_b.high)
    kind, shaft, full = FitKind.FLUSH, -1, face_a.span > HALF_ROUND and face_b.span > HALF_ROUND
    travel = 0.0
    if face_a.bore != face_b.bore:
        kind, (bore, thin) = FitKind.SHAFT, (face_a, face_b) if face_a.bore else (face_b, face_a)
        if not fits(bore.radius, thin.radius, high - low):
            return None
        shaft = b if face_a.bore else a
        if bore.low - _EQUAL <= thin.low and thin.high <= bore.high + _EQUAL:
            travel = (bore.high - bore.low) - (thin.high - thin.low)
    elif face_a.bore:
        kind = FitKind.HOLES
        if not full or low - high >= BESIDE:
            return None
        if not 1.0 / HOLE_RATIO < face_a.radius / face_b.radius < HOLE_RATIO:
            return None
    elif abs(face_a.radius - face_b.radius) >= DISTANCE_TOLERANCE or abs(low - high) >= _FLUSH_GAP:
        return None
    at = Axis(axis.point + axis.d * (0.5 * (low + high)), axis.d)
    length = high - low if kind == FitKind.SHAFT else low - high
    return Fit(a, b, kind, at, face_a.radius, face_b.radius, length, shaft, full, travel=travel)


def _rank(fit: Fit) -> tuple[float, ...]:
    if fit.kind == FitKind.SHAFT:
        return (fit.full, -round(fit.clearance, 6), fit.length)
    return (-max(0.0, fit.length), -fit.clearance, fit.radius)


_CELL = 1e-4
"""Size [m] of the cells that centres are sorted into."""
_CENTRES = 2e-5
"""Distance [m] up to which centres are equal."""
_NEIGHBOURS = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]


def find_sockets(scene: Scene, contacts: Contacts) -> None:
    """Add all balls in sockets to the contacts, each pair of parts and centre once."""
    cells: dict[tuple[int, ...], list[PlacedFace]] = defaultdict(list)
    spheres = scene.faces(FaceKind.SPHERE)
    for row in spheres:
        cells[_cell(row.point)].append(row)
    for ball in (row for row in spheres if not row.face.bore):
        x, y, z = _cell(ball.point)
        for dx, dy, dz in _NEIGHBOURS:
            for socket in cells.get((x + dx, y + dy, z + dz), ()):
                if socket.face.bore and socket.part != ball.part and _holds(ball, socket):
                    a, b = sorted((ball.part, socket.part))
                    known = contacts.sockets[a, b]
                    if not any(np.linalg.norm(s.point - ball.point) < _CENTRES for s in known):
                        known.append(Socket(a, b, ball.point, ball.face.radius))


def _holds(ball: PlacedFace, socket: PlacedFace) -> bool:
    radii = ball.face.radius, socket.face.radius
    slack = max(LOOSEST, SLACK_SHARE * max(radii))
    return float(np.linalg.norm(ball.point - socket.point)) <= _CENTRES and abs(radii[0] - radii[1]) <= slack


def _cell(point: Array) -> tuple[int, ...]:
    return tuple(np.floor(point / _CELL).astype(int).tolist())
