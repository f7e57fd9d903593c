"""Straightens curves in the parameter space of faces on which the mesher fails because of rounding.

On a cylinder or a cone the seam is a vertical line in parameter space. Some programs write it slanted by the last bit
(3e-16 to 1), and the mesher then mistakes the corners of the face for crossings: it omits the face, or half of it. An
exactly vertical line is the same curve within 1e-9 of a radian.

An edge without a curve in space, such as the apex of a cone, has its range from its curve in parameter space alone.
Replacing that curve makes the range infinite, and the mesher then crashes or never ends: so the range is set again.
"""

from typing import Any

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

_SLANT = 1e-9
"""Component of a unit direction below which a line counts as parallel to an axis."""


def straighten(faces: list[Any]) -> int:
    """Make lines nearly parallel to an axis of parameter space exactly parallel, in place; returns their number."""
    return sum(_straighten_face(TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))) for face in faces)


def _straighten_face(face: Any) -> int:
    changed = 0
    edges = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_EDGE)
    while edges.More():
        changed += _straighten_edge(TopoDS.Edge(edges.Current().Oriented(TopAbs_Orientation.TopAbs_FORWARD)), face)
        edges.Next()
    return changed


def _straighten_edge(edge: Any, face: Any) -> bool:
    """Whether an edge of a face had a line to straighten."""
    curves = [BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)]
    if BRep_Tool.IsClosed_s(edge, face):
        curves.append(BRep_Tool.CurveOnSurface_s(TopoDS.Edge(edge.Reversed()), face, 0.0, 0.0))
    straight = [_straight(curve) for curve in curves]
    if not any(straight):
        return False
    builder, (first, last) = BRep_Builder(), BRep_Tool.Range_s(edge, face)
    replaced = [new or old for new, old in zip(straight, curves, strict=True)]
    builder.UpdateEdge(edge, *replaced, face, BRep_Tool.Tolerance_s(edge))
    builder.Range(edge, face, first, last)
    return True


def _straight(curve: Any) -> Geom2d_Line | None:
    """The exact line for a slightly slanted one; None if there is nothing to change."""
    if not isinstance(curve, Geom2d_Line):
        return None
    line = curve.Lin2d()
    x, y = line.Direction().X(), line.Direction().Y()
    if 0.0 < abs(x) < _SLANT:
        return Geom2d_Line(line.Location(), gp_Dir2d(0.0, 1.0 if y > 0.0 else -1.0))
    if 0.0 < abs(y) < _SLANT:
        return Geom2d_Line(line.Location(), gp_Dir2d(1.0 if x > 0.0 else -1.0, 0.0))
    return None
