"""Functions called in workers by tests."""

import ctypes
import importlib
import os
import sys
import threading
import time

from stepbot.runtime.processes import thread_count

_PREPARED: list[int] = []


def prepare() -> None:
    """Count the calls; the worker calls this before it reads its arguments."""
    _PREPARED.append(1)


def prepared() -> int:
    """Number of calls of ``prepare``."""
    return len(_PREPARED)


def double(number: int) -> int:
    """Twice the number."""
    return 2 * number


def double_or_leave(number: int | None) -> int:
    """Twice the number; without a number the process ends."""
    if number is None:
        os._exit(3)
    return 2 * number


def exit_with(message: str) -> None:
    """Raise SystemExit with a message, as Drake's bindings do."""
    sys.exit(message)


def start_thread() -> None:
    """Leave a thread running, as some libraries do when imported."""
    threading.Thread(target=time.sleep, args=(600.0,), daemon=True).start()


def thread_limits() -> set[str | None]:
    """The thread settings in the environment."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return {os.environ.get(name) for name in names}


def multiply_matrices() -> int:
    """Number of threads of this process after numpy's linear algebra."""
    import numpy as np

    square = np.ones((600, 600))
    assert (square @ square)[0, 0] == 600.0
    return thread_count()


def imported_file(module: str) -> str:
    """Path of a module."""
    return str(importlib.import_module(module).__file__)


def fail(text: str) -> None:
    """Raise an error."""
    raise ValueError(text)


def print_natively(text: str) -> str:
    """Write to descriptor 1 without Python's stream."""
    os.write(1, text.encode())
    return text


def hang(*_arguments: object) -> None:
    """Never answer."""
    time.sleep(600.0)


def crash(text: str) -> None:
    """Read from address 0 after printing some lines."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()
    ctypes.string_at(0)


def leave(code: int) -> None:
    """End the process."""
    os._exit(code)


def sleep(seconds: float) -> float:
    """Sleep for some seconds."""
    time.sleep(seconds)
    return seconds


def allocate(size: int) -> int:
    """Allocate some bytes."""
    return len(bytearray(size))
