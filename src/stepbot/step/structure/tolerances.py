"""Mesh tolerance of each body: a component uses the nearest match, a body the finest of its components."""

from collections.abc import Sequence

from ..assembly import Component, MeshTolerance, ReadOptions
from .paths import ComponentPaths, nearest_claim


def definition_tolerances(
    components: Sequence[Component], bodies: Sequence[int], options: ReadOptions
) -> list[tuple[MeshTolerance, ...]]:
    """For each distinct body, the distinct tolerances of its components.

    Args:
        components: All components; a pattern that matches none of them is reported elsewhere.
        bodies: For each index in :attr:`Component.body`, its distinct body.
        options: The default, and patterns with their tolerances; the nearest claim
            applies, as it does for links.
    """
    claims: list[tuple[Sequence[int], MeshTolerance]] = []
    if options.tolerance_of:
        paths = ComponentPaths(components)
        claims = [(paths.find(pattern).indices, tolerance) for pattern, tolerance in options.tolerance_of]
    effective = nearest_claim(components, claims, options.tolerance)
    claimed: list[dict[MeshTolerance, None]] = [{} for _ in range(max(bodies, default=-1) + 1)]
    for component, tolerance in zip(components, effective, strict=True):
        if component.body >= 0:
            claimed[bodies[component.body]][tolerance] = None
    return [tuple(tolerances) or (options.tolerance,) for tolerances in claimed]
