"""Planes, cylinders, cones and spheres that a file writes as free-form surfaces: B-splines, swept or revolved curves.

The kernel fits the surface. A deviation up to the tolerance moves the axis of a face that covers
a quarter of the circumference or more by less than ten times as much, 1e-6 m.
"""

from collections import Counter
from collections.abc import Iterable
from typing import Any

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Cone, gp_Cylinder, gp_Pln, gp_Sphere
from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition

from stepbot.step.kernel import KERNEL_ERRORS, OUT_OF_MEMORY

FREE_FORMS = (
    GeomAbs_SurfaceType.GeomAbs_BSplineSurface,
    GeomAbs_SurfaceType.GeomAbs_BezierSurface,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfRevolution,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfExtrusion,
)
_TOLERANCE = 1e-4
"""Maximum deviation [mm] of a free-form surface from a plane or quadric."""


def revolved(face: Any) -> gp_Cylinder | gp_Cone | None:
    """The cylinder or cone that a free-form face is on; None if it is on neither, or the kernel fails on it."""
    return _first(face, (("IsCylinder", gp_Cylinder()), ("IsCone", gp_Cone())))


def recognized(face: Any) -> gp_Pln | gp_Cylinder | gp_Cone | gp_Sphere | None:
    """The plane, cylinder, cone or sphere that a free-form face is on; None as for :func:`revolved`."""
    forms = ("IsPlane", gp_Pln()), ("IsCylinder", gp_Cylinder()), ("IsCone", gp_Cone()), ("IsSphere", gp_Sphere())
    return _first(face, forms)


def _first(face: Any, forms: Iterable[tuple[str, Any]]) -> Any:
    """The first form that the face has, fitted to it.

    Each is tried alone: the kernel fails on some faces, with a null curve or a division by zero.
    """
    for test, form in forms:
        try:
            if getattr(ShapeAnalysis_CanonicalRecognition(face), test)(_TOLERANCE, form):
                return form
        except OUT_OF_MEMORY:
            raise
        except KERNEL_ERRORS:
            continue
    return None


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
