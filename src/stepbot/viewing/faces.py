"""The axis of a clicked face, as a sidecar refers to it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepbot.geometry.spatial import Array, Vector3, vector3
from stepbot.step.assembly import Assembly, AxisFace, Body
from stepbot.step.features.axes import DISTANCE_TOLERANCE, AxisLine, axis_faces, lines, selectors
from stepbot.step.structure.paths import quoted

_ON_SURFACE = 2e-6
"""Distance [m] up to which a vertex lies on a cylinder: vertices are on a grid of a nanometre, the kernel's tolerance
is a micrometre."""


@dataclass(frozen=True)
class ClickedFace:
    """A cylindrical or conical face with its axis."""

    kind: str
    """``bore``, ``shaft`` or ``cone``."""
    radius: float
    """[m]; of a cone, the larger one."""
    origin: str
    """Value of ``origin`` in a sidecar: ``{axis_of: "motor/horn", radius: 8 mm}``."""
    point: Vector3
    """A point of the axis [m], in the component's frame."""
    direction: Vector3
    """Unit direction of the axis, in the component's frame."""


def clicked_face(assembly: Assembly, component: int, triangle: Sequence[Sequence[float]]) -> ClickedFace | None:
    """The face that a triangle belongs to; None if the face has no axis.

    Args:
        component: Index of the component.
        triangle: Corners (3, 3) [m] in the component's frame, to the accuracy of a drawing.
    """
    body = assembly.bodies[assembly.components[component].body]
    if not len(body.mesh.faces):
        return None
    corners = _nearest_triangle(body, np.array(triangle, dtype=np.float64).reshape(3, 3))
    face = min(body.axis_faces, key=lambda one: _distance(one, corners), default=None)
    if face is None or not _distance(face, corners) <= _ON_SURFACE:
        return None
    found = lines(axis_faces(assembly, [component]))
    placed = face.moved(assembly.components[component].X_WC)
    index = min(range(len(found)), key=lambda i: _apart(found[i], placed))
    origin = f"{{axis_of: {quoted(assembly.components[component].path)}{selectors(found)[index]}}}"
    kind = "cone" if face.cone else "bore" if face.bore else "shaft"
    return ClickedFace(kind, face.radius, origin, face.point, face.direction)


def _nearest_triangle(body: Body, drawn: Array) -> Array:
    """Corners of the mesh's own triangle that was drawn: a drawing rounds them."""
    corners = body.mesh.vertices[body.mesh.faces]
    distances = np.linalg.norm(corners.mean(axis=1) - drawn.mean(axis=0), axis=1)
    return np.asarray(corners[int(distances.argmin())])


def _distance(face: AxisFace, corners: Array) -> float:
    """Largest distance [m] of corners (3, 3) from a face; infinite beyond its ends."""
    direction = np.array(face.direction)
    arm = corners - np.array(face.point)
    along = arm @ direction
    if along.min() < face.low - DISTANCE_TOLERANCE or along.max() > face.high + DISTANCE_TOLERANCE:
        return np.inf
    radii = np.linalg.norm(arm - np.outer(along, direction), axis=1)
    if not face.cone:
        return float(np.abs(radii - face.radius).max())
    # The lines of a cone meet its axis: three corners on it span a plane whose normal is not along the axis.
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    flat = abs(float(normal @ direction)) > (1.0 - 1e-6) * float(np.linalg.norm(normal))
    spread = along.max() - along.min()
    if flat or radii.max() > face.radius + _ON_SURFACE or spread <= 0.0:
        return np.inf
    slope = np.polyfit(along, radii, 1)
    return float(np.abs(np.polyval(slope, along) - radii).max())


def _apart(line: AxisLine, face: AxisFace) -> float:
    """How far a face's axis is from a line: distance [m] and sine of the angle, in one number."""
    turned = float(np.linalg.norm(np.cross(line.direction, face.direction)))
    return (
        line.distance_to(vector3(np.array(face.point) + 0.5 * (face.low + face.high) * np.array(face.direction)))
        + turned
    )
