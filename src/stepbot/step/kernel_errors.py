"""The exceptions that the geometry kernel raises for shapes that it cannot handle, if it does not crash."""

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
import OCP.Standard as Standard
from OCP.BRep import BRep_Tool
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

from stepbot.geometry.spatial import Array

T = TypeVar("T")

OUT_OF_MEMORY: tuple[type[Exception], ...] = (MemoryError, Standard.Standard_OutOfMemory)
"""Errors unrelated to the shape."""
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(kind for _, kind in sorted(vars(Standard).items()) if isinstance(kind, type) and issubclass(kind, Exception)),
    RuntimeError,  # the binding's type for unknown C++ exceptions
    MemoryError,
)


def evaluated(evaluate: Callable[[Any], T], shapes: Iterable[Any], errors: list[str]) -> list[T]:
    """A function's results for the shapes that it does not fail on; ``errors`` receives its errors on the others."""
    found = []
    for shape in shapes:
        try:
            found.append(evaluate(shape))
        except OUT_OF_MEMORY:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it costs this shape's result alone
            errors.append(f"{type(error).__name__} {error}".rstrip())
    return found


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
