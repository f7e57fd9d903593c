"""Planes, cylinders, cones and spheres that a file writes as free-form surfaces: B-splines, swept or revolved curves.

The kernel fits the surface. A deviation up to the tolerance moves the axis of a face that covers
a quarter of the circumference or more by less than ten times as much, 1e-6 m.
"""

from typing import Any

from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Cone, gp_Cylinder, gp_Pln, gp_Sphere
from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition

FREE_FORMS = (
    GeomAbs_SurfaceType.GeomAbs_BSplineSurface,
    GeomAbs_SurfaceType.GeomAbs_BezierSurface,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfRevolution,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfExtrusion,
)
_TOLERANCE = 1e-4
"""Maximum deviation [mm] of a free-form surface from a plane or quadric."""


def revolved(face: Any) -> gp_Cylinder | gp_Cone | None:
    """The cylinder or cone that a free-form face is on; None if it is on neither."""
    recognition = ShapeAnalysis_CanonicalRecognition(face)
    cylinder, cone = gp_Cylinder(), gp_Cone()
    if recognition.IsCylinder(_TOLERANCE, cylinder):
        return cylinder
    return cone if recognition.IsCone(_TOLERANCE, cone) else None


def recognized(face: Any) -> gp_Pln | gp_Cylinder | gp_Cone | gp_Sphere | None:
    """The plane, cylinder, cone or sphere that a free-form face is on; None if it is on none of them."""
    plane, sphere = gp_Pln(), gp_Sphere()
    if ShapeAnalysis_CanonicalRecognition(face).IsPlane(_TOLERANCE, plane):
        return plane
    quadric = revolved(face)
    if quadric is not None:
        return quadric
    return sphere if ShapeAnalysis_CanonicalRecognition(face).IsSphere(_TOLERANCE, sphere) else None
