"""Opens a STEP file with the kernel and returns its products as a document (XCAF).

Transfer builds shapes without healing them: healing takes most of its time, and is done per body afterwards, in
parallel (:mod:`stepbot.step.shapes.healing`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import OCP.Standard as Standard
from OCP.BRep import BRep_Tool
from OCP.collections import DataMap_TCollection_AsciiString_TCollection_AsciiString as ParameterMap
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Reader
from OCP.TCollection import TCollection_AsciiString, TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_ShapeTool

from stepbot.geometry.spatial import Array

MILLIMETRES_PER_METRE = 1000.0
"""The kernel's lengths are millimetres, whatever the file's unit is."""

_SETTINGS = {
    "xstep.cascade.unit": "MM",
    "read.step.codepage": "UTF8",
    # A part with both an exact shape and triangles would appear twice.
    "read.step.tessellated": "OnNoBRep",
}
_HEALING = (
    "FixFreeShellMode", "FixFreeFaceMode", "FixFreeWireMode", "FixSameParameterMode", "FixSolidMode",
    "FixShellOrientationMode", "CreateOpenSolidMode", "FixShellMode", "FixFaceOrientationMode", "FixFaceMode",
    "FixWireMode", "FixOrientationMode", "FixAddNaturalBoundMode", "FixMissingSeamMode", "FixSmallAreaWireMode",
    "RemoveSmallAreaFaceMode", "FixIntersectingWiresMode", "FixLoopWiresMode", "FixSplitFaceMode",
    "AutoCorrectPrecisionMode", "ModifyTopologyMode", "ModifyGeometryMode", "ClosedWireMode", "PreferencePCurveMode",
    "FixReorderMode", "FixSmallMode", "FixConnectedMode", "FixEdgeCurvesMode", "FixDegeneratedMode", "FixLackingMode",
    "FixSelfIntersectionMode", "RemoveLoopMode", "FixReversed2dMode", "FixRemovePCurveMode", "FixRemoveCurve3dMode",
    "FixAddPCurveMode", "FixAddCurve3dMode", "FixSeamMode", "FixShiftedMode", "FixEdgeSameParameterMode",
    "FixNotchedEdgesMode", "FixSelfIntersectingEdgeMode", "FixIntersectingEdgesMode",
    "FixNonAdjacentIntersectingEdgesMode", "FixTailMode", "FixVertexPositionMode", "FixVertexToleranceMode",
)  # fmt: skip
_PLACES = tuple((row, column) for row in (1, 2, 3) for column in (1, 2, 3, 4))
"""Of the values of a transformation."""
_UNUSED = ("Layer", "SHUO", "GDT", "View", "Meta", "Props", "Mat")


class StepUnreadable(Exception):
    """The kernel rejects the file; the message is the kernel's."""


def read_model(path: Path) -> tuple[Any, Any]:
    """Read the entities of a file in UTF-8: the ``STEPCAFControl_Reader``, and its work session with the entities.

    Raises:
        StepUnreadable: The kernel cannot parse the file.
    """
    STEPCAFControl_Controller.Init_s()
    # names are the file's, independent of earlier uses of the kernel in this process
    XCAFDoc_ShapeTool.SetAutoNaming_s(False)
    for name, value in _SETTINGS.items():
        if not Interface_Static.SetCVal_s(name, value):
            raise AssertionError(f"the kernel has no setting {name} = {value}")
    reader = STEPCAFControl_Reader()
    status = reader.ReadFile(str(path))
    if status != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise StepUnreadable(f"the kernel could not read it ({str(status).rpartition('_Ret')[2].lower()})")
    return reader, reader.Reader().WS()


def transfer(reader: Any) -> Any:
    """Build the shapes of a file that was read; returns the document that contains them.

    Raises:
        StepUnreadable: No shape could be built.
    """
    # Reading the file resets these settings, so they cannot be set earlier.
    switched_off = ParameterMap()
    for name in _HEALING:
        switched_off.Bind(TCollection_AsciiString(f"FixShape.{name}"), TCollection_AsciiString("0"))
    reader.SetShapeFixParameters(switched_off)
    for mode in _UNUSED:
        getattr(reader, f"Set{mode}Mode")(False)
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    if not reader.Transfer(document):
        raise StepUnreadable("the kernel found no shape")
    return document


def matrices_of(transformations: Sequence[Any]) -> Array:
    """Transformations of the kernel as homogeneous matrices (n, 4, 4) [m]."""
    X = np.zeros((len(transformations), 4, 4))
    values = [[transformation.Value(row, column) for row, column in _PLACES] for transformation in transformations]
    X[:, :3, :] = np.array(values).reshape(-1, 3, 4)
    X[:, :3, 3] /= MILLIMETRES_PER_METRE
    X[:, 3, 3] = 1.0
    return X


_SAME = 1e-9
"""Deviation up to which motions are equal: relative, and for positions up to 1 in the unit of the matrices absolute."""


def is_same_motion(a: Array, b: Array) -> bool:
    """Whether two transformations, (3, 4) or (4, 4), are equal up to rounding: a long way hides no other rotation."""
    off, size = np.abs(a - b)[:3], np.abs(b)[:3]
    return bool(off[:, :3].max() <= _SAME * size[:, :3].max() and off[:, 3].max() <= _SAME * max(1.0, size[:, 3].max()))


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
    values = []
    for shape in shapes:
        try:
            values.append(evaluate(shape))
        except OUT_OF_MEMORY:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it costs this shape's result alone
            errors.append(f"{type(error).__name__} {error}".rstrip())
    return values


def explored(shape: Any, kind: TopAbs_ShapeEnum) -> Iterator[Any]:
    """The shapes of a kind in a shape, as often as they occur in it; each is valid until the next."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def mapped(shape: Any, kind: TopAbs_ShapeEnum) -> ShapeMap:
    """The shapes of a kind in a shape, each once, in file order, numbered from 1."""
    shapes = ShapeMap()
    TopExp.MapShapes_s(shape, kind, shapes)
    return shapes


def faces_of(shape: Any) -> list[Any]:
    """The faces of a shape, each once, in file order, with their orientation in it."""
    faces = mapped(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    return [TopoDS.Face(faces.FindKey(index)) for index in range(1, faces.Extent() + 1)]


def mean_of_vertices(shape: Any) -> Array | None:
    """Mean of the vertices [mm], each as often as an edge of a face ends there; None for a shape without vertices.

    The kernel integrates about this point.
    """
    corners = (BRep_Tool.Pnt_s(TopoDS.Vertex(one)) for one in explored(shape, TopAbs_ShapeEnum.TopAbs_VERTEX))
    points = [(point.X(), point.Y(), point.Z()) for point in corners]
    return np.mean(points, axis=0) if points else None
