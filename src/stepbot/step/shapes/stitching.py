"""Joins separately meshed faces to one mesh, which is watertight if the solid is.

The mesher divides an edge once, for all its faces, and reports for each face which of its nodes are on it. Nodes of the
same point of an edge, or of the same vertex, are merged; distances are never compared, so thin walls stay apart and
gaps are not closed by accident.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.fixed_point import distinct_rows, merged_labels
from stepbot.geometry.mesh import signed_volume, triangle_areas
from stepbot.geometry.spatial import Array

Indices = NDArray[np.int64]


class FacetedFace(Struct, frozen=True, eq=False):
    """The triangles of one face, outward-facing."""

    place: int
    nodes: Array
    """Shape (n, 3)."""
    triangles: NDArray[np.int32]
    """Shape (m, 3), indices of the face's own nodes."""


class EdgeUse(Struct, frozen=True):
    """An edge as one side of a face."""

    place: int
    """Index of the face."""
    edge: int
    """Number of the edge, the same for every face that has it."""
    nodes: list[int]
    """The face's own nodes on the edge, from 1, in the edge's direction; empty if the face has no triangles."""
    ends: tuple[int, int]
    """Numbers of the vertices; 0 if there is none."""
    is_point: bool
    """Whether the edge is a point, such as a pole of a sphere."""


class Stitched(Struct, frozen=True, eq=False):
    """One mesh of all faces."""

    vertices: Array
    """Shape (n, 3)."""
    faces: NDArray[np.int32]
    """Shape (m, 3)."""
    places: NDArray[np.int32]
    """Shape (m,): the face of the shape of each triangle."""
    open_edges: int
    """Number of edges of the shape that belong to only one face."""

    @property
    def signed_volume(self) -> float:
        """Volume of a closed mesh; negative if its faces point inwards."""
        return signed_volume(self.vertices, self.faces)

    @property
    def area(self) -> float:
        """Area of all faces."""
        return float(triangle_areas(self.vertices[self.faces]).sum())

    def turned(self) -> "Stitched":
        """The same mesh with its faces reversed."""
        return Stitched(self.vertices, self.faces[:, ::-1], self.places, self.open_edges)

    def consistent(self) -> "Stitched | None":
        """The same mesh with triangles reversed where neighbours face different sides.

        None if an edge does not have two triangles, or if the surface is in several pieces or has one side alone.
        """
        count = len(self.faces)
        edges = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        order = np.lexsort(np.sort(edges, axis=1).T)
        first, second = order[::2], order[1::2]
        ends = np.sort(edges, axis=1)
        if len(order) % 2 or (ends[first] != ends[second]).any() or (ends[first[1:]] == ends[first[:-1]]).all(1).any():
            return None
        # Of each triangle there are two, as it is and, `count` later, reversed; those that fit are connected.
        a, b = first // 3, second // 3
        alike = (edges[first] != edges[second]).any(axis=1)
        other = np.where(alike, b, b + count)
        labels = merged_labels(2 * count, np.append(a, a + count), np.append(other, (other + count) % (2 * count)))
        as_they_are, reversed_ones = labels[:count], labels[count:]
        if not count or (as_they_are == reversed_ones).any() or np.minimum(as_they_are, reversed_ones).any():
            return None
        faces = np.where((as_they_are == 0)[:, None], self.faces, self.faces[:, ::-1])
        return Stitched(self.vertices, faces, self.places, self.open_edges)


def stitched(faces: Sequence[FacetedFace], uses: Sequence[EdgeUse]) -> Stitched:
    """Join faces along the edges that they share."""
    nodes, triangles, places, starts = _together(faces)
    roots = merged_labels(len(nodes), *_same_points(uses, starts))
    sides = Counter(use.edge for use in uses if not use.is_point)  # a seam has its face on both sides
    return _assembled(nodes, roots[triangles], places, sum(count == 1 for count in sides.values()))


def merged_by_position(faces: Sequence[FacetedFace]) -> Stitched:
    """Join faces at nodes with equal coordinates: for triangles without edges, as in tessellated STEP."""
    nodes, triangles, places, _ = _together(faces)
    nodes = nodes + 0.0  # without minus zero
    first, kinds = distinct_rows(nodes)
    return _assembled(nodes, first[kinds][triangles], places, 0)


def _same_points(uses: Sequence[EdgeUse], starts: dict[int, int]) -> tuple[Indices, Indices]:
    """Pairs of nodes, numbered over all faces, that represent one point."""
    first_use: dict[int, Indices] = {}
    at_vertex: dict[int, int] = {}
    none = np.empty(0, dtype=np.int64)
    left, right = [none], [none]
    vertex_pairs: list[tuple[int, int]] = []
    for use in uses:
        if not use.nodes:
            continue
        nodes = np.array(use.nodes, dtype=np.int64) + (starts[use.place] - 1)
        if use.is_point:
            left.append(nodes[1:])
            right.append(nodes[:-1])
        else:
            other = first_use.setdefault(use.edge, nodes)
            if len(other) == len(nodes) and other is not nodes:
                left.append(other)
                right.append(nodes)
        for vertex, node in zip(use.ends, (int(nodes[0]), int(nodes[-1])), strict=True):
            if vertex:
                vertex_pairs.append((at_vertex.setdefault(vertex, node), node))
    if vertex_pairs:
        pairs = np.array(vertex_pairs, dtype=np.int64)
        left.append(pairs[:, 0])
        right.append(pairs[:, 1])
    return np.concatenate(left), np.concatenate(right)


def _assembled(nodes: Array, triangles: Indices, places: NDArray[np.int32], open_edges: int) -> Stitched:
    """Remove degenerate triangles, and renumber the remaining nodes in their old order."""
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)
    used, renumbered = np.unique(triangles[kept], return_inverse=True)
    faces = renumbered.reshape(-1, 3).astype(np.int32)
    return Stitched(nodes[used], faces, places[kept], open_edges)


def _together(faces: Sequence[FacetedFace]) -> tuple[Array, Indices, NDArray[np.int32], dict[int, int]]:
    """The nodes (n, 3) of all faces, their triangles (m, 3) with nodes numbered over all of them, and whose they are.

    Also returns for each face the number of nodes before its own.
    """
    starts, total = {}, 0
    for face in faces:
        starts[face.place] = total
        total += len(face.nodes)
    nodes = np.concatenate([face.nodes for face in faces] or [np.empty((0, 3))])
    parts = [face.triangles.astype(np.int64) + starts[face.place] for face in faces]
    places = np.repeat([face.place for face in faces], [len(face.triangles) for face in faces]).astype(np.int32)
    return nodes, np.concatenate([*parts, np.empty((0, 3), dtype=np.int64)]), places, starts
