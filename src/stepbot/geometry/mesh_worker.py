"""What is computed on meshes in a process of its own: trimesh measures them, manifold3d intersects them.

The process that converts needs neither then, and goes on meanwhile. manifold3d works on all cores by itself, by threads
that no process inherits: whatever is forked after it was used waits for them forever. This process forks nothing.
"""

from collections.abc import Callable
from typing import Any

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.worker import WorkerDied

from . import mass_properties as measure
from .mass_properties import measured_all
from .solids import manifolds
from .solids.overlapping import overlaps_of

MESH_WORKER = "stepbot.geometry.mesh_worker:compute"
"""The function that runs there; it answers one call after the other."""

_TASKS: dict[str, Callable[[Any], Any]] = {"measures": measured_all, "overlaps": overlaps_of}


def prepare() -> None:
    """Do the slow imports, while the kernel is still at work."""
    measure.prepare()
    manifolds.prepare()


def compute(task: str, question: Any) -> Any:
    """``measures`` of meshes: see :func:`.measured_all`; ``overlaps`` of a search: see :func:`.overlaps_of`."""
    return _TASKS[task](question)


def report_death(death: WorkerDied, work: str, span: Span, found: Diagnostics) -> None:
    """Report that the process ended without an answer.

    Args:
        death: How it ended.
        work: What it was at work on, as in "the process that measures meshes".
        span: The place that diagnostics name.
        found: Receives SB902.
    """
    remedies = ["raise `--timeout` or `--memory-limit`"]
    found.add("SB902", f"the process that {work} ended: {death.reason}", span, help=remedies, notes=death.last_lines)
