"""The foot that a whole assembly stands on, or hangs from."""

import numpy as np

from stepbot.step.faces import FaceKind

from .axis import Axis
from .clusters import Clusters
from .survey import Survey

_FLAT = 1e-4
"""Thickness of the ground plane, as a share of the assembly's size."""


class Feet:
    """The outermost parts of an assembly along any direction."""

    def __init__(self, survey: Survey) -> None:
        self._survey, self._near = survey, _FLAT * survey.extent
        self._parts = [i for i, part in survey.parts.items() if part.size and i not in survey.small]
        self._boxes = np.array([survey.parts[i].box for i in self._parts]).reshape(-1, 2, 3)

    def below(self, sides: Clusters, axis: Axis) -> list[tuple[int, float]]:
        """The sides that alone reach one end of the assembly along an axis, with the radius [m] of their faces there.

        At most two, each by its representative.
        """
        found = []
        for d in (-axis.d, axis.d):
            reach = np.maximum(self._boxes[:, 0] * d, self._boxes[:, 1] * d).sum(axis=1)
            level = float(reach.max())
            last = {self._parts[k] for k in np.flatnonzero(reach > level - self._near).tolist()}
            roots = {sides.find(i) if i in sides else -1 for i in last}
            if len(roots) == 1 and -1 not in roots:
                found.append((roots.pop(), self._width(last, Axis(axis.point, d), level)))
        return found

    def _width(self, parts: set[int], down: Axis, level: float) -> float:
        """The largest distance [m] from an axis of plane faces on the ground, which it points to."""
        scene = self._survey.scene
        grounded = [
            placed
            for part in sorted(parts)
            for placed in scene.faces_of(part, FaceKind.PLANE)
            if down.is_along(placed.direction) and float((placed.point * down.d).sum()) > level - self._near
        ]
        rings = [ring for placed in grounded for ring in scene.outline(placed.part, placed.face)]
        return max((float(down.distances(ring).max()) for ring in rings), default=0.0)
