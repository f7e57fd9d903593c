r"""Entries in files: one file each, named by its key, whole or not there.

    folder/entries-1/ab/cdef...      what is kept: a line that names the format, a hash, the content
    folder/entries-1/ab/.new-...     what is being written, or was when its process was killed

A file gets its name when it is complete, in one step; the hash covers key and content, so that a file that a full disk
or a crash left torn is a miss. Reading marks an entry as used; where all of them grow beyond the limit, those that were
not used for longest go. Runs need not know of each other: whoever comes late finds an entry, or makes the same anew.
"""

import hashlib
import os
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

DEFAULT_LIMIT = 2 * 2**30
"""Bytes that all entries may take."""

_FORMAT = "entries-1"
_HEAD = b"stepbot cache entry 1\n"
_DIGEST_SIZE = 32
_NEW = ".new-"
_ABANDONED_AFTER = 3600.0
"""Age [s] from which a file that is being written belongs to a process that was killed."""
_KEPT_SHARE = 0.8
"""Share of the limit that is left when entries are removed, so that it is not done for every new one."""
_SCAN_SHARE = 1.0 / 64.0
"""Share of the limit that a process adds before it looks again at what all processes have added."""


@dataclass(frozen=True)
class Usage:
    """How much there is."""

    entries: int
    size: int
    """Bytes."""


@dataclass(frozen=True)
class _Entry:
    path: Path
    size: int
    used: float


class Cache:
    """Bytes by key.

    Attributes:
        folder: Where the entries are; made when there is something to keep.
        limit: Bytes that all entries may take, about.
        trouble: Why something could not be kept; empty while all is well. A cache that cannot be written makes runs
            slow, not wrong: it is for the caller to say so.
    """

    def __init__(self, folder: Path, limit: int = DEFAULT_LIMIT) -> None:
        self.folder, self.limit = folder, limit
        self.trouble = ""
        self._added = limit  # so that the first entry of a process makes it look

    def get(self, key: str) -> bytes | None:
        """What is kept under a key; None where there is nothing, or nothing whole."""
        path = self._path(key)
        try:
            data = path.read_bytes()
        except OSError:
            return None
        start = len(_HEAD) + _DIGEST_SIZE
        content = data[start:]
        if data[: len(_HEAD)] != _HEAD or data[len(_HEAD) : start] != _digest(key, content):
            return None
        try:
            os.utime(path)
        except OSError:  # it was removed meanwhile, or belongs to somebody else: its age is no reason to fail
            return content
        return content

    def put(self, key: str, content: bytes) -> None:
        """Keep something; what is larger than a quarter of the limit is not kept."""
        if len(content) > self.limit // 4:
            return
        path = self._path(key)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _write(path, _HEAD + _digest(key, content) + content)
        except OSError as error:
            self.trouble = f"cannot write {error.filename or path}: {error.strerror or error}"
            return
        self._added += len(content)
        if self._added > self.limit * _SCAN_SHARE:
            self._added = 0
            self.trim()

    def trim(self) -> None:
        """Remove what was not used for longest, where there is more than the limit, and what killed processes left."""
        entries = sorted(self._entries(), key=lambda entry: (entry.used, entry.path))
        size = sum(entry.size for entry in entries)
        kept = self.limit if size <= self.limit else int(self.limit * _KEPT_SHARE)
        for entry in entries:
            if size <= kept:
                return
            if _removed(entry.path):
                size -= entry.size

    def usage(self) -> Usage:
        """How much there is."""
        entries = list(self._entries())
        return Usage(len(entries), sum(entry.size for entry in entries))

    def clear(self) -> Usage:
        """Remove all entries, whatever their format; returns how much there was."""
        removed = [entry for entry in self._entries("entries-*") if _removed(entry.path)]
        return Usage(len(removed), sum(entry.size for entry in removed))

    def _path(self, key: str) -> Path:
        return self.folder / _FORMAT / key[:2] / key[2:]

    def _entries(self, formats: str = _FORMAT) -> Iterator[_Entry]:
        """All entries; files that nobody goes on writing are removed on the way."""
        for folder in sorted(self.folder.glob(f"{formats}/??")):
            try:
                files = sorted(folder.iterdir())
            except OSError:  # removed, or no folder: then there are no entries in it
                continue
            for file in files:
                try:
                    status = file.stat()
                except OSError:  # removed by another process
                    continue
                if not file.name.startswith(_NEW):
                    yield _Entry(file, status.st_size, status.st_mtime)
                elif time.time() - status.st_mtime > _ABANDONED_AFTER:
                    _removed(file)


def _write(path: Path, data: bytes) -> None:
    """Make a file in one step: whoever looks sees all of it or nothing."""
    handle, name = tempfile.mkstemp(prefix=_NEW, dir=path.parent)
    draft = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        draft.replace(path)
    except PermissionError:
        _removed(draft)
        if not path.exists():  # on Windows a file that is being read cannot be replaced: it has the same content
            raise
    except BaseException:
        _removed(draft)
        raise


def _removed(path: Path) -> bool:
    """Remove a file; False where another process was faster, or has it open."""
    try:
        path.unlink()
    except OSError:
        return False
    return True


def _digest(key: str, content: bytes) -> bytes:
    hashed = hashlib.blake2b(key.encode(), digest_size=_DIGEST_SIZE)
    hashed.update(content)
    return hashed.digest()
