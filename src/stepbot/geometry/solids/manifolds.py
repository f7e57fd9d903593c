"""Booleans of closed meshes, and convex hulls: the only module that imports manifold3d.

https://github.com/elalish/manifold: its Booleans always terminate, and closed meshes give closed meshes, even with
coincident faces.
"""

import os
from collections.abc import Sequence
from functools import cache, cached_property
from math import pi, radians, sin, sqrt
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ..fixed_point import distinct
from ..mesh import TriMesh, triangle_areas
from ..predicates import encloses
from ..primitives import Box, Capsule, Cylinder, Primitive, Sphere
from ..spatial import IDENTITY, Array, Pose, cross, lengths
from .box_pairs import moved_boxes
from .cut_surfaces import Surface
from .slivers import without_slivers

TOUCHING = 1e-6
"""Depth [m] up to which touching faces may penetrate each other."""

_FLAT = 1e-7
"""Volume of a hull, as a share of its diagonal cubed, below which it counts as flat."""
_SMOOTH = radians(50.0)
"""Angle between adjacent triangles up to which they approximate one curved face; the library's default is 15
degrees."""


def prepare() -> None:
    """Import the library."""
    import manifold3d  # noqa: F401


@cache
def use_one_thread() -> None:
    """Keep the library from starting threads in this process, if it has not yet; results are the same.

    oneTBB, which it uses, counts the cores at its first use. Threads take a tenth to a fifth more processor time.
    """
    import manifold3d

    if hasattr(os, "sched_setaffinity"):
        cores = os.sched_getaffinity(0)
        os.sched_setaffinity(0, {min(cores)})
        manifold3d.Manifold.cube((1.0, 1.0, 1.0))
        os.sched_setaffinity(0, cores)


class Solid:
    """A closed mesh; expensive properties are computed on first use."""

    def __init__(self, mesh: TriMesh) -> None:
        self._mesh = mesh

    @property
    def face_count(self) -> int:
        """Number of faces of the mesh."""
        return len(self._mesh.faces)

    @property
    def is_sound(self) -> bool:
        """Whether the mesh bounds a volume; otherwise its overlaps are undefined."""
        import manifold3d

        return bool(self._manifold.status() == manifold3d.Error.NoError and not self._manifold.is_empty())

    def may_meet(self, other: "Solid", X_AB: Pose) -> bool:
        """Whether this solid, given in A, and another one, given in B, can intersect.

        An intersection is inside both boxes. If none of a solid's faces reach their overlap, that region is entirely
        inside or outside the solid.
        """
        return self._may_reach(other, X_AB) and other._may_reach(self, X_AB.inverse())

    def intersection(self, other: "Solid", X_AB: Pose) -> "Intersection":
        """The intersection of this solid, given in A, and another one, given in B."""
        common = self._manifold ^ other._manifold.transform(X_AB.matrix[:3])
        return Intersection(common, common.volume(), {self._id: self, other._id: other})

    @cached_property
    def sagittas(self) -> Array:
        """For each face (m,), its distance [m] from the curved face that it approximates; 0 for flat ones.

        Estimated from the mesh: the middle of a chord of width w on an arc that turns by t is w / 2 tan(t / 4) away
        from it.
        """
        return _sagittas(self._mesh)

    @cached_property
    def _id(self) -> int:
        import manifold3d

        return int(manifold3d.Manifold.reserve_ids(1))

    @cached_property
    def _manifold(self) -> Any:
        """The mesh with numbered faces, so that the origin of each face of an intersection is known."""
        import manifold3d

        faces = self._mesh.faces.astype(np.uint64)
        numbered = manifold3d.Mesh64(
            self._mesh.vertices.copy(),  # it does not accept read-only arrays
            faces,
            run_index=np.array([0, faces.size], dtype=np.uint64),
            run_original_id=np.array([self._id], dtype=np.uint32),
            face_id=np.arange(len(faces), dtype=np.uint64),
        )
        return manifold3d.Manifold(numbered)

    @cached_property
    def _box(self) -> tuple[Array, Array]:
        """Lowest and highest corner (1, 3) of the mesh."""
        low, high = self._mesh.bounds
        return np.array([low]), np.array([high])

    @cached_property
    def _face_boxes(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3, m) of each face."""
        corners = self._mesh.vertices.T[:, self._mesh.faces.T]
        return corners.min(axis=1), corners.max(axis=1)

    def _may_reach(self, other: "Solid", X_AB: Pose) -> bool:
        """Whether this solid can reach the overlap of the boxes, along its own axes."""
        there = moved_boxes(*other._box, X_AB.R[None], X_AB.p[None])
        low, high = np.maximum(self._box[0], there[0])[0], np.minimum(self._box[1], there[1])[0]
        if (low + TOUCHING >= high).any():
            return False
        lows, highs = self._face_boxes
        reaches = (lows[0] < high[0]) & (highs[0] > low[0])
        for axis in (1, 2):
            reaches &= (lows[axis] < high[axis]) & (highs[axis] > low[axis])
        return bool(reaches.any()) or encloses(self._mesh, 0.5 * (low + high))


class Intersection(Struct, frozen=True, eq=False, dict=True):
    """The intersection of two solids, in the frame of the first."""

    _manifold: Any
    volume: float
    """[m^3]."""
    _solids: dict[int, Solid]

    @property
    def mesh(self) -> TriMesh:
        """Its surface."""
        return TriMesh.of(*_arrays(self._manifold))

    @cached_property
    def noise(self) -> float:
        """Volume [m^3] that two solids with such faces may share although they only touch.

        The meshes of two coincident curved faces do not coincide: each differs from the true face by its sagitta.
        """
        mesh = self._manifold.to_mesh64()
        corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, dtype=np.int64)]
        areas = triangle_areas(corners)
        numbers = np.asarray(mesh.face_id, dtype=np.int64)
        # A run is the faces that come from one solid; its bounds count corners.
        runs = np.asarray(mesh.run_index, dtype=np.int64) // 3
        depths = np.empty(len(areas))
        for solid, start, end in zip(mesh.run_original_id, runs[:-1], runs[1:], strict=True):
            depths[start:end] = self._solids[int(solid)].sagittas[numbers[start:end]]
        return float(areas @ (depths + 0.5 * TOUCHING))


def union_volume(parts: Sequence[tuple[TriMesh, Pose]]) -> float:
    """Volume [m^3] of the union of closed meshes, each given in A and placed by X_WA."""
    import manifold3d

    placed = [_closed(mesh).transform(X_WA.matrix[:3]) for mesh, X_WA in parts]
    return float(manifold3d.Manifold.batch_boolean(placed, manifold3d.OpType.Add).volume())


def _closed(mesh: TriMesh) -> Any:
    """A closed mesh as a manifold."""
    import manifold3d

    return manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices.copy(), mesh.faces.astype(np.uint64)))


def joined_solid(parts: Sequence[tuple[TriMesh, Pose]]) -> tuple[Any | None, tuple[int, ...]]:
    """The union of closed meshes, each given in C and placed by X_AC, without voids; None without any volume.

    Also returns the indices of the parts that bound no volume, which are left out.
    """
    import manifold3d

    solids, left_out = [], []
    made: dict[int, Any] = {}  # by the mesh, which several parts may have
    for i, (mesh, X_AC) in enumerate(parts):
        if id(mesh) not in made:
            made[id(mesh)] = _closed(mesh)
        closed = made[id(mesh)]
        if closed.status() == manifold3d.Error.NoError and closed.volume() > 0.0:
            solids.append(closed if X_AC.is_identity else closed.transform(X_AC.matrix[:3]))
        else:
            left_out.append(i)
    union = _filled(manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add))
    return (None if union.is_empty() else union), tuple(left_out)


def _filled(union: Any) -> Any:
    """A union without voids, and without what is in them."""
    import manifold3d

    surfaces = union.decompose()
    # The surface of a void is turned inside out.
    outer = [surface for surface in surfaces if surface.volume() > 0.0]
    if len(outer) == len(surfaces) or not outer:
        return union
    # Surfaces of a union do not cross: one that is inside another one is in a void of that.
    boxes = [np.reshape(surface.bounding_box(), (2, 3)) for surface in outer]
    closed = cache(lambda i: Surface(*_arrays(outer[i])))
    kept = []
    for i, (low, high) in enumerate(boxes):
        around = [j for j, box in enumerate(boxes) if j != i and (box[0] <= low).all() and (high <= box[1]).all()]
        if not any(closed(j).contains(_point_of(closed(i))) for j in around):
            kept.append(outer[i])
    return kept[0] if len(kept) == 1 else manifold3d.Manifold.compose(kept)


def _point_of(surface: Surface) -> Array:
    """The centre (3,) [m] of the largest face: less likely than a corner to touch another surface."""
    a, b, c = (surface.points[surface.faces[:, corner]] for corner in range(3))
    largest = int(lengths(cross(b - a, c - a)).argmax())
    return np.asarray((a[largest] + b[largest] + c[largest]) / 3.0)


def convex_hull(points: Array) -> TriMesh | None:
    """Convex hull of points (n, 3), outward-facing; None if they are coplanar, or nearly.

    manifold3d finds the same faces in every run, in an order that depends on its threads: here they are sorted. It may
    return triangles without area along edges with a further vertex (:func:`.without_slivers`).
    """
    import manifold3d

    if len(points) < 4:
        return None
    hull = manifold3d.Manifold.hull_points(np.ascontiguousarray(points))
    diagonal = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    if hull.volume() <= _FLAT * diagonal**3:
        return None
    mesh = hull.to_mesh64()
    made = TriMesh.of(np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts))
    return without_slivers(TriMesh.of(*_in_order(made.vertices, made.faces)))


def mesh_arrays(solid: Any) -> tuple[Array, NDArray[np.int64]]:
    """Vertices (n, 3) [m] and faces (m, 3) of a manifold, sorted: their order in the library depends on its threads."""
    return _in_order(*_arrays(solid))


def _arrays(solid: Any) -> tuple[Array, NDArray[np.int64]]:
    """The same in the library's order."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)


def faces_not_of(made: Any, solid: Any) -> tuple[Array, NDArray[np.int64], NDArray[np.bool_]]:
    """The part of the surface of a manifold that a solid, from which it was made by Booleans, has not contributed.

    Returns:
        Vertices (n, 3) [m] and faces (m, 3), sorted, and which vertices (n,) are on the other part too.
    """
    mesh = made.to_mesh64()
    theirs = np.isin(np.asarray(mesh.run_original_id), np.asarray(solid.to_mesh64().run_original_id))
    bounds = np.asarray(mesh.run_index, dtype=np.int64) // 3
    of_solid = np.repeat(theirs, bounds[1:] - bounds[:-1])
    vertices, faces = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
    touching = np.zeros(len(vertices), dtype=bool)
    touching[faces[of_solid]] = True
    used = distinct(faces[~of_solid])
    renumbered = np.zeros(len(vertices), dtype=np.int64)
    renumbered[used] = np.arange(len(used))
    order = np.lexsort(vertices[used].T[::-1])
    return *_in_order(vertices[used], renumbered[faces[~of_solid]]), touching[used][order]


def hull_points(points: Array) -> Array:
    """Those of points (n, 3) that are vertices of their convex hull, sorted."""
    import manifold3d

    return mesh_arrays(manifold3d.Manifold.hull_points(np.ascontiguousarray(points)))[0]


def hull_volume(points: Array) -> float:
    """Volume [m^3] of the convex hull of points (n, 3); 0 if there are too few."""
    import manifold3d

    return float(manifold3d.Manifold.hull_points(np.ascontiguousarray(points)).volume()) if len(points) >= 4 else 0.0


def hull_faces(points: Array) -> NDArray[np.int64]:
    """Faces (m, 3) of the convex hull of points (n, 3), as indices of these points, in no particular order."""
    import manifold3d

    mesh = manifold3d.Manifold.hull_points(points).to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    # The hull's vertices are a subset of the points, unchanged, in another order.
    index = {point.tobytes(): i for i, point in enumerate(points)}
    numbers = np.array([index[vertex.tobytes()] for vertex in np.ascontiguousarray(vertices)], dtype=np.int64)
    return numbers[np.asarray(mesh.tri_verts, dtype=np.int64)]


def _in_order(vertices: Array, faces: NDArray[np.integer]) -> tuple[Array, NDArray[np.int64]]:
    order = np.lexsort(vertices.T[::-1])
    renumbered: NDArray[np.int64] = np.argsort(order)[faces]
    turns = (renumbered.argmin(axis=1)[:, None] + np.arange(3)) % 3
    renumbered = np.take_along_axis(renumbered, turns, axis=1)
    return np.ascontiguousarray(vertices[order]), renumbered[np.lexsort(renumbered.T[::-1])]


def _sagittas(mesh: TriMesh) -> Array:
    """See :attr:`Solid.sagittas`; of a closed mesh, each of whose edges joins two faces."""
    corners = mesh.vertices[mesh.faces]
    edges = np.roll(corners, -1, axis=1) - corners  # edge i goes from corner i to the next
    normals = np.cross(edges[:, 0], edges[:, 1])
    lengths = np.linalg.norm(edges, axis=2).ravel()
    doubled = np.repeat(np.linalg.norm(normals, axis=1), 3)
    heights = np.divide(doubled, lengths, out=np.zeros_like(lengths), where=lengths > 0.0)
    first, second = _edge_sides(mesh.faces)
    a, b = normals[first // 3], normals[second // 3]
    angles = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
    widths = np.minimum(heights[first], heights[second])
    depths = np.where(angles < _SMOOTH, 0.5 * widths * np.tan(0.25 * angles), 0.0)
    sagittas = np.zeros(len(mesh.faces))
    np.maximum.at(sagittas, first // 3, depths)
    np.maximum.at(sagittas, second // 3, depths)
    return sagittas


def _edge_sides(faces: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Both sides of each edge, as indices into the flat ``faces``: a side goes from there to its face's next corner."""
    starts, ends = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    keys = np.minimum(starts, ends) * (int(faces.max()) + 1) + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    return order[0::2], order[1::2]


_SIDES = 256
"""Number of sides of a prism in place of a cylinder."""
_SAME_AREA = sqrt(2.0 * pi / (_SIDES * sin(2.0 * pi / _SIDES)))
"""Circumradius of the regular polygon with the area of a circle of radius 1."""


def of_same_volume(geometry: Primitive | TriMesh) -> Any:
    """A manifold of the same volume, but inscribed in a sphere or capsule; the hull of an open mesh."""
    return _manifold(geometry, _SAME_AREA)


def inscribed(geometry: Primitive | TriMesh) -> Any:
    """The same, but no part of it is outside the shape."""
    return _manifold(geometry, 1.0)


def _manifold(geometry: Primitive | TriMesh, wider: float) -> Any:
    import manifold3d

    solids = manifold3d.Manifold
    if isinstance(geometry, TriMesh):
        solid, _ = joined_solid([(geometry, IDENTITY)])
        return solids.hull_points(geometry.vertices.copy()) if solid is None else solid
    if isinstance(geometry, Box):
        return solids.cube(geometry.size, True)
    if isinstance(geometry, Cylinder):
        return solids.cylinder(geometry.length, wider * geometry.radius, wider * geometry.radius, _SIDES, True)
    if isinstance(geometry, Sphere):
        return solids.sphere(geometry.radius, _SIDES)
    assert isinstance(geometry, Capsule)
    ends = [
        solids.sphere(geometry.radius, _SIDES).translate((0, 0, z))
        for z in (-0.5 * geometry.length, 0.5 * geometry.length)
    ]
    return solids.batch_hull(ends)
