"""Cache entries: one file each, named by its key, complete or absent.

folder/entries-1/ab/cdef...      an entry: a line with the format, a hash, the content
folder/entries-1/ab/.new-...     an entry being written, by a running or a killed process

A file is renamed to its final name when it is complete; the hash covers key and content, so that a file truncated by a
full disk or a crash is a miss. Reading marks an entry as used; above the size limit, the least recently used entries
are removed. Runs need not coordinate: a later one finds the entry, or computes it again.

Only regular files with the names of entries are read and removed; no symbolic link below the folder is followed.
"""

import contextlib
import errno
import os
import re
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from stat import S_ISREG
from typing import NamedTuple

from ..file import exists, open_regular
from .digest import ENTRY_SIZE, entry_digest

_NAME = "stepbot"


def default_folder() -> Path:
    r"""stepbot's cache folder, whether it exists or not.

    ``$XDG_CACHE_HOME/stepbot``, else ``~/.cache/stepbot`` (https://specifications.freedesktop.org/basedir-spec);
    ``~/Library/Caches/stepbot`` on macOS, ``%LOCALAPPDATA%\stepbot\Cache`` on Windows.
    """
    if sys.platform == "win32":
        return _set("LOCALAPPDATA", Path.home() / "AppData" / "Local") / _NAME / "Cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / _NAME
    return _set("XDG_CACHE_HOME", Path.home() / ".cache") / _NAME


def _set(variable: str, otherwise: Path) -> Path:
    """The folder in an environment variable; a relative path counts as unset, as the XDG specification requires."""
    value = os.environ.get(variable, "")
    return Path(value) if value and Path(value).is_absolute() else otherwise


DEFAULT_LIMIT = 2 * 2**30
"""Maximum size [bytes] of all entries."""

_FORMAT = "entries-1"
_HEAD = b"stepbot cache entry 3\n"
_ENTRY = re.compile("[0-9a-f]{30,}")
"""Name of an entry: its key without the first two digits, which name its folder."""
_FOLDER = re.compile("[0-9a-f]{2}")
_NEW = ".new-"
_ABANDONED_AFTER = 3600.0
"""Age [s] from which an unfinished file belongs to a killed process."""
_KEPT_SHARE = 0.8
"""Share of the limit that remains after entries are removed, so that this is not needed for every new one."""
_SCAN_SHARE = 1.0 / 64.0
"""Share of the limit that a process adds before it checks the total size of all processes' entries again."""
_CHECKED_FOR = 300.0
"""Time [s] after a check by any process within which the next process makes none: it takes 5 ms per 1,000 entries."""


class Usage(NamedTuple):
    """Number and size of entries."""

    entries: int
    size: int
    """[bytes]."""


class _Entry(NamedTuple):
    path: str
    size: int
    used: float


class Cache:
    """Bytes by key.

    Attributes:
        folder: Folder of the entries; created when the first one is stored.
        limit: Approximate maximum size [bytes] of all entries.
        trouble: Why an entry could not be stored; empty without errors. An unwritable cache makes runs slow, not wrong:
            the caller decides how to report it.
    """

    def __init__(self, folder: Path, limit: int = DEFAULT_LIMIT) -> None:
        self.folder, self.limit = folder, limit
        self.trouble = ""
        self._added: int | None = None

    def get(self, key: str) -> bytes | None:
        """The entry under a key; None if it is missing or damaged."""
        path = self._path(key)
        try:
            if _is_linked(path):
                return None
            with open_regular(path, follow_links=False) as file:
                if os.fstat(file.fileno()).st_size > self.limit:
                    return None
                head, hashed, content = file.read(len(_HEAD)), file.read(ENTRY_SIZE), file.read()
        except OSError:
            return None
        if head != _HEAD or hashed != entry_digest(key, content):
            return None
        try:
            os.utime(path)
        except OSError:  # removed meanwhile, or owned by another user: its time stamp is not essential
            return content
        return content

    def put(self, key: str, content: bytes) -> None:
        """Store an entry, unless it is larger than a quarter of the limit."""
        if len(content) > self.limit // 4:
            return
        if self._added is None:  # before a new folder changes the time of the one above
            self._added = self._unchecked()
        path = self._path(key)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            if _is_linked(path):
                raise OSError(errno.ELOOP, "a folder of the cache is a symbolic link", str(path.parent))
            _write(path, _HEAD + entry_digest(key, content) + content)
        except OSError as error:
            self.trouble = f"cannot write {error.filename or path}: {error.strerror or error}"
            return
        self._added += len(content)
        if self._added > self.limit * _SCAN_SHARE:
            self._added = 0
            self.trim()

    def _unchecked(self) -> int:
        """Size [bytes] that may have been added since the last check, of which the folder has the time."""
        try:
            age = time.time() - (self.folder / _FORMAT).stat().st_mtime
        except OSError:
            return self.limit
        return 0 if 0.0 <= age < _CHECKED_FOR else self.limit

    def trim(self) -> None:
        """Remove the least recently used entries above the limit, and leftovers of killed processes."""
        folder = self.folder / _FORMAT
        with contextlib.suppress(OSError):
            if not folder.is_symlink():
                os.utime(folder)
        entries = list(self._entries())
        size = sum(entry.size for entry in entries)
        if size <= self.limit:
            return
        for entry in sorted(entries, key=lambda entry: (entry.used, entry.path)):
            if size <= int(self.limit * _KEPT_SHARE):
                return
            if _removed(entry.path):
                size -= entry.size

    def usage(self) -> Usage:
        """Number and size of all entries."""
        entries = list(self._entries())
        return Usage(len(entries), sum(entry.size for entry in entries))

    def clear(self) -> Usage:
        """Remove all entries, whatever their format; returns their number and size."""
        removed = [entry for entry in self._entries("entries-*") if _removed(entry.path)]
        return Usage(len(removed), sum(entry.size for entry in removed))

    def _path(self, key: str) -> Path:
        return self.folder / _FORMAT / key[:2] / key[2:]

    def _entries(self, formats: str = _FORMAT) -> Iterator[_Entry]:
        """All entries; abandoned temporary files are removed on the way."""
        try:
            folders = list(self.folder.glob(f"{formats}/??"))
        except OSError:  # a name that is too long: there are none
            return
        for folder in folders:
            if not _FOLDER.fullmatch(folder.name) or _is_linked(folder / _NEW):
                continue
            try:
                with os.scandir(folder) as entries:
                    files = list(entries)
            except OSError:  # removed, or not a folder: then it has no entries
                continue
            for file in files:
                try:
                    status = file.stat(follow_symlinks=False)
                except OSError:  # removed by another process
                    continue
                if not S_ISREG(status.st_mode):
                    continue
                if _ENTRY.fullmatch(file.name):
                    yield _Entry(file.path, status.st_size, status.st_mtime)
                elif file.name.startswith(_NEW) and time.time() - status.st_mtime > _ABANDONED_AFTER:
                    _removed(file.path)


def _is_linked(path: Path) -> bool:
    """Whether the folder of an entry, or that of its format, is a symbolic link."""
    return path.parent.is_symlink() or path.parent.parent.is_symlink()


def _write(path: Path, data: bytes) -> None:
    """Create a file atomically: readers see all of it or nothing."""
    import tempfile  # not needed to read entries

    handle, name = tempfile.mkstemp(prefix=_NEW, dir=path.parent)
    draft = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        draft.replace(path)
    except PermissionError:
        _removed(draft)
        if not exists(path):  # on Windows a file that is being read cannot be replaced: it has the same content
            raise
    except BaseException:
        _removed(draft)
        raise


def _removed(path: Path | str) -> bool:
    """Remove a file; False if another process removed it or has it open."""
    try:
        Path(path).unlink()
    except OSError:
        return False
    return True
