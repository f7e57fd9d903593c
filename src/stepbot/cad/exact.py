"""Mass properties of the exact B-rep, by the kernel's integration over its faces (GProp).

The plain integration is exact to 1e-14 on planes, quadrics and tori, and usually to 1e-6. Not so on rational B-splines:
of a cylinder in that form it misses 0.9 % of the volume and 2 % of the inertia. The adaptive one gets those to 1e-7 and
2e-5, for up to ten times the time, but is off by 1e-5 elsewhere. So it serves where the mesh gives reason to doubt the
plain one, and counts where the two disagree. (Measured on closed forms, and on the validation volumes that CAD programs
wrote into their files.)
"""

from typing import Any

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GProp import GProp_GProps

from .assembly import VolumeProperties
from .step import MILLIMETRES_PER_METRE

_SPLINES = (GeomAbs_SurfaceType.GeomAbs_BSplineSurface, GeomAbs_SurfaceType.GeomAbs_BezierSurface)
_ADAPTIVE = 1e-9
"""Relative error at which the adaptive integration ends."""
_ADAPTIVE_AREA = 1e-6
"""The same for areas, where the plain integration misses up to 1e-3 of a rational B-spline."""


def integrate(shape: Any) -> Any:
    """The kernel's ``GProp_GProps`` of the volume that a shape encloses [mm]."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties


def integrate_adaptively(shape: Any) -> Any:
    """The same by subdividing faces until the volume does not change any more."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, _ADAPTIVE, False, False)
    return properties


def surface_area(shape: Any) -> float:
    """Area [m^2] of all faces, by subdividing them until it does not change any more; 0 where it is not a number."""
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, properties, _ADAPTIVE_AREA, False)
    area = properties.Mass() / MILLIMETRES_PER_METRE**2
    return float(area) if np.isfinite(area) else 0.0


def has_rational_faces(faces: list[Any]) -> bool:
    """Whether any face is a rational B-spline, on which the plain integration can be far off."""
    surfaces = (BRepAdaptor_Surface(face) for face in faces)
    return any(s.GetType() in _SPLINES and (s.IsURational() or s.IsVRational()) for s in surfaces)


def volume_properties(properties: Any) -> VolumeProperties | None:
    """In SI; None for no volume at all, or one that is not a number.

    The kernel gives the inertia about the centre of mass, along the axes of the shape's frame.
    """
    volume = properties.Mass()
    center, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    com = np.array([center.X(), center.Y(), center.Z()])
    inertia = np.array([[matrix.Value(row, column) for column in (1, 2, 3)] for row in (1, 2, 3)])
    if not (volume > 0.0 and np.isfinite(volume) and np.isfinite(com).all() and np.isfinite(inertia).all()):
        return None
    scale = MILLIMETRES_PER_METRE
    return VolumeProperties.of(volume / scale**3, com / scale, inertia / scale**5)
