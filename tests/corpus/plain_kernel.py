"""An independent reading of the solids of a STEP file: the kernel's reader and healing, no tree, no process."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from robot_library.command import kernel_properties
from robot_library.moments import Array

MILLIMETRES_PER_METRE = 1000.0


class PlainSolid(Struct, frozen=True, eq=False):
    """One solid in the frame of its definition, at 1 kg/m^3, integrated by GProp's default rule."""

    volume: float
    """[m^3]."""
    com: tuple[float, ...]
    """[m]."""
    inertia: tuple[tuple[float, ...], ...]
    """About the com [kg m^2]."""
    shape: Any
    """The kernel's shape [mm]."""

    def volume_by_spans(self) -> float:
        """Volume [m^3] by the kernel's Gauss-Kronrod rule, which divides every face at its knots, to 1e-9."""
        from OCP.BRepGProp import BRepGProp
        from OCP.GProp import GProp_GProps

        properties = GProp_GProps()
        reached = BRepGProp.VolumePropertiesGK_s(self.shape, properties, 1e-9, False, True, False, False, False)
        assert 0.0 <= reached < 1e-8
        return float(properties.Mass()) / MILLIMETRES_PER_METRE**3

    def volume_without_integration(self) -> float:
        """Volume [m^3] extrapolated from two meshes; the error of a mesh falls with the square of its fineness."""
        coarse, fine = (_mesh_volume(self.shape, angle) for angle in (0.16, 0.08))
        return (4.0 * fine - coarse) / 3.0 / MILLIMETRES_PER_METRE**3


def plain_solids(step: Path) -> list[PlainSolid]:
    """Every solid of a file, once for all its occurrences."""
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopLoc import TopLoc_Location

    reader = STEPControl_Reader()
    reader.ReadFile(str(step))
    reader.TransferRoots()
    seen: list[Any] = []
    for solid in _explored(reader.OneShape(), "SOLID"):
        if not any(solid.IsPartner(other) for other in seen):
            seen.append(solid)
    return [_measured(solid.Located(TopLoc_Location())) for solid in seen]


def _measured(solid: Any) -> PlainSolid:
    volume, com, inertia = kernel_properties(solid)
    scale = MILLIMETRES_PER_METRE
    rows = (0.5 * (inertia + inertia.T) / scale**5).tolist()
    return PlainSolid(volume / scale**3, tuple((com / scale).tolist()), tuple(map(tuple, rows)), solid)


def _mesh_volume(solid: Any, angle: float) -> float:
    """Volume [mm^3] of the triangles that the kernel makes of a solid, by the divergence theorem."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box, False)
    BRepTools.Clean_s(solid)
    BRepMesh_IncrementalMesh(solid, box.SquareExtent() ** 0.5 * angle**2 / 8, False, angle, False)
    volume = 0.0
    for face in map(TopoDS.Face, _explored(solid, "FACE")):
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        nodes = _moved(location, [triangulation.Node(i) for i in range(1, triangulation.NbNodes() + 1)])
        places = np.array([triangulation.Triangle(i).Get() for i in range(1, triangulation.NbTriangles() + 1)]) - 1
        a, b, c = (nodes[places[:, corner]] for corner in range(3))
        signed = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
        volume += -signed if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED else signed
    return volume


def _moved(location: Any, points: list[Any]) -> Array:
    trsf = location.Transformation()
    X = np.array([[trsf.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)])
    return np.array([[p.X(), p.Y(), p.Z()] for p in points]) @ X[:, :3].T + X[:, 3]


def _explored(shape: Any, kind: str) -> Iterator[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    while explorer.More():
        yield explorer.Current()
        explorer.Next()
