"""Meshes that together have at most so many triangles, all with about the same deviation."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from .mesh import TriMesh, joined
from .simplification import Simplification

_FIRST, _LAST = 2.0**-17, 2.0**6
"""Smallest and largest limit of error, as a share of the largest diagonal: it is a sum over hundreds of planes."""
_STEP = sqrt(2.0)
_DECIMALS = 7
"""Of deviations [m]."""


@dataclass(frozen=True, eq=False)
class Unit:
    """Meshes with common borders, such as the colours of a part."""

    meshes: tuple[TriMesh, ...]
    count: int
    """How often it is drawn."""


@dataclass(frozen=True, eq=False)
class TriangleBudget:
    """Units that share a budget."""

    units: tuple[Unit, ...]
    max_triangles: int
    """Of all that is drawn."""


@dataclass(frozen=True, eq=False)
class Simplified:
    """The simplified meshes of a budget."""

    units: tuple[tuple[TriMesh, ...], ...]
    """For each unit, its meshes; one may be without faces."""
    triangles: int
    """Of all that is drawn; more than the budget if there is no simpler shape."""
    deviation: float
    """The largest distance [m] between a mesh and its simplified form, in either direction, to 0.1 micrometres."""


def simplified(budget: TriangleBudget) -> Simplified:
    """Collapse edges of all units with the same limit of error, which increases until the budget is met."""
    states = [_started(unit) for unit in budget.units]
    counts = [unit.count for unit in budget.units]
    largest = max((_diagonal(state.original) for state in states), default=0.0)
    error = _FIRST * largest
    while _drawn(states, counts) > budget.max_triangles and error <= _LAST * largest:
        # Largest first: the last ones may stay finer.
        for index in sorted(range(len(states)), key=lambda i: -counts[i] * len(states[i].faces)):
            surplus = _drawn(states, counts) - budget.max_triangles
            if surplus > 0:
                faces = len(states[index].faces) - -(-surplus // counts[index])
                states[index].reduce(error, max(faces, 0))
        error *= _STEP
    units, deviation = [], 0.0
    for unit, state in zip(budget.units, states, strict=True):
        if len(state.faces) < len(state.original.faces):
            deviation = max(deviation, state.deviation())
            units.append(tuple(state.piece(label) for label in range(len(unit.meshes))))
        else:
            units.append(unit.meshes)
    return Simplified(tuple(units), _drawn(states, counts), round(deviation, _DECIMALS))


def all_simplified(budgets: Sequence[TriangleBudget]) -> tuple[Simplified, ...]:
    """The result of :func:`simplified` for each budget."""
    return tuple(map(simplified, budgets))


def _started(unit: Unit) -> Simplification:
    labels = np.repeat(np.arange(len(unit.meshes), dtype=np.int32), [len(mesh.faces) for mesh in unit.meshes])
    return Simplification.of(joined(list(unit.meshes)), labels)


def _drawn(states: Sequence[Simplification], counts: Sequence[int]) -> int:
    return sum(len(state.faces) * count for state, count in zip(states, counts, strict=True))


def _diagonal(mesh: TriMesh) -> float:
    return float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) if len(mesh.vertices) else 0.0
