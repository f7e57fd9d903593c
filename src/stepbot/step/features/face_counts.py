"""Number of faces of each kind of a body, which does not depend on their order and numbers."""

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
    """Number of a body's faces by the kind of their surface in the file, sorted by name."""
    return tuple(sorted(Counter(_KINDS.get(BRepAdaptor_Surface(face).GetType(), _OTHER) for face in faces).items()))
