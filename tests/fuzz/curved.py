"""A drawing of shapes that are rare in robots and difficult for kernels."""

from pathlib import Path
from typing import Any

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence, Part, write_step


def write_curved(path: Path) -> None:
    """Swept, lofted, offset and hollow bodies, a torus, a wire: one of each, side by side."""
    shapes = {
        "extruded": _extruded(),
        "revolved": _revolved(),
        "lofted": _lofted(),
        "hollow": _hollow(),
        "ring": _ring(),
        "offset": _offset(),
        "wire": _spline_edge(),
    }
    placed = [
        Occurrence(Part(name, shape, "#3366cc"), f"{name}:1", pose((60.0 * i, 0.0, 0.0)))
        for i, (name, shape) in enumerate(shapes.items())
    ]
    write_step(path, Assembly("curved", placed))


def _extruded() -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec

    wire = BRepBuilderAPI_MakeWire(_spline_edge(), _closing_edge()).Wire()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire).Face(), gp_Vec(0.0, 0.0, 15.0)).Shape()


def _revolved() -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeRevol(_spline_edge(), gp_Ax1(gp_Pnt(0.0, -20.0, 0.0), gp_Dir(1.0, 0.0, 0.0)), 3.0).Shape()


def _lofted() -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    loft = BRepOffsetAPI_ThruSections(True, False)
    for height, radius in ((0.0, 10.0), (15.0, 5.0), (30.0, 12.0)):
        circle = gp_Circ(gp_Ax2(gp_Pnt(0.0, 0.0, height), gp_Dir(0.0, 0.0, 1.0)), radius)
        loft.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire())
    return loft.Shape()


def _hollow() -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    block = BRepPrimAPI_MakeBox(gp_Pnt(-15.0, -15.0, -15.0), 30.0, 30.0, 30.0).Solid()
    return BRepAlgoAPI_Cut(block, BRepPrimAPI_MakeSphere(8.0).Solid()).Shape()


def _ring() -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(15.0, 4.0).Solid()


def _offset() -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_OffsetSurface, Geom_SurfaceOfLinearExtrusion
    from OCP.gp import gp_Dir

    swept = Geom_SurfaceOfLinearExtrusion(_spline(), gp_Dir(0.0, 0.0, 1.0))
    return BRepBuilderAPI_MakeFace(Geom_OffsetSurface(swept, 2.0), 0.0, 1.0, 0.0, 20.0, 1e-6).Face()


def _spline() -> Any:
    from OCP.collections import Array1_gp_Pnt
    from OCP.Geom import Geom_BezierCurve
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Pnt

    poles = Array1_gp_Pnt(1, 4)
    for index, (x, y) in enumerate(((0.0, 0.0), (10.0, 12.0), (25.0, -8.0), (40.0, 5.0)), start=1):
        poles.SetValue(index, gp_Pnt(x, y, 0.0))
    return GeomConvert.CurveToBSplineCurve_s(Geom_BezierCurve(poles))


def _spline_edge() -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

    return BRepBuilderAPI_MakeEdge(_spline()).Edge()


def _closing_edge() -> Any:
    """An arc from the end of the spline to its start."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.GC import GC_MakeArcOfCircle
    from OCP.gp import gp_Pnt

    arc = GC_MakeArcOfCircle(gp_Pnt(40.0, 5.0, 0.0), gp_Pnt(20.0, 30.0, 0.0), gp_Pnt(0.0, 0.0, 0.0))
    return BRepBuilderAPI_MakeEdge(arc.Value()).Edge()
