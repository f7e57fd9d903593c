"""Hash of stepbot's own code: results of other code are different results.

The version number would not be sufficient: it does not change during development. To read all files takes half as long
as `import click`, so a cache keeps the hash under their sizes and times, by which Python recognizes outdated bytecode.
"""

import contextlib
import os
import platform
import sys
import time
from functools import cache
from pathlib import Path

from stepbot.diagnostics.codes import PAGE

from .digest import Digest, file_digest
from .store import Cache

_PACKAGE = Path(__file__).resolve().parents[2]
_SUFFIXES = (".py", ".toml", ".json", ".html", ".css", ".js")
_SETTLED = 2 * 10**9
"""Age [ns] of a file from which a further change gives it another time, on any file system."""
_caches: list[Cache] = []


def keep_own_code(kept: Cache | None) -> None:
    """Let :func:`own_code` find its result in a cache, and store it there; None for no cache."""
    _caches[:] = [] if kept is None else [kept]


@cache
def own_code() -> str:
    """Hash of stepbot's own code, the severities of its diagnostics, and its runtime."""
    digest = Digest("code").add(code_digest(_PACKAGE, _caches[0] if _caches else None), file_digest(PAGE) or "")
    return digest.add(platform.python_implementation(), sys.version, sys.platform, platform.machine()).key


def code_digest(package: Path, kept: Cache | None) -> str:
    """Hash of the names and the contents of the source files below a folder.

    Args:
        kept: Keeps the hash for files of the same sizes and times; None to read the files.
    """
    stamps = dict(sorted(_stamps(str(package))))
    key = Digest("stamps").add(str(package), repr(stamps)).key
    known = kept.get(key) if kept is not None else None
    if known is not None:
        return known.decode("ascii")
    start = time.time_ns()
    digest = Digest("sources")
    for name in stamps:
        digest.add(name, (package / name).read_bytes())
    if kept is not None and all(max(times) < start - _SETTLED for _, *times in stamps.values()):
        kept.put(key, digest.key.encode("ascii"))
    return digest.key


def _stamps(package: str) -> list[tuple[str, tuple[int, int, int]]]:
    """Relative name, size [bytes] and times [ns] of each source file."""
    stamps, folders = [], [""]
    while folders:
        prefix = folders.pop()
        with os.scandir(f"{package}/{prefix}") as entries:
            for entry in entries:
                name = entry.name
                if name.endswith(_SUFFIXES):
                    status = entry.stat()
                    stamps.append((prefix + name, (status.st_size, status.st_mtime_ns, status.st_ctime_ns)))
                elif "." not in name and name != "__pycache__" and entry.is_dir():
                    folders.append(f"{prefix}{name}/")
    return stamps


@cache
def environment() -> str:
    """Hash of everything that results depend on besides the input: stepbot's code, packages and external programs.

    Any installed package counts, whether stepbot uses it directly, indirectly or optionally.
    """
    from ..programs import program_fingerprints

    return Digest("environment").add(own_code(), *_packages(), "programs", *program_fingerprints()).key


def _packages() -> list[str]:
    """Names and versions of all importable packages, from the names of their metadata folders.

    Reading the metadata itself would take longer than everything else before a cache hit.
    """
    packages: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError), os.scandir(folder or ".") as entries:  # an error: an archive, or nothing
            packages.update(entry.name for entry in entries if entry.name.endswith((".dist-info", ".egg-info")))
    return sorted(packages)
