"""Measuring meshes: refined until trimesh's mass properties agree with the exact shape (``mass: mesh``)."""

import math
from dataclasses import dataclass
from typing import Any

from stepbot.geometry.mass_properties import measured
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.volume import VolumeProperties

from ..kernel import MILLIMETRES_PER_METRE
from .tessellation import Fineness, tessellated_once

MAX_MEASURING_FACES = 1_000_000
"""Number of faces beyond which a measuring mesh is not refined further."""

_AIM = 0.7
"""Share of the wanted deviation that the next mesh aims at."""
_FINEST_STEP = 0.2
_COARSEST_STEP = 0.8
_UNCLOSED = 4
"""Number of meshes with holes after which refinement is given up; most bodies close again a little finer."""


@dataclass(frozen=True)
class Refinement:
    """The result of refinement."""

    properties: VolumeProperties | None = None
    """By trimesh from the best mesh; None if none was watertight."""
    shortfall: str = ""
    """Why the agreement was not reached, for messages."""


def refine(shape: Any, mesh: TriMesh, start: Fineness, exact: VolumeProperties | None, wanted: float) -> Refinement:
    """Refine the mesh of a solid until its mass properties agree.

    Args:
        shape: A healed solid [mm].
        mesh: Its existing mesh.
        start: Tolerance of that mesh.
        exact: Its mass properties; None to accept the first mesh without a comparison.
        wanted: Largest relative deviation.
    """
    fine, best, off = start, None, math.inf
    unclosed = 0
    while True:
        found = measured(mesh)
        if found is None:
            unclosed += 1
            if unclosed > _UNCLOSED:
                return Refinement(best, "its measuring mesh is not watertight")
            step = _COARSEST_STEP
        elif exact is None:
            return Refinement(found)
        else:
            now = found.deviation_from(exact)[0]
            if now < off:
                best, off = found, now
            if off <= wanted:
                return Refinement(best)
            # A mesh's deviation grows with the square of its tolerances; so does, at most, the number of its faces.
            step = min(max(math.sqrt(_AIM * wanted / now), _FINEST_STEP), _COARSEST_STEP)
        if len(mesh.faces) > MAX_MEASURING_FACES * step**2:
            return Refinement(
                best, f"a measuring mesh of {len(mesh.faces)} faces still differs from the exact shape by {off:.1e}"
            )
        fine = fine.scaled(step)
        result = tessellated_once(shape, fine)
        mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
