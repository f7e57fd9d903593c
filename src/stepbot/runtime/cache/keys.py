"""What all cache keys contain: stepbot's code, the installed packages and external programs."""

import contextlib
import os
import sys
from functools import cache

from .digest import Digest
from .sources import own_code


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
    found: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError), os.scandir(folder or ".") as entries:  # an error: an archive, or nothing
            found.update(entry.name for entry in entries if entry.name.endswith((".dist-info", ".egg-info")))
    return sorted(found)
