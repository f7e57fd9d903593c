"""How far the processes of a run are with work on many inputs.

A process creates a file in the run's folder of temporary files, named after the work, and appends a byte for each
input that is done. That needs no lock, and what a killed process leaves is removed with the folder.
"""

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from msgspec import Struct

from .temporary import is_run_folder, run_folder

_PREFIX = "progress"


class Count(Struct, frozen=True):
    """The inputs of one kind of work."""

    work: str
    """In words: "bodies"."""
    done: int
    total: int
    seconds: float
    """Time since the first one was started."""

    @property
    def per_second(self) -> float:
        """Rate; 0 before the first one is done."""
        return self.done / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def remaining(self) -> float | None:
        """Estimate [s] of the time that the others take; None before the first one is done."""
        return (self.total - self.done) / self.per_second if self.per_second else None


@contextmanager
def counted(work: str, total: int) -> Iterator[Callable[[], None]]:
    """Yield a function to call with each input that is done, also in processes forked within the block.

    Args:
        work: What is counted, in words; empty for what is not shown.
    """
    folder = Path(tempfile.gettempdir())
    if not (work and is_run_folder(folder)):  # in the process of the command itself
        yield lambda: None
        return
    path = folder / f"{_PREFIX}-{os.getpid()}-{time.time():.3f}-{total}-{work}"
    file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    try:
        yield lambda: _append(file)
    finally:
        os.close(file)
        with suppress(OSError):  # Windows does not remove a file that another process has open
            path.unlink()


def counts() -> tuple[Count, ...]:
    """The work in progress in the processes of this run, the latest first."""
    counted = []
    for path in run_folder().glob(f"{_PREFIX}-*"):
        with suppress(OSError):  # it ends meanwhile
            _, _, start, total, work = path.name.split("-", 4)
            done, seconds = path.stat().st_size, time.time() - float(start)
            counted.append((float(start), Count(work, done, int(total), max(seconds, 0.0))))
    return tuple(count for _, count in sorted(counted, key=lambda one: -one[0]))


def _append(file: int) -> None:
    os.write(file, b".")
