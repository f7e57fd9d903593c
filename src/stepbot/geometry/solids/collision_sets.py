"""Collision geometry of solids that belong together: one primitive, one hull, or convex pieces.

The solids are joined to one, so screws in their holes, parts inside a housing and seams between parts get no shapes of
their own, and voids that nothing can enter are filled. The shapes together enclose all of it.
"""

import os
from collections.abc import Iterator, Sequence
from math import inf
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.fixed_point import distinct_rows, exact_sum
from stepbot.geometry.mesh import GRID_PER_METRE, TriMesh
from stepbot.geometry.spatial import Array, cross, dot, matrix_product
from stepbot.runtime.parallel import results_of

from ..spatial import IDENTITY
from .collision_scores import NO_SCORE, CollisionScore, UnscoredSolids, collision_score
from .convex_pieces import convex_pieces, main_axes
from .manifolds import convex_hull, hull_faces, hull_volume, inscribed, mesh_arrays, use_one_thread
from .primitive_fits import PrimitiveFits, RoundFace
from .slivers import face_normals
from .unions import PlacedShape, PlacedSolid, Union, union

FEWEST = 8
"""Minimum number of vertices: those of a box."""
_TOUCHING = 1.0 / GRID_PER_METRE
"""Distance [m] up to which a vertex counts as on the hull."""


def bounded_hull(hull: TriMesh, max_vertices: int | None, max_faces: int | None = None) -> TriMesh:
    """A convex mesh of few vertices and flat faces that encloses a convex mesh, up to the vertex grid.

    Args:
        hull: A convex mesh; returned as it is if it is small enough.
        max_vertices: At least :data:`FEWEST`; None for any number.
        max_faces: At least 6, those of a box; None for any number.
    """
    vertices, faces = (inf if most is None else most for most in (max_vertices, max_faces))
    if len(hull.vertices) <= vertices and len(hull.faces) <= faces:
        return hull
    center = hull.vertices.mean(axis=0)  # inside, which the middle of the bounding box need not be
    made = convex_hull(_outline(hull, center, vertices, faces) + center)
    assert made is not None  # it encloses a hull, which is not flat
    return made


def _outline(hull: TriMesh, center: Array, max_vertices: float, max_faces: float) -> Array:
    """Vertices (n, 3) [m] of the polyhedron, relative to ``center``."""
    points = hull.vertices - center
    normals, _, a = face_normals(points, hull.faces)
    offsets = np.einsum("ij,ij->i", normals, a)
    chosen = np.vstack([np.eye(3), -np.eye(3)])
    distances = matrix_product(points, chosen.T).max(axis=0)
    best = _corners(chosen, distances)
    while True:
        depths = matrix_product(best, normals.T) - offsets
        vertex = int(depths.max(axis=1).argmax())
        plane = int(depths[vertex].argmax())
        if depths[vertex, plane] <= _TOUCHING or len(chosen) >= max_faces:
            return best
        chosen = np.vstack([chosen, normals[plane]])
        # A thin face is tilted by the rounding of its corners: move its plane out to the outermost vertex.
        distances = np.append(distances, dot(points, normals[plane]).max())
        offsets[plane] = np.inf
        refined = _corners(chosen, distances)
        if len(refined) > max_vertices:
            return best
        best = refined


def _corners(normals: Array, distances: Array) -> Array:
    """Vertices (n, 3) [m] of an intersection of half spaces around the origin.

    They are the faces of the dual polyhedron, which has a vertex for each plane: its normal divided by its distance.
    """
    dual = np.ascontiguousarray(normals / distances[:, None])
    corners = dual[hull_faces(dual)]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    across = cross(b - a, c - a)
    scale = np.einsum("ij,ij->i", across, a)
    vertices = across[scale > 0.0] / scale[scale > 0.0, None]
    # A face of the dual with more than three corners was triangulated: all its triangles give the same vertex.
    rounded = (vertices * GRID_PER_METRE).round() / GRID_PER_METRE + 0.0
    return np.asarray(rounded[distinct_rows(rounded)[0]])


WITHIN = 1e-7
"""Distance [m] up to which a mesh may protrude from the shapes that enclose it."""


def enclosed_meshes(meshes: Sequence[PlacedSolid], shapes: Sequence[PlacedShape]) -> tuple[int, ...]:
    """Indices of the meshes whose convex hulls the shapes enclose together, to :data:`WITHIN`.

    Args:
        meshes: Open or closed; one that is too flat for a hull does not count as enclosed.
        shapes: Convex shapes in the same frame.
    """
    import manifold3d

    if not meshes or not shapes:
        return ()
    placed = [inscribed(shape.geometry).transform(shape.X_AG.matrix[:3]) for shape in shapes]
    union = manifold3d.Manifold.batch_boolean(placed, manifold3d.OpType.Add)
    return tuple(i for i, one in enumerate(meshes) if _is_inside(one, union))


def _is_inside(solid: PlacedSolid, union: Any) -> bool:
    import manifold3d

    hull = convex_hull(solid.mesh.vertices)
    if hull is None:
        return False
    shrunk = manifold3d.Manifold.hull_points(np.ascontiguousarray(solid.X_AC.apply(_shrunk(hull.vertices))))
    return bool((shrunk - union).is_empty())


def _shrunk(points: Array) -> Array:
    """The points (n, 3) [m], moved towards their centre, none by more than :data:`WITHIN`: flush faces come apart."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    size = float(np.linalg.norm(points - center, axis=1).max())
    return np.asarray(center + (1.0 - WITHIN / size) * (points - center))


MAX_HULLS, MAX_VERTICES = 16, 64
"""Default budgets; PhysX and MJX take at most 64 vertices a hull."""
FEW, CLOSE = 0.9, 0.95
"""Share of the total volume of its shapes that a solid has to fill: for few shapes, and for close ones."""


class CollisionRequest(Struct, frozen=True, eq=False):
    """Solids that get one set of shapes, all in A."""

    solids: tuple[PlacedSolid, ...]
    missing: float
    """Exact volume [m^3] of the solids, minus that of their meshes."""
    shafts: tuple[RoundFace, ...]
    bores: tuple[RoundFace, ...]
    primitives: bool
    """Whether a primitive may stand for the solids or for a piece; otherwise all shapes are hulls."""
    filled: float
    """Share of the total volume of the pieces' hulls that the solids have to fill."""
    max_hulls: int
    max_vertices: int
    beside: tuple[PlacedSolid, ...] = ()
    """Other meshes of the same link, each of which gets a hull unless the shapes enclose it."""
    is_whole: bool = True
    """Whether the link has no shapes but these and the hulls."""
    max_faces: int | None = None
    """Of each hull. With a bound no shape is a cylinder: MJX, which needs it, cannot collide these with hulls."""


class CollisionSet(Struct, frozen=True, eq=False):
    """Shapes that together enclose solids."""

    shapes: tuple[PlacedShape, ...]
    filled: float = 1.0
    """Share of the total volume of the convex pieces that the solids fill, before hulls get fewer vertices."""
    left_out: tuple[int, ...] = ()
    """Solids whose meshes bound no volume, and which the shapes do not enclose."""
    enclosed: tuple[int, ...] = ()
    """Meshes beside the solids that the shapes enclose too."""
    score: CollisionScore = NO_SCORE
    """How well the shapes, with the hulls beside them, match the other solids; of a link with further shapes, none."""
    scored: int = 0
    """Number of these shapes and hulls."""


def collision_sets(all_wanted: Sequence[CollisionRequest]) -> tuple[CollisionSet, ...]:
    """The shapes of each, with their scores; the same for the same input, whatever the number of processes and threads.

    Raises:
        WorkerDied: A process ended without a result.
    """
    weights = [sum(len(solid.mesh.faces) for solid in wanted.solids) for wanted in all_wanted]
    here = os.getpid()

    def made(wanted: CollisionRequest) -> CollisionSet:
        if os.getpid() != here:  # others like this one use the other cores
            use_one_thread()
        return _scored_set(wanted)

    return tuple(results_of(made, all_wanted, weights, "collision shapes"))


def _scored_set(wanted: CollisionRequest) -> CollisionSet:
    solid = union(wanted.solids)
    if solid.manifold is None:
        return CollisionSet((), left_out=solid.left_out)
    made, encloses = _collision_set(wanted, solid)
    made = replace(made, enclosed=enclosed_meshes(wanted.beside, made.shapes))
    if not wanted.is_whole:
        return made
    beside = [one for i, one in enumerate(wanted.beside) if i not in made.enclosed]
    shapes = (*made.shapes, *_hulls(beside, wanted))
    score = collision_score(UnscoredSolids(wanted.solids, wanted.missing, shapes), encloses)
    return replace(made, score=score, scored=len(shapes))


def _hulls(meshes: Sequence[PlacedSolid], wanted: CollisionRequest) -> Iterator[PlacedShape]:
    """The hull of each mesh that is not too flat for one."""
    for mesh in meshes:
        hull = convex_hull(mesh.mesh.vertices)
        if hull is not None:
            yield PlacedShape(bounded_hull(hull, wanted.max_vertices, wanted.max_faces), mesh.X_AC)


def _collision_set(wanted: CollisionRequest, solid: Union) -> tuple[CollisionSet, bool]:
    """The shapes, and whether they enclose the whole solid: not if a piece is too flat for a hull."""
    axes = main_axes(*face_normals(*solid.arrays)[:2])
    fits = PrimitiveFits(axes, wanted.shafts, cylinders=wanted.max_faces is None)
    if wanted.primitives:
        corners = mesh_arrays(solid.manifold.hull())[0]
        fit = fits.best(corners, solid.volume + wanted.missing, FEW)
        if fit is not None:
            return CollisionSet((PlacedShape(fit.shape, fit.X_AG),), 1.0, solid.left_out), True
    pieces = convex_pieces(solid, wanted.bores, wanted.filled, wanted.max_hulls)
    shapes = [_piece(piece, wanted, fits) for piece in pieces]
    fitted = tuple(shape for shape in shapes if shape is not None)
    filled = round(solid.volume / exact_sum(map(hull_volume, pieces)), 6)
    return CollisionSet(fitted, filled, solid.left_out), len(fitted) == len(pieces)


def _piece(points: Array, wanted: CollisionRequest, fits: PrimitiveFits) -> PlacedShape | None:
    """The shape of a convex piece; None if it is too flat for a hull."""
    hull = convex_hull(points)
    if hull is None:
        return None
    if wanted.primitives:
        fit = fits.best(hull.vertices, hull_volume(hull.vertices), CLOSE)
        if fit is not None:
            return PlacedShape(fit.shape, fit.X_AG)
    return PlacedShape(bounded_hull(hull, wanted.max_vertices, wanted.max_faces), IDENTITY)
