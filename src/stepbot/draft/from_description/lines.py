"""Lines of the assembly on which described joints may lie, and poses that align pairs of lines."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from stepbot.draft.parts.axis import PARALLEL, Axis, are_parallel
from stepbot.geometry.fixed_point import distinct_rows
from stepbot.geometry.spatial import Array, Pose, cross, perpendicular_frame, rotation_about
from stepbot.step.assembly import Assembly

ON_LINE = 5e-5
"""Distance [m] up to which a described axis coincides with one of the assembly's."""
_SIGNS = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))


class Lines:
    """The axes of all cylinders and cones of an assembly, with their components."""

    def __init__(self, assembly: Assembly) -> None:
        owners, points, directions = [], [], []
        for component in assembly.components:
            faces = assembly.bodies[component.body].axis_faces if component.body >= 0 else ()
            if faces:
                owners += [component.index] * len(faces)
                points.append(component.X_WC.apply(np.array([face.point for face in faces])))
                directions.append(component.X_WC.turn(np.array([face.direction for face in faces])))
        self._owners = owners
        self._points = np.concatenate(points or [np.zeros((0, 3))])
        self._directions = np.concatenate(directions or [np.zeros((0, 3))])
        # Indices of distinct lines, by the foot points from the origin.
        feet = self._points - np.einsum("ij,ij->i", self._points, self._directions)[:, None] * self._directions
        signs = np.sign(self._directions[np.arange(len(self._directions)), np.argmax(np.abs(self._directions), axis=1)])
        keys = np.column_stack([np.rint(feet / ON_LINE), np.rint(self._directions * signs[:, None] / PARALLEL)])
        self._each = np.sort(distinct_rows(keys)[0])

    def on(self, axis: Axis) -> tuple[int, ...]:
        """Components with a face about an axis, each once."""
        turned = np.linalg.norm(cross(self._directions, np.broadcast_to(axis.d, self._directions.shape)), axis=1)
        near = (turned < PARALLEL) & (axis.distances(self._points) < ON_LINE)
        return tuple(dict.fromkeys(self._owners[n] for n in np.flatnonzero(near)))

    def has(self, axis: Axis) -> bool:
        """Whether there is a face about an axis."""
        each = self._each
        turned = np.linalg.norm(cross(self._directions[each], axis.d[None]), axis=1)
        return bool(((turned < PARALLEL) & (axis.distances(self._points[each]) < ON_LINE)).any())

    def turns(self, axis: Axis, line: Axis) -> list[float]:
        """Angles [rad] about an axis that align a line with one of the assembly, ascending."""
        frame = perpendicular_frame(axis.d)
        own, own_at = _about(line.point[None], line.d[None], axis.point, frame)
        each = self._each
        others, at = _about(self._points[each], self._directions[each], axis.point, frame)
        alike = np.abs(others - own).max(axis=1) < ON_LINE
        angles = {round(float(a - own_at[0]) % np.pi, 4): float(a - own_at[0]) % np.pi for a in at[alike]}
        turned = [angle + half for angle in angles.values() for half in (0.0, -np.pi)]
        return sorted(q for q in turned if self.has(_turned(line, axis, q)))


def _about(points: Array, directions: Array, origin: Array, frame: Array) -> tuple[Array, Array]:
    """Position of lines relative to the z axis of a frame: distance [m], height [m], slope, and angle [rad].

    The height of parallel lines, and the angle of lines that coincide with the axis, are undefined and 0.
    """
    p, d = (points - origin) @ frame, directions @ frame
    across = np.hypot(d[:, 0], d[:, 1])
    is_parallel = across < PARALLEL
    safe = np.where(is_parallel, 1.0, across)
    along = np.where(is_parallel, 0.0, -np.einsum("ij,ij->i", p[:, :2], d[:, :2]) / safe**2)
    foot = p + along[:, None] * d
    distance = np.hypot(foot[:, 0], foot[:, 1])
    # The foot point gives the angle; if the line intersects the axis, its direction does.
    by_foot, by_direction = np.arctan2(foot[:, 1], foot[:, 0]), np.arctan2(d[:, 1], d[:, 0]) + 0.5 * np.pi
    angle = np.where(is_parallel, np.where(distance > ON_LINE, by_foot, 0.0), by_direction)
    height = np.where(is_parallel, 0.0, foot[:, 2])
    return np.column_stack([distance, height, np.where(is_parallel, 0.0, across) * ON_LINE / PARALLEL]), angle


def _turned(line: Axis, axis: Axis, angle: float) -> Axis:
    R = rotation_about(axis.d, angle)
    return Axis(axis.point + R @ (line.point - axis.point), R @ line.d)


def distinct(axes: Iterable[Axis]) -> list[Axis]:
    """Distinct axes with a direction."""
    kept: list[Axis] = []
    for axis in axes:
        if axis.direction is not None and not any(axis.same(other) for other in kept):
            kept.append(axis)
    return kept


def matching_pairs(ours: tuple[Axis, Axis], theirs: Sequence[Axis]) -> Iterator[Pose]:
    """Poses that align two skew or intersecting lines with two others in the same relative position."""
    if not theirs:
        return
    points, directions = np.array([a.point for a in theirs]), np.array([a.d for a in theirs])
    cosines, distances = np.abs(directions @ directions.T), _distances(points, directions)
    cosine = abs(float(ours[0].d @ ours[1].d))
    distance = _distances(np.array([a.point for a in ours]), np.array([a.d for a in ours]))[0, 1]
    alike = (np.abs(cosines - cosine) < PARALLEL) & (np.abs(distances - distance) < ON_LINE)
    for i, k in zip(*np.nonzero(alike), strict=True):
        if not are_parallel(theirs[i].d, theirs[k].d):
            yield from _poses(ours, (theirs[i], theirs[k]))


def _distances(points: Array, directions: Array) -> Array:
    """Distances (n, n) [m] between lines; 0 between parallel ones."""
    normals = cross(directions[:, None], np.broadcast_to(directions, (len(points), *directions.shape)))
    lengths = np.linalg.norm(normals, axis=2)
    between = points[None] - points[:, None]
    volumes = np.abs(np.einsum("ijk,ijk->ij", between, normals))
    return np.asarray(volumes / np.where(lengths > PARALLEL, lengths, np.inf))


def _poses(ours: tuple[Axis, Axis], theirs: tuple[Axis, Axis]) -> Iterator[Pose]:
    one, foot = _frame(*ours)
    for s, t in _SIGNS:
        a, b = Axis(theirs[0].point, s * theirs[0].d), Axis(theirs[1].point, t * theirs[1].d)
        if abs(float(a.d @ b.d - ours[0].d @ ours[1].d)) > PARALLEL:
            continue
        other, far = _frame(a, b)
        pose = other @ one.inverse()
        if float(np.linalg.norm(pose.apply(foot) - far)) < ON_LINE:
            yield pose


def _frame(a: Axis, b: Axis) -> tuple[Pose, Array]:
    """A frame on ``a`` at the point nearest to ``b``, with the foot point on ``b``."""
    normal = np.cross(a.d, b.d)
    between = b.point - a.point
    scale = float(normal @ normal)
    p = a.point + a.d * (float(np.cross(between, b.d) @ normal) / scale)
    q = b.point + b.d * (float(np.cross(between, a.d) @ normal) / scale)
    z = normal / np.sqrt(scale)
    return Pose.of(np.column_stack([a.d, np.cross(z, a.d), z]), p), q
