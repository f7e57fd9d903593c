"""Mass properties of the exact B-rep, by the kernel's integration over its faces (GProp).

It is exact to 1e-14 on planes, quadrics and tori between short edges. Elsewhere it is often off by 1e-5, and by 10 % on
faces with many spans, which it does not integrate span by span; with adaptive subdivision it ends at another value for
each tolerance. So :mod:`.error_estimate` compares it with stepbot's own integration. The kernel's Gauss-Kronrod
integration was within its claim on every solid tried, wavy plates included, and takes up to seconds.
"""

import math
from math import inf
from typing import Any

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from stepbot.geometry.mass_properties import measured
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.volume import VolumeProperties

from ..kernel import MILLIMETRES_PER_METRE
from .tessellation import Fineness, tessellated_once

_ADAPTIVE_AREA = 1e-6
"""Relative error at which the integration of areas ends; the plain one misses up to 1e-3 of a rational B-spline."""


def integrate(shape: Any) -> Any:
    """The kernel's ``GProp_GProps`` of the volume that a shape encloses [mm]."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties


def adaptive_volume(shape: Any, tolerance: float) -> tuple[float, float]:
    """Volume [m^3] by the kernel's Gauss-Kronrod integration, and the relative error that it claims."""
    properties = GProp_GProps()
    claimed = BRepGProp.VolumePropertiesGK_s(shape, properties, tolerance, False, False, False, False, False)
    return properties.Mass() / MILLIMETRES_PER_METRE**3, claimed if claimed >= 0.0 else inf


def surface_area(shape: Any) -> float:
    """Area [m^2] of all faces, by subdivision until it is constant; 0 if it is not a number."""
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, properties, _ADAPTIVE_AREA, False)
    area = properties.Mass() / MILLIMETRES_PER_METRE**2
    return float(area) if np.isfinite(area) else 0.0


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


MAX_MEASURING_FACES = 1_000_000
"""Number of faces beyond which a measuring mesh is not refined further."""

_AIM = 0.7
"""Share of the wanted deviation that the next mesh aims at."""
_FINEST_STEP = 0.2
_COARSEST_STEP = 0.8
_UNCLOSED = 4
"""Number of meshes with holes after which refinement is given up; most bodies close again a little finer."""


def refine(
    shape: Any, mesh: TriMesh, start: Fineness, exact: VolumeProperties | None, wanted: float
) -> tuple[VolumeProperties | None, str]:
    """Refine the mesh of a solid until its mass properties agree.

    Args:
        shape: A healed solid [mm].
        exact: Its mass properties; None to accept the first mesh without a comparison.
        wanted: Largest relative deviation.

    Returns:
        Mass properties by trimesh from the best mesh, None if none was watertight; and why the agreement was not
        reached, for messages.
    """
    fine, best, off = start, None, math.inf
    unclosed = 0
    while True:
        properties = measured(mesh)
        if properties is None:
            unclosed += 1
            if unclosed > _UNCLOSED:
                return best, "its measuring mesh is not watertight"
            step = _COARSEST_STEP
        elif exact is None:
            return properties, ""
        else:
            now = properties.deviation_from(exact)[0]
            if now < off:
                best, off = properties, now
            if off <= wanted:
                return best, ""
            # A mesh's deviation grows with the square of its tolerances; so does, at most, the number of its faces.
            step = min(max(math.sqrt(_AIM * wanted / now), _FINEST_STEP), _COARSEST_STEP)
        if len(mesh.faces) > MAX_MEASURING_FACES * step**2:
            return best, f"a measuring mesh of {len(mesh.faces)} faces still differs from the exact shape by {off:.1e}"
        fine = fine.scaled(step)
        result = tessellated_once(shape, fine)
        mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
