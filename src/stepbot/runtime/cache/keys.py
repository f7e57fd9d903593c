"""What a key is made of: everything that a result depends on, and nothing else."""

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
    """A hash over parts of which each is told apart from the next: ``("ab", "c")`` is not ``("a", "bc")``."""

    def __init__(self, purpose: str) -> None:
        """Begin a key.

        Args:
            purpose: What kind of thing it is the key of.
        """
        self._hashed = hashlib.blake2b(digest_size=_SIZE)
        self.add(purpose)

    def add(self, *parts: str | bytes) -> "Digest":
        """Take in parts, in their order."""
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
    """Hash of a file's bytes; None where there is no such file, or it cannot be read."""
    hashed = hashlib.blake2b(digest_size=_SIZE)
    try:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                hashed.update(chunk)
    except OSError:
        return None
    return hashed.hexdigest()


def bytes_digest(content: bytes) -> str:
    """What :func:`file_digest` says of a file with this content."""
    return hashlib.blake2b(content, digest_size=_SIZE).hexdigest()


def content_digest(files: Mapping[str, bytes]) -> str:
    """Hash of several files, by their names."""
    digest = Digest("files")
    for name, content in sorted(files.items()):
        digest.add(name, content)
    return digest.key


@cache
def own_code() -> str:
    """Hash of stepbot's own code, and what runs it: a result of other code is another result.

    The version number alone would not do: it stays while one works on stepbot.
    """
    package = Path(__file__).resolve().parents[2]
    digest = Digest("code")
    for path in sorted(package.rglob("*.py"), key=lambda path: path.as_posix()):
        digest.add(path.relative_to(package).as_posix(), path.read_bytes())
    digest.add(platform.python_implementation(), sys.version, sys.platform, platform.machine())
    return digest.key


@cache
def environment() -> str:
    """Hash of all that stepbot's results come from beside their input: its own code, packages and external programs.

    Any package counts, whether stepbot uses it itself, another one does, or it is not there yet.
    """
    return Digest("environment").add(own_code(), *_packages(), "programs", *program_fingerprints()).key


def _packages() -> list[str]:
    """Names and versions of all packages that can be imported: what pip calls their folders.

    Their metadata says the same, but to import what reads it takes longer than all else before a result is found.
    """
    found: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError):  # an archive, or nothing
            found.update(path.name for path in Path(folder).iterdir() if path.suffix in (".dist-info", ".egg-info"))
    return sorted(found)
