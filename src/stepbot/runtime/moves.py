"""Moves the new files of a run to their destinations, all or none, and makes and removes the folders they need.

It finds first which files the run must not replace: those that stepbot did not write, or that were edited since.
"""

import errno
import hashlib
import os
import re
from collections.abc import Collection, Mapping
from pathlib import Path
from stat import S_ISDIR, S_ISLNK, S_ISREG

from .file import exists, is_folder, open_regular, read_regular

_MARK = re.compile(rb'(?m)^[ \t]*(?:(?:<!--|#|doc = ")[ \t]*Written by stepbot\b|"generator": "stepbot )')
"""A line of the start of every robot file and report that stepbot writes; meshes have no place for it."""
_HEAD = 512
"""Length [bytes] of what is searched for the mark."""


def kept_files(files: Mapping[str, bytes], folder: Path, written: Mapping[str, Collection[str]]) -> dict[str, str]:
    """Files to write that must stay as they are, in order, each with the reason.

    An output folder whose list was lost, as in a repository that ignores hidden files, is recognised by marked files.

    Args:
        files: New content by path relative to ``folder``.
        written: For each file of its list the SHA-256 of all that it may hold; empty if there is no list.
    """
    # Without its list, a folder is stepbot's if it has a marked file; files without marks cannot be distinguished.
    is_lost = not written and any(_is_marked(folder / path) for path in files if "/" not in path)
    kept = {}
    for path, content in files.items():
        without_mark = is_lost and not _is_marked_by(content)
        reason = _reason_to_keep(folder / path, content, written.get(path), without_mark)
        if reason:
            kept[path] = reason
    return kept


def _reason_to_keep(target: Path, content: bytes, written: Collection[str] | None, may_be_ours: bool) -> str:
    """Why a file must stay; empty if it may be replaced, or need not be.

    Args:
        written: SHA-256 of what stepbot wrote there; None if the list does not have the file.
        may_be_ours: Whether a file that is not in the list counts as one of stepbot's, even without its mark.
    """
    try:
        mode = target.lstat().st_mode
        if S_ISLNK(mode) or S_ISDIR(mode):  # a link is replaced, its target is not; a folder cannot be replaced
            return ""
        if not S_ISREG(mode):
            return "exists, and is not a regular file"
        there = read_regular(target)
    except OSError:  # there is none, or it cannot be replaced either
        return ""
    if there == content:
        return ""
    if written is not None:
        return "" if not there or hashlib.sha256(there).hexdigest() in written else "was edited since stepbot wrote it"
    return "" if may_be_ours or _is_marked_by(there) else "exists, and stepbot has not written it"


def _is_marked(target: Path) -> bool:
    try:
        with open_regular(target) as file:
            return _is_marked_by(file.read(_HEAD))
    except OSError:
        return False


def _is_marked_by(content: bytes) -> bool:
    return _MARK.search(content[:_HEAD]) is not None


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
