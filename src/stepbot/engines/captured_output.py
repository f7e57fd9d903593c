"""Captures what engines print and log: the only way to get PyBullet's warnings, and those of Python libraries."""

import ctypes
import logging
import os
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def printed() -> Iterator[list[str]]:
    """Collect the lines that native code prints to file descriptor 1; the list is filled at the end.

    In a worker, descriptor 1 is the file that the caller reads if the worker dies: it is read in place, so that a crash
    loses nothing. Elsewhere descriptor 1 is redirected to a temporary file.
    """
    lines: list[str] = []
    sys.stdout.flush()
    with _readable_output() as descriptor:
        _flush_native()
        start = os.lseek(descriptor, 0, os.SEEK_END)
        try:
            yield lines
        finally:
            _flush_native()
            size = os.lseek(descriptor, 0, os.SEEK_END) - start
            os.lseek(descriptor, start, os.SEEK_SET)
            text = os.read(descriptor, size).decode("utf-8", "replace")
            os.lseek(descriptor, 0, os.SEEK_END)
            lines += [line.strip() for line in text.splitlines() if line.strip()]


@contextmanager
def logged(name: str) -> Iterator[list[str]]:
    """Collect the messages of a logger of Python from warning level up, in place of what handles them otherwise."""
    messages: list[str] = []

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            messages.append(record.getMessage())

    logger, collector = logging.getLogger(name), Collector(logging.WARNING)
    handed_on, logger.propagate = logger.propagate, False
    logger.addHandler(collector)
    try:
        yield messages
    finally:
        logger.removeHandler(collector)
        logger.propagate = handed_on


@contextmanager
def _readable_output() -> Iterator[int]:
    """A descriptor that reads what was printed to descriptor 1."""
    if _is_readable_file(1):
        yield 1
        return
    kept = os.dup(1)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 1)
        try:
            yield file.fileno()
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def _is_readable_file(descriptor: int) -> bool:
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        return False
    end = os.lseek(descriptor, 0, os.SEEK_END)
    try:
        os.read(descriptor, 1)
    except OSError:  # opened for writing only
        return False
    os.lseek(descriptor, end, os.SEEK_SET)
    return True


def _flush_native() -> None:
    """Flush the C library's own buffers; without a common C library (Windows), engines flush their own output."""
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)
