"""Faces that can show the axis of a joint across a gap: faces of revolution, round outlines, cradles, centred faces."""

from collections.abc import Container, Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from stepbot.geometry.spatial import Array
from stepbot.step.faces import Face, FaceKind

from .circles import fitted_circle, symmetric_outline
from .scene import PlacedFace, Scene

_SMALLEST_RADIUS = 2e-3
_HALF, _CRADLE = 3.0, 2.0
"""Least angle [rad] that a face of revolution covers, and a bore that only holds a shaft from one side."""
_CIRCLE = 1e-6


class SeamShape(StrEnum):
    """What a face shows by itself."""

    ROUND = "round"
    """A face of revolution that covers at least half of a turn."""
    CRADLE = "cradle"
    """A bore that covers less: it has the axis of a shaft inside it."""
    CENTRED = "centred"
    """A plane with a centre of symmetry, such as a rectangle: it has the axis of a round face on its centre."""


_Outline = tuple[Array, float, SeamShape]


@dataclass(frozen=True, eq=False)
class SeamFace:
    """A face in the assembly, with the line that it is centred on."""

    part: int
    center: Array
    direction: Array
    radius: float
    half: float
    """Half of its length along the axis."""
    shape: SeamShape
    bore: bool


def seam_faces(scene: Scene, parts: Container[int]) -> list[SeamFace]:
    """All such faces of some parts."""
    rows: list[SeamFace] = []
    for kind in (FaceKind.CYLINDER, FaceKind.CONE, FaceKind.TORUS):
        for placed in scene.faces(kind):
            if placed.part in parts and placed.face.radius >= _SMALLEST_RADIUS:
                rows += _revolved(placed)
    # The faces of a definition are looked at once.
    known: dict[int, list[tuple[Face, _Outline]]] = {}
    for part in scene.parts:
        if part in parts:
            component = scene.component(part)
            if component.body not in known:
                known[component.body] = _outlines(scene.body(part).faces)
            for face, (center, radius, shape) in known[component.body]:
                at, direction = component.X_WC.apply(center), component.X_WC.turn(face.direction)
                rows.append(SeamFace(part, at, direction, radius, 0.0, shape, bore=False))
    return rows


def _outlines(faces: Iterable[Face]) -> list[tuple[Face, _Outline]]:
    """The planes whose outline shows something."""
    planes = (face for face in faces if face.kind == FaceKind.PLANE and face.rings)
    return [(face, outline) for face in planes if (outline := _outline(face)) is not None]


def _revolved(placed: PlacedFace) -> list[SeamFace]:
    face = placed.face
    if face.span >= _HALF or face.kind == FaceKind.TORUS:
        shape = SeamShape.ROUND
    elif face.span >= _CRADLE and face.bore and face.kind == FaceKind.CYLINDER:
        shape = SeamShape.CRADLE
    else:
        return []
    return [SeamFace(placed.part, placed.point, placed.direction, face.radius, 0.5 * face.length, shape, face.bore)]


def _outline(face: Face) -> _Outline | None:
    """Centre, radius and shape of a plane's outline in the frame of its component; None if it shows nothing."""
    ring = face.rings[0]
    circle, shape = fitted_circle(ring, np.array(face.direction), _CIRCLE), SeamShape.ROUND
    if circle is None:
        circle, shape = symmetric_outline(ring), SeamShape.CENTRED
    if circle is None or circle[1] <= _SMALLEST_RADIUS:
        return None
    return *circle, shape
