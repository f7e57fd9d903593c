"""The faces of a shape."""

from typing import Any

from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS


def faces_of(shape: Any) -> list[Any]:
    """The faces of a shape, each once, in file order, with their orientation in it."""
    found = ShapeMap()
    TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_FACE, found)
    return [TopoDS.Face(found.FindKey(index)) for index in range(1, found.Extent() + 1)]
