"""Functions for the tests of isolation to call in workers."""

import ctypes
import os
import sys
import time

_PREPARED: list[int] = []


def prepare() -> None:
    """Called by the worker before it reads its arguments."""
    _PREPARED.append(1)


def prepared() -> int:
    """How often the worker prepared."""
    return len(_PREPARED)


def double(number: int) -> int:
    """Twice the number."""
    return 2 * number


def double_or_leave(number: int | None) -> int:
    """Twice the number; without one the process ends."""
    if number is None:
        os._exit(3)
    return 2 * number


def fail(text: str) -> None:
    """Raise."""
    raise ValueError(text)


def print_natively(text: str) -> str:
    """Write to descriptor 1, past Python."""
    os.write(1, text.encode())
    return text


def crash(text: str) -> None:
    """Read from address 0, after some last words."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()
    ctypes.string_at(0)


def leave(code: int) -> None:
    """End the process at once."""
    os._exit(code)


def sleep(seconds: float) -> float:
    """Take that long."""
    time.sleep(seconds)
    return seconds


def allocate(size: int) -> int:
    """Take that many bytes."""
    return len(bytearray(size))
