"""Hashes of files and of separate parts."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from ..file import open_regular

try:  # as `random` does: hashlib loads OpenSSL, which takes a twelfth of the time of an unchanged `check`
    from _blake2 import blake2b
except ImportError:
    from hashlib import blake2b

_CHUNK = 1 << 22
_SIZE = 20
ENTRY_SIZE = 32
"""Size [bytes] of :func:`entry_digest`."""


class Digest:
    """A hash over separate parts: ``("ab", "c")`` differs from ``("a", "bc")``."""

    def __init__(self, purpose: str) -> None:
        """Start a key.

        Args:
            purpose: The kind of result.
        """
        self._hashed = blake2b(digest_size=_SIZE)
        self.add(purpose)

    def add(self, *parts: str | bytes) -> "Digest":
        """Add parts, in order."""
        for part in parts:
            data = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
            self._hashed.update(len(data).to_bytes(8, "little"))
            self._hashed.update(data)
        return self

    @property
    def key(self) -> str:
        """The key, in hexadecimal digits."""
        return self._hashed.hexdigest()


def file_digest(path: Path) -> str | None:
    """Hash of a file's bytes; None if the file is missing or unreadable."""
    hashed = blake2b(digest_size=_SIZE)
    try:
        with open_regular(path) as file:
            while chunk := file.read(_CHUNK):
                hashed.update(chunk)
    except OSError:
        return None
    return hashed.hexdigest()


def files_digest(files: Iterable[Path]) -> str:
    """Hash of the paths and contents of several files; those that are missing count as such."""
    digest = Digest("files")
    for path in files:
        digest.add(path.as_posix(), file_digest(path) or "missing")
    return digest.key


def bytes_digest(content: bytes) -> str:
    """:func:`file_digest` of a file with this content."""
    return blake2b(content, digest_size=_SIZE).hexdigest()


def entry_digest(key: str, content: bytes) -> bytes:
    """Hash of a cache entry, with its key."""
    hashed = blake2b(key.encode(), digest_size=ENTRY_SIZE)
    hashed.update(content)
    return hashed.digest()


def content_digest(files: Mapping[str, bytes]) -> str:
    """Hash of several files, by their names."""
    digest = Digest("files")
    for name, content in sorted(files.items()):
        digest.add(name, content)
    return digest.key
