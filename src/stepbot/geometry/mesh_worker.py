"""Mesh computations in a separate process: trimesh measures, manifold3d intersects.

The converting process needs neither, and continues meanwhile. manifold3d uses all cores through threads that a forked
process does not inherit: a fork after its first use would wait for them forever. This process forks only as long as it
has no threads.
"""

import sys
from collections.abc import Callable
from typing import Any

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.worker import WorkerDied

from . import mass_properties as measure
from .simplification import all_simplified
from .solids import manifolds
from .solids.collision_scores import collision_scores
from .solids.collision_sets import collision_sets
from .solids.overlapping import overlaps_of

MESH_WORKER = "stepbot.geometry.mesh_worker:compute"
"""The function that runs there; it handles one call after the other."""

_TASKS: dict[str, Callable[[Any], Any]] = {
    "measures": lambda meshes: tuple(map(measure.measured, meshes)),
    "collisions": collision_sets,
    "overlaps": overlaps_of,
    "scores": collision_scores,
    "simplified": all_simplified,
}


def prepare() -> None:
    """Import both libraries, while the kernel is still at work."""
    measure.prepare()
    manifolds.prepare()


def compute(task: str, question: Any) -> Any:
    """``measures`` of meshes, ``collisions`` of solids, ``overlaps`` of a search, ``scores`` of shapes, ``simplified``.

    See :func:`.measured`, :func:`.collision_sets`, :func:`.overlaps_of`, :func:`.collision_scores` and
    :func:`.all_simplified`.
    """
    try:
        return _TASKS[task](question)
    except WorkerDied as death:  # a process that this one has started: end like it
        sys.stderr.write(f"{death.reason}\n")
        sys.exit(1)


def report_death(death: WorkerDied, work: str, span: Span, diagnostics: Diagnostics) -> None:
    """Report that the process ended without a result.

    Args:
        work: Its task, as in "the process that measures meshes".
        diagnostics: Receives SB902.
    """
    remedies = ["raise `--timeout` or `--memory-limit`"]
    diagnostics.add(
        "SB902", f"the process that {work} ended: {death.reason}", span, help=remedies, notes=death.last_lines
    )
