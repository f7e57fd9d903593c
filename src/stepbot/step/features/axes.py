"""Axis lines of cylindrical and conical faces of components, about which joints can turn.

Faces on one line coincide within 0.01 mm and 1 mrad, at the position of the faces. A line, not a pair of faces, is the
unit of selection: an axis has many faces of several radii. Everything is in the frame of the assembly, W.

    faces = axis_faces(assembly, components)      rows of faces
    lines(faces)                                  the lines of one component or link
    mates(a, b)                                   the lines that two share, with the weight that decides between them
    choose(lines)                                 the selected line, or the ambiguous candidates
    line_frame(line)                              the joint frame on it
    selectors(lines)                              what to write to select each of them
"""

from collections.abc import Iterable, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array, Pose, Vector3, perpendicular_frame, vector3
from stepbot.robot.joint_table import Basis

from ..assembly import Assembly, Component
from .axis_contacts import Spans, meeting
from .coaxial import Indices, Rays, close_pairs, coaxial, gaps, signed

DISTANCE_TOLERANCE = 1e-5
"""Distance [m] up to which faces share a line, and radii are equal."""
ANGLE_TOLERANCE = 1e-3
"""Angle [rad] up to which faces share a line, and lines are parallel."""
NEAR_MISS_DISTANCE = 2e-3
"""Distance [m] up to which two lines that do not mate are reported."""
NEAR_MISS_ANGLE = 0.02
"""Angle [rad] up to which two lines that do not mate are reported."""
OUTWEIGHS = 2.0
"""Ratio of widths from which a line is selected over the next without a selector."""
_TIERS = {Basis.TOUCH: 1, Basis.APART: 2}
"""Bases that are weaker than the others."""


class AxisFaces(Struct, frozen=True, eq=False):
    """Cylindrical and conical faces in the frame of the assembly, one per row."""

    centers: Array
    """Shape (n, 3) [m]: the point of each axis in the middle of its face."""
    directions: Array
    """Shape (n, 3): unit directions of the axes; the sign has no meaning."""
    radii: Array
    """Shape (n,) [m]; of a cone, the larger one."""
    lengths: Array
    """Shape (n,) [m]: extent of each face along its axis."""
    cones: NDArray[np.bool_]
    """Shape (n,)."""
    bores: NDArray[np.bool_]
    """Shape (n,): whether material is outside."""
    components: Indices
    """Shape (n,): index of each face's component."""
    fineness: float = 1.0
    """Of the assembly: factor of the distances that decide."""

    def __len__(self) -> int:
        return len(self.radii)

    def select(self, rows: NDArray[np.bool_] | Indices) -> "AxisFaces":
        """Some of the faces, by mask (n,) or by indices."""
        return replace(self, **{name: getattr(self, name)[rows] for name in _COLUMNS})

    @property
    def rays(self) -> Rays:
        """The axes."""
        return Rays(self.centers, self.directions)


_COLUMNS = AxisFaces.__struct_fields__[:-1]


class LineFace(Struct, frozen=True):
    """A face on a line."""

    component: int
    radius: float
    """[m]."""
    bore: bool
    """Whether material is outside."""


class AxisLine(Struct, frozen=True):
    """A line with faces."""

    point: Vector3
    """Origin of a joint frame [m]: the middle of the extent; for a mate, between the shared faces of both sides."""
    direction: Vector3
    """Unit direction; of its (z, y, x) the first larger than 1e-6 is positive."""
    low: float
    """Start of the faces along ``direction`` from ``point`` [m]."""
    high: float
    """End of the faces along ``direction`` from ``point`` [m]."""
    radii: tuple[float, ...]
    """Distinct radii [m] of the faces, the widest first."""
    weight: float
    """Weight of the line [m]: the widest radius; for a mate, the smaller one of the two decisive faces."""
    components: tuple[int, ...]
    """Indices of the components with faces on it."""
    faces: tuple[LineFace, ...] = ()
    """The decisive faces: the widest; for a mate, one of each side."""
    basis: Basis = Basis.AXIS
    """How the two sides of a mate meet: fit, flange, touch or apart."""
    overlap: float | None = None
    """For a mate, length [m] along the line that both of ``faces`` cover; negative for a gap between them."""
    members: tuple[LineFace, ...] = ()
    """All different faces on it, the widest first."""

    @property
    def order(self) -> tuple[int, float]:
        """Sort key of lines: those on which a joint can turn first, then by weight."""
        return _TIERS.get(self.basis, 0), -self.weight

    def distance_to(self, point: Vector3) -> float:
        """Distance [m] of a point from the infinite line."""
        return float(_rays([self]).distances(np.array(point))[0])


class NearMiss(Struct, frozen=True):
    """Two lines that nearly coincide."""

    line_a: AxisLine
    line_b: AxisLine
    distance: float
    """Their distance [m] at the position of their faces."""
    angle: float
    """Angle between them [rad]."""

    @property
    def weight(self) -> float:
        """The weight of the mate [m]."""
        return min(self.line_a.weight, self.line_b.weight)


class Choice(Struct, frozen=True):
    """The selected line, or the ambiguous candidates."""

    line: AxisLine | None
    rivals: tuple[AxisLine, ...] = ()
    """The heaviest first; empty if there was no line, or one was selected."""


class Selector(Struct, frozen=True):
    """The selectors that an ``origin`` needs for one line among several; None for those not needed."""

    radius: float | None = None
    near: Vector3 | None = None

    def __str__(self) -> str:
        """As keys of a YAML flow mapping, each after a comma: ``, radius: 8 mm, near: [0 mm, 12.5 mm, 3 mm]``."""
        text = "" if self.radius is None else f", radius: {millimetres(self.radius)}"
        return text if self.near is None else f"{text}, near: [{', '.join(map(millimetres, self.near))}]"


def axis_faces(assembly: Assembly, components: Iterable[int]) -> AxisFaces:
    """The faces of these components, without those below them, in the frame of the assembly."""
    parts = [
        _faces_of(assembly, component)
        for index in components
        if (component := assembly.components[index]).body >= 0 and assembly.bodies[component.body].axis_faces
    ]
    return _joined(parts)


def lines(faces: AxisFaces, radius: float | None = None) -> tuple[AxisLine, ...]:
    """The lines with faces, the heaviest first; with ``radius`` [m], only faces of that radius count."""
    if radius is not None:
        faces = faces.select(np.abs(faces.radii - radius) <= faces.fineness * DISTANCE_TOLERANCE)
    result = [_line(faces, rows) for rows in coaxial(faces.rays, faces.fineness * DISTANCE_TOLERANCE, ANGLE_TOLERANCE)]
    return tuple(sorted(result, key=lambda line: -line.weight))


def mates(a: AxisFaces, b: AxisFaces, radius: float | None = None) -> tuple[AxisLine, ...]:
    """The lines with cylindrical faces of both sides, those with a fit first, then by weight.

    With ``radius`` [m], only lines with a cylinder of that radius.
    """
    a, b = a.select(~a.cones), b.select(~b.cones)
    faces = _joined([a, b])
    candidates, tolerance = [], faces.fineness * DISTANCE_TOLERANCE
    for rows in coaxial(faces.rays, tolerance, ANGLE_TOLERANCE):
        rows_a, rows_b = rows[rows < len(a)], rows[rows >= len(a)]
        if len(rows_a) and len(rows_b):
            line = _mate(faces, rows_a, rows_b)
            if radius is None or np.abs(np.array(line.radii) - radius).min() <= tolerance:
                candidates.append(line)
    return tuple(sorted(candidates, key=lambda line: line.order))


def near_misses(a: AxisFaces, b: AxisFaces) -> tuple[NearMiss, ...]:
    """Pairs of lines with cylindrical faces, one of each side, at most 2 mm apart; the heaviest first.

    Lines that mate with another one are left out.
    """
    lines_a, lines_b = lines(a.select(~a.cones)), lines(b.select(~b.cones))
    if not lines_a or not lines_b:
        return ()
    rays_a, rays_b = _rays(lines_a), _rays(lines_b)
    i, j = close_pairs(rays_a, rays_b, a.fineness * NEAR_MISS_DISTANCE, NEAR_MISS_ANGLE)
    distances = gaps(rays_a.rows(i), rays_b.rows(j))
    angles = np.linalg.norm(np.cross(rays_a.directions[i], rays_b.directions[j]), axis=1)
    mated = (distances <= a.fineness * DISTANCE_TOLERANCE) & (angles <= ANGLE_TOLERANCE)
    missed = ~(np.isin(i, i[mated]) | np.isin(j, j[mated]))
    misses = [
        NearMiss(lines_a[row_a], lines_b[row_b], distance, angle)
        for row_a, row_b, distance, angle in zip(*(x[missed].tolist() for x in (i, j, distances, angles)), strict=True)
    ]
    return tuple(sorted(misses, key=lambda miss: (-miss.weight, miss.distance)))


def choose(
    lines: Sequence[AxisLine], near: Vector3 | None = None, *, direction_only: bool = False, selected: bool = False
) -> Choice:
    """The line nearest to ``near`` [m], if given; otherwise the only one, or one twice as heavy as the next.

    Lines with a fit, or with bores that meet, take precedence over those whose faces merely touch; if the former are
    ambiguous, one of the latter may be twice as heavy as all. Faces apart from each other are used only if selected.

    Args:
        near: A point [m] of the assembly.
        direction_only: Whether parallel lines are equivalent; the strongest of them is used.
        selected: Whether ``lines`` were already selected by a radius.
    """
    candidates = sorted(lines, key=lambda line: line.order)
    if near is not None and candidates:
        distances = [line.distance_to(near) for line in candidates]
        limit = min(distances) + DISTANCE_TOLERANCE
        candidates = [line for line, distance in zip(candidates, distances, strict=True) if distance <= limit]
    rivals: list[AxisLine] = []
    for tier in range(3 if selected or near is not None else 2):
        rivals = _rivals([line for line in candidates if line.order[0] <= tier], direction_only)
        by_weight = sorted(rivals, key=lambda line: -line.weight)
        if len(rivals) == 1 or (rivals and by_weight[0].weight >= OUTWEIGHS * by_weight[1].weight * (1 - 1e-9)):
            return Choice(by_weight[0])
    return Choice(None, tuple(rivals or _rivals(candidates, direction_only)))


def _rivals(candidates: Sequence[AxisLine], direction_only: bool) -> list[AxisLine]:
    """The candidate lines; of parallel ones the first, if only directions count."""
    rivals: list[AxisLine] = []
    for line in candidates:
        if not direction_only or not any(is_parallel(line, rival) for rival in rivals):
            rivals.append(line)
    return rivals


def line_frame(line: AxisLine) -> Pose:
    """X_WF of the joint frame on a line: z along it, x as close as possible to the assembly's x."""
    return Pose.of(perpendicular_frame(line.direction), line.point)


def selectors(lines: Sequence[AxisLine]) -> tuple[Selector, ...]:
    """For each line, the selectors with which :func:`choose` selects it: none, a unique radius, or a point."""
    chosen = choose(lines).line
    return tuple(Selector() if line is chosen else selector(line, lines) for line in lines)


def selector(line: AxisLine, lines: Sequence[AxisLine]) -> Selector:
    """Explicit selectors of a line among all: a unique radius, or a point."""
    radii = np.array([radius for other in lines for radius in other.radii])
    alone = [r for r in line.radii if np.count_nonzero(np.abs(radii - _rounded(r)) <= 2 * DISTANCE_TOLERANCE) == 1]
    return Selector(radius=_rounded(alone[0])) if alone else Selector(near=_distinguishing_point(line, _rays(lines)))


def millimetres(length: float) -> str:
    """A length [m] as text in mm, to the micrometre."""
    return f"{round(length * 1e3, 3) + 0.0:.10g} mm"


def _rounded(length: float) -> float:
    """A length [m] rounded as by :func:`millimetres`."""
    return round(length * 1e3, 3) / 1e3


def _distinguishing_point(line: AxisLine, rays: Rays) -> Vector3:
    """A point of the line, to the micrometre, that is close to no other line: its middle, or one of its ends."""
    candidates = [np.array(line.point) + t * np.array(line.direction) for t in (0.0, line.low, line.high)]
    clearances = []
    for point in candidates:
        distances = rays.distances(point)
        clearances.append(float(np.partition(distances, 1)[1]) if len(distances) > 1 else np.inf)
        if clearances[-1] > 3 * DISTANCE_TOLERANCE:
            break
    x, y, z = (_rounded(c) for c in candidates[int(np.argmax(clearances))].tolist())
    return (x, y, z)


def _rays(lines: Sequence[AxisLine]) -> Rays:
    points, directions = [line.point for line in lines], [line.direction for line in lines]
    return Rays(np.array(points).reshape(-1, 3), np.array(directions).reshape(-1, 3))


def is_parallel(a: AxisLine, b: AxisLine) -> bool:
    """Whether two lines are parallel or antiparallel."""
    return float(np.linalg.norm(np.cross(a.direction, b.direction))) <= ANGLE_TOLERANCE


def _faces_of(assembly: Assembly, component: Component) -> AxisFaces:
    faces, X_WC = assembly.bodies[component.body].axis_faces, component.X_WC
    points = np.array([face.point for face in faces])
    directions = np.array([face.direction for face in faces])
    low, high = np.array([face.low for face in faces]), np.array([face.high for face in faces])
    return AxisFaces(
        X_WC.apply(points + directions * (0.5 * (low + high))[:, None]),
        X_WC.turn(directions),
        np.array([face.radius for face in faces]),
        np.abs(high - low),
        np.array([face.cone for face in faces]),
        np.array([face.bore for face in faces]),
        np.full(len(faces), component.index, dtype=np.intp),
        assembly.fineness,
    )


def _joined(parts: Sequence[AxisFaces]) -> AxisFaces:
    if not parts:
        nothing = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0)
        return AxisFaces(*nothing, np.zeros(0, dtype=bool), np.zeros(0, dtype=bool), np.zeros(0, dtype=np.intp))
    columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _COLUMNS}
    return AxisFaces(**columns, fineness=min(part.fineness for part in parts))


def _line(faces: AxisFaces, rows: Indices) -> AxisLine:
    center, direction = _carrier(faces, rows)
    low, high = _extent(faces, rows, center, direction)
    line = _axis_line(faces, rows, center, direction, 0.5 * (low + high), float(faces.radii[rows].max()))
    return replace(line, faces=(_line_face(faces, _widest(faces, rows)),))


def _mate(faces: AxisFaces, rows_a: Indices, rows_b: Indices) -> AxisLine:
    rows = np.concatenate([rows_a, rows_b])
    center, direction = _carrier(faces, rows)
    (low_a, high_a), (low_b, high_b) = (_extent(faces, side, center, direction) for side in (rows_a, rows_b))
    middle = 0.5 * (max(low_a, low_b) + min(high_a, high_b))
    a, b = (_spans(faces, side, center, direction) for side in (rows_a, rows_b))
    met = meeting(a, b, faces.fineness)
    sides = _line_face(faces, rows_a[met.rows[0]]), _line_face(faces, rows_b[met.rows[1]])
    weight = min(side.radius for side in sides)
    line = _axis_line(faces, rows, center, direction, middle, weight)
    return replace(line, faces=sides, basis=met.basis, overlap=met.overlap)


def _line_face(faces: AxisFaces, row: int) -> LineFace:
    return LineFace(int(faces.components[row]), float(faces.radii[row]), bool(faces.bores[row]))


def _spans(faces: AxisFaces, rows: Indices, point: Array, direction: Array) -> Spans:
    along = (faces.centers[rows] - point) @ direction
    half = 0.5 * faces.lengths[rows]
    return Spans(along - half, along + half, faces.radii[rows], faces.bores[rows])


def _axis_line(faces: AxisFaces, rows: Indices, center: Array, direction: Array, t: float, weight: float) -> AxisLine:
    """The line through ``center``, with its point ``t`` [m] further along."""
    point = center + t * direction
    low, high = _extent(faces, rows, point, direction)
    radii: list[float] = []
    for radius in sorted(faces.radii[rows].tolist(), reverse=True):
        if not radii or radii[-1] - radius > faces.fineness * DISTANCE_TOLERANCE:
            radii.append(radius)
    components = tuple(dict.fromkeys(faces.components[rows].tolist()))
    members = tuple(
        dict.fromkeys(_line_face(faces, row) for row in sorted(rows.tolist(), key=lambda r: -faces.radii[r]))
    )
    return AxisLine(vector3(point), vector3(direction), low, high, tuple(radii), weight, components, members=members)


def _carrier(faces: AxisFaces, rows: Indices) -> tuple[Array, Array]:
    """Centre and signed direction of the representative face of a line."""
    row = _widest(faces, rows)
    return faces.centers[row], signed(faces.directions[row : row + 1])[0]


def _widest(faces: AxisFaces, rows: Indices) -> int:
    """The representative face of a line: the widest, then the longest, then the first."""
    return int(min(rows.tolist(), key=lambda r: (-faces.radii[r], -faces.lengths[r], r)))


def _extent(faces: AxisFaces, rows: Indices, point: Array, direction: Array) -> tuple[float, float]:
    spans = _spans(faces, rows, point, direction)
    return float(spans.low.min()), float(spans.high.max())
