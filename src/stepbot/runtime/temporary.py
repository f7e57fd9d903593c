"""One folder for the temporary files of a run, and of all processes that it starts.

A worker is killed when nobody waits for it any more, and what is killed removes nothing. So workers put their temporary
files into a folder of whoever started them, which removes it when it ends. What a killed run has left is removed by the
next one: a run holds a lock on its folder, which the system releases however the run ends.
"""

import atexit
import os
import shutil
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

if sys.platform != "win32":
    import fcntl

_PREFIX = "stepbot-run-"
_ABANDONED_AFTER = 24 * 3600.0
"""Age [s] from which a folder belongs to a run that was killed, where there are no locks."""


@cache
def run_folder() -> Path:
    """The folder of this process; made when it is first asked for, removed when the process ends.

    Raises:
        OSError: It cannot be made.
    """
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
        if _is_taken(folder):
            atexit.register(_remove, folder, os.getpid())
            _remove_abandoned(folder)
            return folder


def _is_taken(folder: Path) -> bool:
    """Lock a folder for as long as this process runs; False where another run took it for abandoned just now."""
    if sys.platform == "win32":
        return True
    try:
        handle = os.open(folder, os.O_RDONLY)
    except FileNotFoundError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_there = folder.exists()
    except BlockingIOError:
        is_there = False
    except OSError:  # a file system without locks: nobody will take the folder for abandoned
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
        except OSError:  # another run removes it at this moment
            continue


def _remove_unlocked(folder: Path) -> None:
    """Remove the folder of a run that has ended.

    Raises:
        OSError: The run goes on, or this is no folder.
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
    if os.getpid() == owner:  # not in a process that was forked from it
        shutil.rmtree(folder, ignore_errors=True)
