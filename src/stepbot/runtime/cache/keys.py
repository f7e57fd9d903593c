"""Cache keys: everything that a result depends on, and nothing else."""

import contextlib
import hashlib
import platform
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from ..programs import program_fingerprints

_CHUNK = 1 << 22
_SIZE = 20


class Digest:
    """A hash over separate parts: ``("ab", "c")`` differs from ``("a", "bc")``."""

    def __init__(self, purpose: str) -> None:
        """Start a key.

        Args:
            purpose: The kind of result.
        """
        self._hashed = hashlib.blake2b(digest_size=_SIZE)
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
    hashed = hashlib.blake2b(digest_size=_SIZE)
    try:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                hashed.update(chunk)
    except OSError:
        return None
    return hashed.hexdigest()


def bytes_digest(content: bytes) -> str:
    """:func:`file_digest` of a file with this content."""
    return hashlib.blake2b(content, digest_size=_SIZE).hexdigest()


def content_digest(files: Mapping[str, bytes]) -> str:
    """Hash of several files, by their names."""
    digest = Digest("files")
    for name, content in sorted(files.items()):
        digest.add(name, content)
    return digest.key


@cache
def own_code() -> str:
    """Hash of stepbot's own code and its runtime: results of other code are different results.

    The version number would not be sufficient: it does not change during development.
    """
    package = Path(__file__).resolve().parents[2]
    digest = Digest("code")
    for path in sorted(package.rglob("*.py"), key=lambda path: path.as_posix()):
        digest.add(path.relative_to(package).as_posix(), path.read_bytes())
    digest.add(platform.python_implementation(), sys.version, sys.platform, platform.machine())
    return digest.key


@cache
def environment() -> str:
    """Hash of everything that results depend on besides the input: stepbot's code, packages and external programs.

    Any installed package counts, whether stepbot uses it directly, indirectly or optionally.
    """
    return Digest("environment").add(own_code(), *_packages(), "programs", *program_fingerprints()).key


def _packages() -> list[str]:
    """Names and versions of all importable packages, from the names of their metadata folders.

    Reading the metadata itself would take longer than everything else before a cache hit.
    """
    found: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError):  # an archive, or nothing
            found.update(path.name for path in Path(folder).iterdir() if path.suffix in (".dist-info", ".egg-info"))
    return sorted(found)
