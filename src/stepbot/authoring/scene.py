"""The parts of an assembly with their faces in the assembly's frame."""

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepbot.geometry.spatial import Array
from stepbot.step.assembly import Assembly, Body, Component
from stepbot.step.faces import Face, FaceKind


@dataclass(frozen=True, eq=False)
class PlacedFace:
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


class Scene:
    """Input of the inference: parts are the indices of all components with a body, in file order."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.parts = tuple(c.index for c in assembly.components if c.body >= 0)

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
            for placed in self._placed(part):
                found[placed.face.kind].append(placed)
        return found

    @cached_property
    def boxes(self) -> dict[int, Array]:
        """Bounding box (2, 3) [m] of each part in the assembly; parts without extent are left out."""
        found = {}
        for part in self.parts:
            placed = self._placed(part)
            if placed:
                low, high = np.min([f.low for f in placed], axis=0), np.max([f.high for f in placed], axis=0)
                found[part] = np.array([low, high])
        return found

    def face_boxes(self, part: int) -> Array:
        """Bounding boxes (n, 2, 3) [m] of the faces of a part in the assembly."""
        return np.array([(f.low, f.high) for f in self._placed(part)]).reshape(-1, 2, 3)

    def outline(self, placed: PlacedFace) -> list[Array]:
        """The outlines of a plane in the assembly."""
        X = self.component(placed.part).X_WC
        return [X.apply(ring) for ring in placed.face.rings]

    def _placed(self, part: int) -> list[PlacedFace]:
        if part not in self._faces_of:
            faces, X = self.body(part).faces, self.component(part).X_WC
            if not faces:
                self._faces_of[part] = []
                return []
            points = X.apply(np.array([f.point for f in faces]))
            directions = X.turn(np.array([f.direction for f in faces]))
            boxes = np.array([f.box for f in faces])
            middles, halves = X.apply(boxes.mean(axis=1)), 0.5 * np.ptp(boxes, axis=1) @ np.abs(X.R).T
            self._faces_of[part] = [
                PlacedFace(part, *row)
                for row in zip(faces, points, directions, middles - halves, middles + halves, strict=True)
            ]
        return self._faces_of[part]

    @cached_property
    def _faces_of(self) -> dict[int, list[PlacedFace]]:
        return {}
