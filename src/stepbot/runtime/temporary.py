"""One folder for the temporary files of a run and of all its processes.

Workers are killed when they are no longer needed, and a killed process removes nothing. So workers create their
temporary files in a folder of the process that started them, which removes it at its end. Leftovers of a killed run are
removed by the next one: a run holds a lock on its folder, which the system releases however the run ends.
"""

import atexit
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from functools import cache
from pathlib import Path

from .file import exists

if sys.platform != "win32":
    import fcntl

_PREFIX = "stepbot-run-"
_ABANDONED_AFTER = 24 * 3600.0
"""Age [s] from which a folder belongs to a killed run, on file systems without locks."""


@cache
def run_folder() -> Path:
    """The folder of this process; created on first use, removed when the process ends.

    Raises:
        OSError: It cannot be created.
    """
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
        if _is_taken(folder):
            atexit.register(_remove, folder, os.getpid())
            _remove_abandoned(folder)
            return folder


def is_run_folder(folder: Path) -> bool:
    """Whether it is the folder of a run: that of the process which started this one, in a worker."""
    return folder.name.startswith(_PREFIX)


def _is_taken(folder: Path) -> bool:
    """Lock a folder for the lifetime of this process; False if another run is just removing it as abandoned."""
    if sys.platform == "win32":
        return True
    try:
        handle = os.open(folder, os.O_RDONLY)
    except FileNotFoundError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_there = exists(folder)
    except BlockingIOError:
        is_there = False
    except OSError:  # a file system without locks: no run considers the folder abandoned
        return True
    if not is_there:
        os.close(handle)
    return is_there


def _remove_abandoned(mine: Path) -> None:
    for folder in mine.parent.glob(f"{_PREFIX}*"):
        if folder == mine:
            continue
        try:
            if sys.platform == "win32":
                if time.time() - folder.stat().st_mtime > _ABANDONED_AFTER:
                    shutil.rmtree(folder, ignore_errors=True)
            elif folder.lstat().st_uid == os.getuid():
                _remove_unlocked(folder)
        except OSError:  # another run is removing it
            continue


def _remove_unlocked(folder: Path) -> None:
    """Remove the folder of a run that has ended.

    Raises:
        OSError: The run is still active, or this is not a folder.
    """
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)
    finally:
        os.close(handle)


def _remove(folder: Path, owner: int) -> None:
    if os.getpid() != owner:  # a forked process
        return
    if threading.current_thread() is threading.main_thread():
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # they ask for what is being done
            if hasattr(signal, name):
                signal.signal(getattr(signal, name), signal.SIG_IGN)
    shutil.rmtree(folder, ignore_errors=True)
