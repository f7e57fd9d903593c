"""How worker processes are started, with which environment and import path, and how they end with their parent."""

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import TypeVar

from .import_path import safe_import_path
from .temporary import run_folder

T = TypeVar("T")
NO_FORK = "STEPBOT_NO_FORK"
"""Variable that, set to anything, has stepbot start every process as a new interpreter."""

_PR_SET_PDEATHSIG = 1
_THREAD_NUMBERS = (
    "BLIS_NUM_THREADS",
    "GOTO_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_DEFAULT_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "RAYON_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Variables that native libraries read when they are loaded."""


def interpreter(code: str, *arguments: str) -> list[str]:
    """Command line of an interpreter that runs ``code``, and imports nothing from the current folder."""
    return [sys.executable, "-P", "-c", code, *arguments]


def start_process(start: Callable[[], T]) -> T:
    """Call what starts a process in a thread that lives as long as this process, on the caller's cores.

    Linux ends a process that asked for it (:func:`end_with_parent`) with the *thread* that started it.
    """
    cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None

    def start_on_cores() -> T:
        if cores is not None:
            os.sched_setaffinity(0, cores)
        return start()

    return _starter().submit(start_on_cores).result()


@cache
def _starter() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "stepbot-starter")


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_starter.cache_clear)  # a forked process has no such thread


def can_fork() -> bool:
    """Whether processes can be forked safely: not on macOS, whose system libraries may not survive it.

    With :data:`NO_FORK` every system does without, as macOS and Windows must.
    """
    return hasattr(os, "fork") and sys.platform != "darwin" and not os.environ.get(NO_FORK)


def thread_count() -> int:
    """Threads of this process, those of native libraries too; Python's own where the system does not list them."""
    try:
        return sum(1 for _ in Path("/proc/self/task").iterdir())
    except OSError:
        return threading.active_count()


def end_with_parent(parent: int) -> None:
    """Have the system end this process when its parent is ended, in whatever way: Linux only.

    Args:
        parent: The parent's process id. If the parent has ended already, this process ends at once.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)


def worker_environment() -> dict[str, str]:
    """The caller's environment and its import path, without the current folder, and one thread per native library.

    The user's own number of threads does not count: the fork server must have one thread, and results must not depend
    on the number.
    """
    paths = safe_import_path(sys.path, os.environ.get("PYTHONPATH", ""))
    paths = [path for path in paths if os.pathsep not in path]  # it would be read as two, the second one relative
    one_thread = dict.fromkeys(_THREAD_NUMBERS, "1")
    own = {
        "PYTHONPATH": os.pathsep.join(paths),
        "PYTHONSAFEPATH": "1",  # packages start interpreters of their own when they are imported
        "PYTHONIOENCODING": "utf-8",
        "TMPDIR": str(run_folder()),  # they are killed, and remove nothing then
        "MUJOCO_GL": "disable",  # nothing is drawn: no OpenGL to look for, and none to fail
    }
    return {**os.environ, **one_thread, **own}
