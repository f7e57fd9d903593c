"""Which tolerance holds for which body: a component takes the nearest claim, a body the finest of its components."""

from collections.abc import Sequence

from ..assembly import Component, MeshTolerance, ReadOptions
from .paths import ComponentPaths, inherited


def definition_tolerances(
    components: Sequence[Component], bodies: Sequence[int], options: ReadOptions
) -> list[tuple[MeshTolerance, ...]]:
    """For each distinct body the tolerances that its components claim, each once.

    Args:
        components: All components; a pattern that names none of them is for others to report.
        bodies: For each index that :attr:`Component.body` takes, which distinct body it shows.
        options: The default, and patterns with tolerances of their own; of equal claims the last one holds.
    """
    given: dict[int, MeshTolerance] = {}
    if options.tolerance_of:
        paths = ComponentPaths(components)
        for pattern, tolerance in options.tolerance_of:
            given |= dict.fromkeys(paths.find(pattern).topmost, tolerance)
    effective = inherited(components, given, options.tolerance)
    claimed: list[dict[MeshTolerance, None]] = [{} for _ in range(max(bodies, default=-1) + 1)]
    for component, tolerance in zip(components, effective, strict=True):
        if component.body >= 0:
            claimed[bodies[component.body]][tolerance] = None
    return [tuple(tolerances) or (options.tolerance,) for tolerances in claimed]
