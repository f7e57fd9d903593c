"""Measuring meshes: refined until what trimesh measures on them agrees with the exact shape (``mass: mesh``)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..measure import measured
from ..mesh import TriMesh
from .assembly import VolumeProperties
from .step import MILLIMETRES_PER_METRE
from .tessellation import Fineness, tessellated

MAX_MEASURING_FACES = 1_000_000
"""Faces beyond which a measuring mesh is not refined further."""

_STEP = 0.5


@dataclass(frozen=True)
class Refinement:
    """What measuring meshes gave."""

    properties: VolumeProperties | None = None
    """By trimesh from the last mesh; None where none was watertight."""
    shortfall: str = ""
    """Why the agreement was not reached, for people."""


def deviation(found: VolumeProperties, exact: VolumeProperties, size: float) -> float:
    """Largest relative deviation of two measurements of one body.

    Volume relative to the exact volume, com relative to the body's diagonal ``size`` [m], inertia relative to the
    largest principal moment.
    """
    a, b = found.unit_density, exact.unit_density
    inertia = np.array(b.inertia)
    largest = float(np.linalg.eigvalsh(inertia)[-1])
    return max(
        abs(found.volume - exact.volume) / exact.volume,
        float(np.linalg.norm(np.subtract(a.com, b.com))) / size if size > 0.0 else 0.0,
        float(np.abs(np.array(a.inertia) - inertia).max()) / largest if largest > 0.0 else 0.0,
    )


def refine(shape: Any, start: Fineness, size: float, exact: VolumeProperties | None, wanted: float) -> Refinement:
    """Mesh a solid ever more finely until its measured mass properties are right.

    Args:
        shape: A healed solid [mm].
        start: How finely it is meshed first.
        size: Its diagonal [mm].
        exact: What its mass properties are; None where there is nothing to compare with, and the first mesh serves.
        wanted: Largest relative deviation.
    """
    fine, best, off = start, None, float("inf")
    while True:
        result = tessellated(shape, fine)
        mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
        found = measured(mesh)
        if found is None:
            return Refinement(best, "its measuring mesh is not watertight")
        if exact is None:
            return Refinement(found)
        now = deviation(found, exact, size / MILLIMETRES_PER_METRE)
        if now < off:
            best, off = found, now
        if off <= wanted:
            return Refinement(best)
        # The next mesh has up to four times the faces.
        if len(mesh.faces) * 4 > MAX_MEASURING_FACES:
            return Refinement(
                best, f"a measuring mesh of {len(mesh.faces)} faces is still {off:.1e} off the exact shape"
            )
        fine = fine.scaled(_STEP)
