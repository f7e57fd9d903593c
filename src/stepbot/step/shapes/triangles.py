r"""Triangles and edge polygons of a meshed shape as arrays, bit for bit the kernel's values.

Reading one node through the Python binding costs about a microsecond, so the triangulations go through the kernel's own
binary format instead (BinTools): ``\nTriangulations N\n``, and for each of them two int32 counts, two flags, the
deflection, the nodes, their parameters, the triangles from 1, and normals.
"""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BinTools import BinTools
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Face

from stepbot.geometry.spatial import Array, rotated

from ..kernel import explored
from .stitching import EdgeUse, FacetedFace


class BrokenTriangles(RuntimeError):
    """A triangle refers to a missing corner, which tessellated STEP may contain."""


_SECTION = b"\nTriangulations "
_COUNTS_AND_FLAGS = 10


def faceted_faces(faces: list[Any]) -> tuple[list[FacetedFace], list[int]]:
    """The triangles of faces, and the indices of faces without triangles."""
    meshed, empty = [], []
    for place, face in enumerate(faces):
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        if triangulation is None or triangulation.NbTriangles() == 0:
            empty.append(place)
        else:
            meshed.append((place, face, triangulation, location))
    arrays = _arrays([triangulation for _, _, triangulation, _ in meshed])
    result = []
    for (place, face, _, location), (nodes, triangles) in zip(meshed, arrays, strict=True):
        if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(nodes):
            raise BrokenTriangles(f"a triangle refers to a node beyond the {len(nodes)} nodes of its face")
        is_mirrored = False
        if not location.IsIdentity():
            nodes, is_mirrored = _moved(nodes, location.Transformation()), location.Transformation().IsNegative()
        if (face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED) != is_mirrored:
            triangles = triangles[:, ::-1]
        result.append(FacetedFace(place, nodes, triangles))
    return result, empty


def edge_uses(faces: list[Any]) -> list[EdgeUse]:
    """For every edge of every face with triangles, the nodes on it, in the edge's own direction."""
    edges, vertices = ShapeMap(), ShapeMap()
    uses = []
    for place, face in enumerate(faces):
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        for edge in map(TopoDS.Edge, explored(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
            number = edges.Add(edge)
            if edge.Orientation() in (TopAbs_Orientation.TopAbs_INTERNAL, TopAbs_Orientation.TopAbs_EXTERNAL):
                continue
            polygon = None
            if triangulation is not None:
                polygon = BRep_Tool.PolygonOnTriangulation_s(edge, triangulation, location)
            nodes = [] if polygon is None else list(map(polygon.Node, range(1, polygon.NbNodes() + 1)))
            first, last = TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge)
            start = 0 if first.IsNull() else vertices.Add(first)
            end = 0 if last.IsNull() else vertices.Add(last)
            uses.append(EdgeUse(place, number, nodes, (start, end), BRep_Tool.Degenerated_s(edge)))
    return uses


def _arrays(triangulations: list[Any]) -> list[tuple[Array, NDArray[np.int32]]]:
    """Nodes (n, 3) and triangles (m, 3), from 0, of each triangulation."""
    distinct = {id(triangulation): triangulation for triangulation in triangulations}
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for triangulation in distinct.values():
        face = TopoDS_Face()
        builder.MakeFace(face, triangulation)
        builder.Add(compound, face)
    stream = io.BytesIO()
    BinTools.Write_s(compound, stream)
    data = stream.getvalue()
    section = data.index(_SECTION) + len(_SECTION)
    offset = data.index(b"\n", section) + 1
    if int(data[section : offset - 1]) != len(distinct):
        raise AssertionError("the kernel wrote another number of triangulations than it was given")
    arrays = {}
    for key in distinct:
        nodes, triangles, offset = _triangulation(data, offset)
        arrays[key] = (nodes, triangles)
    return [arrays[id(triangulation)] for triangulation in triangulations]


def _triangulation(data: bytes, offset: int) -> tuple[Array, NDArray[np.int32], int]:
    """One triangulation, and the offset of the next."""
    node_count, triangle_count = np.frombuffer(data, "<i4", 2, offset).tolist()
    has_parameters, has_normals = data[offset + 8], data[offset + 9]
    offset += _COUNTS_AND_FLAGS + 8
    nodes = np.frombuffer(data, "<f8", 3 * node_count, offset).reshape(-1, 3).astype(np.float64)
    offset += (40 if has_parameters else 24) * node_count
    triangles = np.frombuffer(data, "<i4", 3 * triangle_count, offset).reshape(-1, 3).astype(np.int32) - np.int32(1)
    offset += 12 * triangle_count + (12 * node_count if has_normals else 0)
    return nodes, triangles, offset


def _moved(nodes: Array, transformation: Any) -> Array:
    matrix = np.array([[transformation.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)])
    return np.asarray(rotated(matrix[:, :3], nodes) + matrix[:, 3])
