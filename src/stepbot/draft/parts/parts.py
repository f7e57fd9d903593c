"""One part: its role, size and centroid."""

from collections.abc import Iterable, Iterator, Sequence
from math import inf

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import SMALL_PARTS, Role
from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.spatial import Array, cross, perpendicular_frame

_OFF_AXIS = 0.01
"""Distance of a turned part's centroid from its axis, as a share of its size, up to which it is on the axis."""
_TILT, _UNEVEN = 0.02, 0.03
"""Tolerances of a turned part's inertia about its axis, as shares of its moments: tilt and asymmetry."""

_NARROW = 0.9
"""Share of boxes that are sought by their place; the others are longer."""


class Part(Struct, frozen=True, eq=False):
    """A component with a body."""

    index: int
    path: str
    name: str
    """Its own name, or that of the product of its body."""
    roles: tuple[Role, ...]
    role: Role | None
    """The first of ``roles``, or the role by its shape."""
    definition: int
    volume: float
    """[m^3]; 0 if it encloses none."""
    size: float
    """Diagonal of its bounding box [m]."""
    box: Array
    """Shape (2, 3) [m], in the assembly."""
    com: Array
    """Shape (3,) [m], in the assembly."""
    inertia: Array
    """Shape (3, 3), of density 1, about the centroid along the axes of the assembly."""
    is_linear: bool = False
    """Whether it has the dimensions of a linear bearing, in which a rod slides."""

    @property
    def is_small(self) -> bool:
        """Whether it is a fastener or a seal."""
        return self.role in SMALL_PARTS

    def is_balanced(self, axis: Axis, within: float = 1.0) -> bool:
        """Whether its mass is symmetric about an axis, as a turned part's is; ``within`` scales the tolerances."""
        if not self.volume or axis.distance(self.com) > within * _OFF_AXIS * self.size:
            return False
        tilt = float(np.linalg.norm(cross(self.inertia @ axis.d, axis.d)))
        if tilt > within * _TILT * float(np.trace(self.inertia)):
            return False
        across = perpendicular_frame(axis.d)[:, :2]
        small, large = np.linalg.eigvalsh(across.T @ self.inertia @ across).tolist()
        return bool(large - small < within * _UNEVEN * large)


def joint_box(parts: Iterable[Part]) -> Array:
    """The bounding box (2, 3) [m] of several parts."""
    boxes = np.array([part.box for part in parts if part.size])
    if not len(boxes):
        return np.zeros((2, 3))
    return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def box_gap(one: Array, two: Array) -> float:
    """Distance [m] between two boxes (2, 3); 0 if they overlap."""
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(one[0] - two[1], two[0] - one[1]))))


def least_gap(some: Array, others: Array) -> float:
    """Least distance [m] between one of n boxes and one of m, (n, 2, 3) and (m, 2, 3); 0 if two overlap."""
    around = np.array([others[:, 0].min(axis=0), others[:, 1].max(axis=0)])
    least = box_gaps(some, around[None])[:, 0]
    # No box is nearer than to the box around all others: those beyond what the first candidate has are left out.
    most = box_gaps(some[[int(least.argmin())]], others).min()
    return float(box_gaps(some[least <= most], others).min())


def box_gaps(some: Array, others: Array) -> Array:
    """Distances (n, m) [m] of boxes (n, 2, 3) and (m, 2, 3)."""
    apart = np.maximum(some[:, None, 0] - others[None, :, 1], others[None, :, 0] - some[:, None, 1])
    return np.asarray(np.sqrt((np.maximum(apart, 0.0) ** 2).sum(axis=2)))


class Boxes:
    """Boxes (n, 2, 3) [m], of which those near another one are found without looking at all."""

    def __init__(self, boxes: Array) -> None:
        self._boxes = boxes
        self._along = int(np.argmax(np.ptp(boxes[:, 0], axis=0))) if len(boxes) else 0
        low, high = boxes[:, 0, self._along], boxes[:, 1, self._along]
        # A few wide ones, which are near to much, are always looked at.
        self._length = float(np.quantile(high - low, _NARROW)) if len(boxes) else 0.0
        self._wide = np.flatnonzero(high - low > self._length)
        narrow = np.flatnonzero(high - low <= self._length)
        self._narrow = narrow[np.argsort(low[narrow], kind="stable")]
        self._low = low[self._narrow]

    def within(self, box: Array, reach: float) -> tuple[Array, Array]:
        """Numbers of the boxes up to ``reach`` [m] from another one (2, 3), ascending, and their distances [m]."""
        low, high = box[:, self._along].tolist()
        first = np.searchsorted(self._low, low - 1.001 * reach - self._length, side="left")
        last = np.searchsorted(self._low, high + 1.001 * reach, side="right")
        some = np.sort(np.concatenate([self._wide, self._narrow[first:last]]))
        gaps = box_gaps(box[None], self._boxes[some])[0]
        return some[gaps <= reach], gaps[gaps <= reach]

    def nearest(self, box: Array) -> Iterator[tuple[int, float]]:
        """Number and distance [m] of each box, the nearest one first."""
        before, reach = -1.0, max(1e-3, float(np.linalg.norm(box[1] - box[0])))
        while True:
            some, gaps = self.within(box, reach)
            for k in np.argsort(gaps, kind="stable"):
                if gaps[k] > before:
                    yield int(some[k]), float(gaps[k])
            if len(some) == len(self._boxes) or reach == inf:
                return
            before, reach = reach, 4.0 * reach


def largest(parts: Sequence[Part]) -> Part:
    """The part with the largest volume; the first of equal ones."""
    return max(parts, key=lambda part: (part.volume, -part.index))


def whole(parts: Sequence[Part]) -> Part | None:
    """Several solids as one part; None without any."""
    if not parts:
        return None
    whole = combined(MassProperties.of(part.volume, part.com.tolist(), part.inertia) for part in parts)  # of density 1
    low, high = joint_box(parts)
    size = float(np.linalg.norm(high - low))
    return replace(
        largest(parts), volume=whole.mass, com=np.array(whole.com), inertia=np.array(whole.inertia), size=size
    )
