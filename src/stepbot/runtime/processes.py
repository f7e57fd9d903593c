"""Starts worker processes: their environment and import path, and how they end with their parent."""

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from queue import SimpleQueue
from typing import Any, TypeVar, cast

from .import_path import safe_import_path
from .temporary import run_folder

T = TypeVar("T")
NO_FORK = "STEPBOT_NO_FORK"
"""Variable that, if set to anything, makes stepbot start every process as a new interpreter."""

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
    """Command line of an interpreter that runs ``code`` and imports nothing from the current folder."""
    return [sys.executable, "-P", "-c", code, *arguments]


def start_process(start: Callable[[], T]) -> T:
    """Start a process from a thread that lives as long as this process, on the caller's cores.

    With :func:`end_with_parent`, Linux ends a process together with the *thread* that started it.
    """
    cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None

    def start_on_cores() -> T:
        if cores is not None:
            os.sched_setaffinity(0, cores)
        return start()

    answer: SimpleQueue[tuple[Any, BaseException | None]] = SimpleQueue()
    _starter().put((start_on_cores, answer))
    started, error = answer.get()
    if error is not None:
        raise error
    return cast(T, started)


@cache
def _starter() -> "SimpleQueue[tuple[Callable[[], Any], SimpleQueue[Any]]]":
    """The queue of a daemon thread: functions, each with a queue for its result or exception.

    An executor of the standard library joins its thread at exit; after Ctrl-C during the start of the thread, it never
    requests its end, and waits forever. This thread is never joined.
    """
    orders: SimpleQueue[tuple[Callable[[], Any], SimpleQueue[Any]]] = SimpleQueue()
    threading.Thread(target=_start_all, args=(orders,), name="stepbot-starter", daemon=True).start()
    return orders


def _start_all(orders: "SimpleQueue[tuple[Callable[[], Any], SimpleQueue[Any]]]") -> None:
    while True:
        start, answer = orders.get()
        try:
            answer.put((start(), None))
        except BaseException as error:  # noqa: BLE001 - raised by the caller
            answer.put((None, error))
        del start, answer  # a process that nobody waits for any more reads the end of its input


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_starter.cache_clear)  # a forked process has no such thread


def can_fork() -> bool:
    """Whether processes can be forked safely: not on macOS, whose system libraries may not survive it.

    :data:`NO_FORK` disables forking on every system.
    """
    return hasattr(os, "fork") and sys.platform != "darwin" and not os.environ.get(NO_FORK)


def thread_count() -> int:
    """Number of threads of this process, including those of native libraries if the system lists them."""
    try:
        return sum(1 for _ in Path("/proc/self/task").iterdir())
    except OSError:
        return threading.active_count()


def end_with_parent(parent: int) -> None:
    """Make the system end this process when its parent ends, for any reason: Linux only.

    Args:
        parent: The parent's process id. If the parent has ended already, this process ends at once.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)


def worker_environment() -> dict[str, str]:
    """The caller's environment and import path, without the current folder, and with one thread per native library.

    The user's thread settings are ignored: the fork server must have one thread, and results must not depend on the
    number.
    """
    paths = safe_import_path(sys.path, os.environ.get("PYTHONPATH", ""))
    # it would be split into two entries, the second one relative
    paths = [path for path in paths if os.pathsep not in path]
    one_thread = dict.fromkeys(_THREAD_NUMBERS, "1")
    own = {
        "PYTHONPATH": os.pathsep.join(paths),
        "PYTHONSAFEPATH": "1",  # some packages start interpreters during their import
        "PYTHONIOENCODING": "utf-8",
        "TMPDIR": str(run_folder()),  # workers are killed, and could not remove temporary files
        "MUJOCO_GL": "disable",  # nothing is rendered: OpenGL is not needed
    }
    return {**os.environ, **one_thread, **own}


def core_count() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
