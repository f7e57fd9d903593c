"""Moves the new files of a run to their destinations, all or none, and makes and removes the folders they need."""

import errno
import os
from pathlib import Path
from stat import S_ISREG

from .file import exists, is_folder, read_regular


def move(paths: list[str], folder: Path, staging: Path) -> None:
    """Move new files to their destinations; if one fails, restore the previous files."""
    moved: list[tuple[Path, Path | None]] = []
    try:
        for number, path in enumerate(paths):
            target, backup = folder / path, staging / f"{number}.old"
            kept = backup if _keep(target, backup) else None
            (staging / f"{number}.new").replace(target)
            moved.append((target, kept))
    except BaseException:
        for target, kept in reversed(moved):
            if kept is None:
                target.unlink(missing_ok=True)
            else:
                kept.replace(target)
        raise


def _keep(target: Path, backup: Path) -> bool:
    """Keep the file at ``target`` under a second name; False if there is none."""
    if not os.path.lexists(target):
        return False
    try:
        os.link(target, backup, follow_symlinks=False)
    except (OSError, NotImplementedError):  # no hard links on this file system
        import shutil

        shutil.copy2(target, backup, follow_symlinks=False)
    return True


def holds(target: Path, content: bytes) -> bool:
    """Whether ``target`` is a regular file with this content."""
    try:
        status = target.lstat()
        return S_ISREG(status.st_mode) and status.st_size == len(content) and read_regular(target) == content
    except OSError:
        return False


def make_folders(folder: Path, made: list[Path]) -> None:
    """Create a folder and its missing parents, which are added to ``made``, top first."""
    missing = [path for path in (folder, *folder.parents) if not exists(path)]
    for path in reversed(missing):
        path.mkdir(exist_ok=True)
        made.append(path)
    if not is_folder(folder):
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def remove_if_empty(folder: Path) -> None:
    """Remove a folder unless something is in it."""
    try:
        folder.rmdir()
    except OSError:  # another process put something there: it is kept
        return
