"""How many faces of each kind a body has: what is left of its faces when their order and numbers change."""

from collections import Counter
from typing import Any

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_SurfaceType

_KINDS = {
    GeomAbs_SurfaceType.GeomAbs_Plane: "plane",
    GeomAbs_SurfaceType.GeomAbs_Cylinder: "cylinder",
    GeomAbs_SurfaceType.GeomAbs_Cone: "cone",
    GeomAbs_SurfaceType.GeomAbs_Sphere: "sphere",
    GeomAbs_SurfaceType.GeomAbs_Torus: "torus",
}
_OTHER = "other"


def face_counts(faces: list[Any]) -> tuple[tuple[str, int], ...]:
    """How many of a body's faces lie on each kind of surface, as the file writes it; by name."""
    return tuple(sorted(Counter(_KINDS.get(BRepAdaptor_Surface(face).GetType(), _OTHER) for face in faces).items()))
