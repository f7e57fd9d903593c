"""Sews a solid whose faces meet but do not share their edges, as exported by surface modellers.

The faces themselves are unchanged: a gap between two edges becomes one edge. So the volume changes by at most the area
times the gap, and if that could exceed a thousandth, nothing is sewn.
"""

from typing import Any

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

from ..kernel import MILLIMETRES_PER_METRE
from ..topology import faces_of
from .exact import integrate, surface_area
from .healing import Healed

_GAP = 1e-3
"""Gap [mm] that is sewn even if the file claims a higher precision."""
_MOST_CHANGED = 1e-3
"""Maximum relative change of volume by sewing."""


def sewn(body: Healed, precision: float) -> Healed | None:
    """The body as one closed solid, its faces outwards; None if gaps remain, or are too wide to be sure.

    Args:
        body: A solid with edges that belong to only one face [mm].
        precision: Its uncertainty [mm].
    """
    gap = max(precision, _GAP)
    sewing = BRepBuilderAPI_Sewing(gap)
    faces = faces_of(body.shape)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shells = TopExp_Explorer(sewing.SewedShape(), TopAbs_ShapeEnum.TopAbs_SHELL)
    if sewing.NbFreeEdges() or not shells.More():
        return None
    shell = TopoDS.Shell(shells.Current())
    shells.Next()
    if shells.More():  # nesting of several solids cannot be decided by sewing
        return None
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    volume = integrate(solid).Mass()
    if surface_area(solid) * MILLIMETRES_PER_METRE**2 * gap > _MOST_CHANGED * abs(volume):
        return None
    origin = _origin(body, faces, sewing, solid)
    return Healed(solid if volume > 0.0 else solid.Reversed(), origin)


def _origin(body: Healed, faces: list[Any], sewing: Any, solid: Any) -> list[int]:
    """For each face of the solid, its original face before healing."""
    became = [sewing.Modified(face) if sewing.IsModified(face) else face for face in faces]
    return [
        next((origin for old, origin in zip(became, body.origin, strict=True) if old.IsSame(face)), -1)
        for face in faces_of(solid)
    ]
