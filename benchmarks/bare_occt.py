"""The kernel's own time for a STEP file: read, transfer, mesh, integrate, one after the other.

``python bare_occt.py FILE [RELATIVE_DEFLECTION [ANGLE]]``, a typical script with the kernel's own defaults. Every
definition is meshed and measured once, at stepbot's default tolerances.
"""

import json
import math
import sys
from collections.abc import Iterator
from typing import Any

from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.collections import Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool


def main(path: str, deflection: float = 0.002, angle: float = math.radians(15.0)) -> None:
    """Measure a file and print its solids and their volume, each definition once."""
    solids, volume = 0, 0.0
    for solid in meshed_solids(path, deflection, angle):
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, properties)
        solids, volume = solids + 1, volume + properties.Mass()
    sys.stdout.write(json.dumps({"solids": solids, "volume": volume}) + "\n")


def meshed_solids(path: str, deflection: float, angle: float) -> Iterator[Any]:
    """The solids of all definitions of a file, meshed.

    Args:
        path: The STEP file.
        deflection: Tolerance of the mesh, as a share of the diagonal of a definition's bounding box.
        angle: Its angular tolerance [rad].
    """
    for shape in _definitions(_read(path)):
        box = Bnd_Box()
        BRepBndLib.Add_s(shape, box, False)
        if box.IsVoid():
            continue
        BRepMesh_IncrementalMesh(shape, deflection * math.sqrt(box.SquareExtent()), False, angle, False)
        explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
        while explorer.More():
            yield explorer.Current()
            explorer.Next()


def _read(path: str) -> Any:
    """The document of a STEP file."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    reader = STEPCAFControl_Reader()
    reader.ReadFile(path)
    reader.Transfer(document)
    return document


def _definitions(document: Any) -> Iterator[Any]:
    """The shape of each product that is not an assembly."""
    labels = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(labels)
    for index in range(1, labels.Length() + 1):
        if not XCAFDoc_ShapeTool.IsAssembly_s(labels.Value(index)):
            yield XCAFDoc_ShapeTool.GetShape_s(labels.Value(index))


if __name__ == "__main__":
    main(sys.argv[1], *map(float, sys.argv[2:]))
