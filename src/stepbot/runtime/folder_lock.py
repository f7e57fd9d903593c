"""Exclusive lock of a folder, across processes; the system releases the lock of a process that dies."""

import contextlib
import errno
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

LOCK = ".stepbot.lock"
"""File that is locked on Windows, where folders cannot be."""
_POLL = 0.02
_TAKEN = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)


class FolderInUse(Exception):
    """Another process held the lock for too long."""


@contextlib.contextmanager
def locked(folder: Path, seconds: float) -> Iterator[bool]:
    """Hold the lock of an existing folder.

    Yields:
        Whether the lock is held: some network file systems do not support locks.

    Args:
        folder: The folder.
        seconds: How long to wait for another process.

    Raises:
        FolderInUse: The other process still holds the lock after that time.
        OSError: The folder cannot be opened.
    """
    descriptor = _opened(folder)
    try:
        deadline = time.monotonic() + seconds
        while (taken := _take(descriptor)) is None:
            if time.monotonic() > deadline:
                raise FolderInUse(f"folder {folder} is locked by another process (waited {seconds:g} s)")
            time.sleep(_POLL)
        yield taken
    finally:
        os.close(descriptor)  # which releases it
        if sys.platform == "win32":
            with contextlib.suppress(OSError):  # another process has it open
                (folder / LOCK).unlink()


def _opened(folder: Path) -> int:
    return os.open(folder / LOCK, os.O_RDWR | os.O_CREAT) if sys.platform == "win32" else os.open(folder, os.O_RDONLY)


def _take(descriptor: int) -> bool | None:
    """True if the lock was acquired, False if the file system has no locks, None if another process holds it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return None if error.errno in _TAKEN else False
    return True
