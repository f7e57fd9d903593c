"""The list of an output folder, ``.stepbot.json``: which files stepbot wrote, their content and their sidecars.

It has each robot file and its meshes, with a hash of the written content, and the sidecar of each robot file, so that
``stepbot uptodate`` can find the outputs of a sidecar.
"""

import contextlib
import errno
import hashlib
import json
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from .file import is_file, read_regular

LOCK = ".stepbot.lock"
"""File that is locked on Windows, where folders cannot be."""
_POLL = 0.02
_Value = TypeVar("_Value")
_TAKEN = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)


class FolderInUse(Exception):
    """Another process held the lock for too long."""


@contextlib.contextmanager
def locked(folder: Path, seconds: float) -> Iterator[bool]:
    """Hold the lock of an existing folder.

    Yields:
        Whether the lock is held: some network file systems do not support locks.

    Args:
        seconds: How long to wait for another process.

    Raises:
        FolderInUse: The other process still holds the lock after that time.
        OSError: The folder cannot be opened.
    """
    # On Windows folders cannot be locked.
    where, flags = (folder / LOCK, os.O_RDWR | os.O_CREAT) if sys.platform == "win32" else (folder, os.O_RDONLY)
    descriptor = os.open(where, flags)
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


MANIFEST = ".stepbot.json"
_PACKAGE = "CMakeLists.txt"
_IN_PACKAGE = ("config/", "launch/", "rviz/", "urdf/")
"""Folders of a ROS 2 package, which has that file."""
STAGING = ".stepbot-"
"""Start of the names of folders in which new files are created."""
_NEVER_IN_NAMES = frozenset("\\\0")
_NEVER_IN_WINDOWS_NAMES = frozenset('<>:"|?*')


Manifest = dict[str, dict[str, str]]
"""For each file at the top of the folder, itself and the files below that it needs, each with its SHA-256."""


class OutputList(NamedTuple):
    """The list of an output folder."""

    files: Manifest
    sidecars: Mapping[str, str] = {}
    """For each file at the top the relative path of its sidecar; empty or missing where it is not known."""
    robots: Mapping[str, str] = {}
    """For each file at the top its robot."""
    replaced: Mapping[str, list[str]] = {}
    """For each file that a killed run may not have replaced, the SHA-256 of what it may hold instead."""

    @classmethod
    def read(cls, folder: Path) -> "OutputList":
        """The list of earlier runs; empty if it is missing or unreadable: then nothing is removed.

        A pipe or device, which might block, is not read.
        """
        try:
            document = json.loads(read_regular(folder / MANIFEST)) if is_file(folder / MANIFEST) else {}
        except (OSError, ValueError, RecursionError):
            document = {}
        files = _mapping(document, "files", lambda needs: {str(path): str(digest) for path, digest in needs.items()})
        outside = {path for path in {path for needs in files.values() for path in needs} if not is_below(path)}
        if outside:
            files = {
                name: {path: needs[path] for path in needs if path not in outside} for name, needs in files.items()
            }
        replaced = _mapping(document, "replaced", lambda digests: list(map(str, digests)))
        return cls(files, _mapping(document, "sidecars", str), _mapping(document, "robots", str), replaced)

    @property
    def content(self) -> bytes:
        """The list as a file."""
        known = {name: sidecar for name, sidecar in self.sidecars.items() if sidecar}
        parts = {"sidecars": known, "robots": self.robots, "replaced": self.replaced}
        document = {"version": 1, "files": self.files, **{key: part for key, part in parts.items() if part}}
        text = json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
        return text.encode("utf-8", "backslashreplace")

    @property
    def written(self) -> dict[str, set[str]]:
        """For each listed file the SHA-256 of all that stepbot may have written there."""
        hashes = {path: set(digests) for path, digests in self.replaced.items()}
        for needs in self.files.values():
            for path, digest in needs.items():
                hashes.setdefault(path, set()).add(digest)
        return hashes


def _mapping(document: Any, key: str, value: Callable[[Any], _Value]) -> dict[str, _Value]:
    """A part of a parsed list; empty if it is missing or something else."""
    try:
        return {str(name): value(one) for name, one in document[key].items()}
    except (KeyError, TypeError, AttributeError):
        return {}


def robot_of(name: str) -> str:
    """The robot that a file at the top is named after; suffixes of formats may have two parts."""
    stem, _, _ = name.rpartition(".")
    for part in (".drake", ".world", ".scene"):
        stem = stem.removesuffix(part)
    return stem


def robot_in(files: Mapping[str, bytes]) -> str | None:
    """The robot that the files of a run belong to, by its report; None without one."""
    try:
        return str(json.loads(files["report.json"])["robot"]["name"])
    except (KeyError, ValueError, TypeError, RecursionError):
        return None


def content_hashes(files: Mapping[str, bytes]) -> dict[str, str]:
    """SHA-256 of each file."""
    return {path: hashlib.sha256(content).hexdigest() for path, content in files.items()}


def manifest_of(digests: Mapping[str, str]) -> Manifest:
    """The entries of the files of a run, by path relative to the folder, from the SHA-256 of each.

    Files of a ROS 2 package beside its URDF are needed by the package alone: formats that a later run does not write
    keep none of them.
    """
    below = {path: digest for path, digest in digests.items() if "/" in path}
    package = {path: digest for path, digest in below.items() if path.startswith(_IN_PACKAGE)}
    shared = below if _PACKAGE not in digests else {path: below[path] for path in below if path not in package}
    pages = _pages(digests)
    return {
        path: {
            path: digests[path],
            **(below if path == _PACKAGE else shared),
            **({pages[path]: digests[pages[path]]} if path in pages else {}),
        }
        for path in top_files(digests)
    }


def top_files(files: Iterable[str]) -> list[str]:
    """The files of a run that its list has entries of: those at the top, except pages."""
    pages = _pages(files).values()
    return [path for path in files if "/" not in path and path not in pages]


def _pages(files: Iterable[str]) -> dict[str, str]:
    """For report.json its page: a run that writes the one without the other removes an outdated page."""
    return {path.removesuffix(".html") + ".json": path for path in files if path.endswith(".html")}


def stale_files(before: Manifest, after: Manifest) -> dict[str, str]:
    """Files that are no longer needed, with the hash of what was written."""
    needed = {path for needs in after.values() for path in needs}
    return {path: digest for needs in before.values() for path, digest in needs.items() if path not in needed}


def is_below(path: str) -> bool:
    """Whether a relative path with forward slashes stays below its folder, on every system."""
    never = _NEVER_IN_NAMES | (_NEVER_IN_WINDOWS_NAMES if os.name == "nt" else frozenset())
    parts = path.split("/")
    return (
        all(part not in ("", ".", "..") and never.isdisjoint(part) for part in parts)
        and parts[0] not in (MANIFEST, LOCK)
        and not parts[0].startswith(STAGING)
    )
