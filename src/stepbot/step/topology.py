"""The faces of a shape, and the mean of its vertices."""

from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

from stepbot.geometry.spatial import Array


def faces_of(shape: Any) -> list[Any]:
    """The faces of a shape, each once, in file order, with their orientation in it."""
    found = ShapeMap()
    TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_FACE, found)
    return [TopoDS.Face(found.FindKey(index)) for index in range(1, found.Extent() + 1)]


def mean_of_vertices(shape: Any) -> Array | None:
    """Mean of the vertices [mm], each as often as an edge of a face ends there; None for a shape without vertices.

    The kernel integrates about this point.
    """
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_VERTEX)
    points = []
    while explorer.More():
        point = BRep_Tool.Pnt_s(TopoDS.Vertex(explorer.Current()))
        points.append((point.X(), point.Y(), point.Z()))
        explorer.Next()
    return np.mean(points, axis=0) if points else None
