"""Bodies in mirrored or scaled occurrences."""

from dataclasses import replace

import numpy as np

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Vector3
from stepbot.geometry.volume import VolumeProperties

from ..assembly import AxisFace, Body

_THROUGH = np.array([1.0, 1.0, -1.0])
"""A mirror in the plane z = 0, coordinate by coordinate."""


def variant(body: Body, *, is_mirrored: bool, scale: float) -> Body:
    """A body mirrored through z = 0 of its frame, then scaled; unchanged if it is neither."""
    if not is_mirrored and scale == 1.0:
        return body
    factors = scale * (_THROUGH if is_mirrored else np.ones(3))
    faces = body.mesh.faces[:, ::-1] if is_mirrored else body.mesh.faces
    return replace(
        body,
        mesh=TriMesh.of(body.mesh.vertices * factors, faces),
        exact=_properties(body.exact, factors, scale),
        refined=_properties(body.refined, factors, scale),
        axis_faces=tuple(_axis_face(face, factors, scale) for face in body.axis_faces),
        area=body.area * scale**2,
        faces=tuple(face.scaled(factors, scale) for face in body.faces),
    )


def _properties(found: VolumeProperties | None, factors: Vector3 | np.ndarray, scale: float) -> VolumeProperties | None:
    if found is None:
        return None
    S = np.diag(np.asarray(factors) / scale)
    inertia = S @ np.array(found.unit_density.inertia) @ S  # a reflection is its own inverse
    com = np.asarray(factors) * np.array(found.unit_density.com)
    return VolumeProperties.of(found.volume * scale**3, com, inertia * scale**5)


def _axis_face(face: AxisFace, factors: np.ndarray, scale: float) -> AxisFace:
    px, py, pz = (np.array(face.point) * factors).tolist()
    dx, dy, dz = (np.array(face.direction) * factors / scale).tolist()
    return replace(
        face,
        point=(px, py, pz),
        direction=(dx, dy, dz),
        radius=face.radius * scale,
        low=face.low * scale,
        high=face.high * scale,
    )
