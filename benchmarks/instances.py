"""An assembly with many instances of another one on a plate, as in a cell of robots: of equal or of distinct parts."""

from pathlib import Path

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.collections import Sequence_TDF_Label
from OCP.gp import gp_Trsf, gp_Vec
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_DocumentTool

_APART = 500.0
"""Distance between two instances [mm]."""
_COLUMNS = 10


def write_instances(step: Path, count: int, to: Path, *, distinct: bool = False) -> None:
    """Write a STEP file with so many instances of the assembly of another one.

    Args:
        distinct: Whether each has definitions of its own, as if every robot were another one.
    """
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    for _ in range(count if distinct else 1):
        reader = STEPCAFControl_Reader()
        reader.ReadFile(str(step))
        reader.Transfer(document)
    shapes, free = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()), Sequence_TDF_Label()
    shapes.GetFreeShapes(free)
    cell = shapes.NewShape()
    plate = shapes.AddShape(BRepPrimAPI_MakeBox(_COLUMNS * _APART, _COLUMNS * _APART, 10.0).Shape(), False)
    for label, name in ((cell, "cell"), (plate, "plate")):
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    shapes.AddComponent(cell, plate, _at(-0.5 * _APART, -0.5 * _APART, -200.0))
    for number in range(count):
        row, column = divmod(number, _COLUMNS)
        shapes.AddComponent(cell, free.Value(number + 1 if distinct else 1), _at(column * _APART, row * _APART, 0.0))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    writer.Write(str(to))


def _at(*position: float) -> TopLoc_Location:
    moved = gp_Trsf()
    moved.SetTranslation(gp_Vec(*position))
    return TopLoc_Location(moved)
