"""The parts of an assembly with their faces in the assembly's frame."""

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stepbot.geometry.spatial import Array
from stepbot.step.assembly import Assembly, Body, Component
from stepbot.step.faces import Face, FaceKind


class PlacedFace(NamedTuple):
    """A face of a component."""

    part: int
    """Index of the component."""
    face: Face
    """In the component's frame."""
    point: Array
    """Shape (3,) [m], in the assembly, as ``direction``, ``low`` and ``high``."""
    direction: Array
    low: Array
    """Lowest corner of its bounding box."""
    high: Array


@dataclass(frozen=True, eq=False)
class _Drawn:
    """The faces of a definition."""

    points: Array
    """Shape (n, 3) [m], in the component's frame, as ``directions``."""
    directions: Array
    middles: Array
    """Shape (n, 3) [m]: the middle of each bounding box."""
    halves: Array
    """Shape (n, 3) [m]: half of its size."""


class Scene:
    """Input of the inference: parts are the indices of all components with a body, in file order."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.parts = tuple(c.index for c in assembly.components if c.body >= 0)
        self._drawn: dict[int, _Drawn] = {}
        self._boxes_of: dict[int, tuple[Array, Array]] = {}

    def component(self, part: int) -> Component:
        """The component with an index."""
        return self.assembly.components[part]

    def body(self, part: int) -> Body:
        """The body of a part."""
        return self.assembly.bodies[self.component(part).body]

    @cached_property
    def faces(self) -> dict[FaceKind, list[PlacedFace]]:
        """All faces by kind, in file order."""
        found: dict[FaceKind, list[PlacedFace]] = defaultdict(list)
        for part in self.parts:
            faces, X = self.body(part).faces, self.component(part).X_WC
            if faces:
                drawn, (low, high) = self._drawn_faces(part), self._corners(part)
                points, directions = X.apply(drawn.points), X.turn(drawn.directions)
                for face, *row in zip(faces, points, directions, low, high, strict=True):
                    found[face.kind].append(PlacedFace(part, face, *row))
        return found

    @cached_property
    def boxes(self) -> dict[int, Array]:
        """Bounding box (2, 3) [m] of each part in the assembly; parts without extent are left out."""
        found = {}
        for part in self.parts:
            low, high = self._corners(part)
            if len(low):
                found[part] = np.array([low.min(axis=0), high.max(axis=0)])
        return found

    def face_boxes(self, part: int) -> Array:
        """Bounding boxes (n, 2, 3) [m] of the faces of a part in the assembly."""
        return np.stack(self._corners(part), axis=1)

    def outline(self, placed: PlacedFace) -> list[Array]:
        """The outlines of a plane in the assembly."""
        X = self.component(placed.part).X_WC
        return [X.apply(ring) for ring in placed.face.rings]

    def _corners(self, part: int) -> tuple[Array, Array]:
        """Lowest and highest corners (n, 3) [m] of the faces of a part in the assembly."""
        if part not in self._boxes_of:
            drawn, X = self._drawn_faces(part), self.component(part).X_WC
            middles, halves = X.apply(drawn.middles), drawn.halves @ np.abs(X.R).T
            self._boxes_of[part] = middles - halves, middles + halves
        return self._boxes_of[part]

    def _drawn_faces(self, part: int) -> _Drawn:
        """The faces of the definition of a part, which occurs more than once in most assemblies."""
        body = self.component(part).body
        if body not in self._drawn:
            faces = self.assembly.bodies[body].faces
            points = np.array([f.point for f in faces]).reshape(-1, 3)
            directions = np.array([f.direction for f in faces]).reshape(-1, 3)
            boxes = np.array([f.box for f in faces]).reshape(-1, 2, 3)
            self._drawn[body] = _Drawn(points, directions, boxes.mean(axis=1), 0.5 * np.ptp(boxes, axis=1))
        return self._drawn[body]
