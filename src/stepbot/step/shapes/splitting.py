"""Splits a closed mesh along edges with more than two faces, without changing its shape.

Blocks of one solid that touch along an edge have an edge with four faces. Their mesh encloses a volume, but software
for closed meshes rejects it. Around such an edge outside and inside alternate: faces with the inside between them
belong together, and each pair gets its own midpoint of the edge, so that no two pairs share an edge.
"""

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import AxisFace, Body

from .stitching import Indices, Stitched

_COINCIDENT = 1e-6
"""Angle [rad] between two faces at an edge up to which they coincide."""

# Sides are numbered over all triangles: side s of triangle s // 3 runs from its corner s % 3 to the next one.


def split(mesh: Stitched) -> Stitched:
    """The mesh with two faces at every edge; unchanged where inside and outside do not alternate."""
    while True:
        cuts = _cuts(mesh)
        if not cuts:
            return mesh
        mesh = _divided(mesh, cuts)


def _cuts(mesh: Stitched) -> list[tuple[int, int]]:
    """Pairs of sides to divide next, so that no triangle is divided twice."""
    cuts: list[tuple[int, int]] = []
    divided: set[int] = set()
    for sides in _crowded(mesh.faces):
        triangles = set((sides // 3).tolist())
        if divided.isdisjoint(triangles) and (pairs := _pairs_around(mesh, sides)):
            cuts += pairs
            divided |= triangles
    return cuts


def _crowded(faces: NDArray[np.int32]) -> list[Indices]:
    """The sides at each edge that has more than two."""
    start, end = faces.reshape(-1).astype(np.int64), np.roll(faces, -1, axis=1).reshape(-1).astype(np.int64)
    edges = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
    order = np.argsort(edges, kind="stable")
    _, first, count = np.unique(edges[order], return_index=True, return_counts=True)
    return [order[first[i] : first[i] + count[i]] for i in np.flatnonzero(count > 2)]


def _pairs_around(mesh: Stitched, sides: Indices) -> list[tuple[int, int]]:
    """The sides at one edge in pairs with the inside between them; empty if inside and outside do not alternate."""
    start, end, opposite = (mesh.faces[sides // 3, (sides + k) % 3] for k in range(3))
    is_forward = start == start[0]
    angles = _angles(mesh.vertices[opposite], mesh.vertices[start[0]], mesh.vertices[end[0]])
    order = np.argsort(angles)
    gaps = np.diff(np.append(angles[order], angles[order[0]] + 2.0 * np.pi))
    if not gaps.min() > _COINCIDENT:
        return []
    # Counter-clockwise around the edge the outside follows a face that runs forwards, the inside one that does not.
    if is_forward[order[0]]:
        order = np.roll(order, -1)
    backward, forward = order[0::2], order[1::2]
    if is_forward[backward].any() or not is_forward[forward].all():  # of an odd number one does not alternate
        return []
    return [(int(a), int(b)) for a, b in zip(sides[backward], sides[forward], strict=True)]


def _angles(points: Array, start: Array, end: Array) -> Array:
    """Angles [rad] of points (n, 3) around the axis from start to end, from the first point on; NaN without an axis."""
    with np.errstate(invalid="ignore"):
        axis = (end - start) / np.linalg.norm(end - start)
    offsets = points - start
    radial = offsets - np.outer(offsets @ axis, axis)
    return np.asarray(np.arctan2(radial @ np.cross(axis, radial[0]), radial @ radial[0]) % (2.0 * np.pi))


def _divided(mesh: Stitched, cuts: list[tuple[int, int]]) -> Stitched:
    """The mesh with both triangles of each cut divided at the middle of their sides, by a separate vertex per cut."""
    sides = np.array(cuts)
    triangles, corners = sides // 3, [mesh.faces[sides // 3, (sides + k) % 3] for k in range(3)]
    start, end, opposite = corners
    middles = 0.5 * (mesh.vertices[start[:, 0]] + mesh.vertices[end[:, 0]])
    middle = np.repeat(len(mesh.vertices) + np.arange(len(cuts)), 2).reshape(-1, 2)
    faces = np.concatenate([mesh.faces, np.stack([middle, end, opposite], axis=-1).reshape(-1, 3)])
    faces[triangles.reshape(-1)] = np.stack([start, middle, opposite], axis=-1).reshape(-1, 3)
    places = np.concatenate([mesh.places, mesh.places[triangles.reshape(-1)]])
    return replace(mesh, vertices=np.concatenate([mesh.vertices, middles]), faces=faces.astype(np.int32), places=places)


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


def _properties(exact: VolumeProperties | None, factors: Array, scale: float) -> VolumeProperties | None:
    if exact is None:
        return None
    S = np.diag(factors / scale)
    inertia = S @ np.array(exact.unit_density.inertia) @ S  # a reflection is its own inverse
    com = factors * np.array(exact.unit_density.com)
    return VolumeProperties.of(exact.volume * scale**3, com, inertia * scale**5)


def _axis_face(face: AxisFace, factors: Array, scale: float) -> AxisFace:
    return replace(
        face,
        point=vector3(np.array(face.point) * factors),
        direction=vector3(np.array(face.direction) * factors / scale),
        radius=face.radius * scale,
        low=face.low * scale,
        high=face.high * scale,
    )
