"""What is found in a foreign description before any engine reads it; to be called in a worker process."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from .file_references import Refusal, refusals
from .source_copy import MissingMesh, located_copy

_WITH_PACKAGES = ("urdf", "sdf")


class Examined(NamedTuple):
    """What was found in a file."""

    refusals: tuple[Refusal, ...]
    """Why engines must not read it."""
    missing: tuple[MissingMesh, ...] = ()
    """Meshes that it names and that do not exist."""


def examine(file: str, written_in: str, opened: str, copy: str, packages: Iterable[Path]) -> Examined:
    """See :func:`.refusals` and :func:`.located_copy`.

    Args:
        file: Path of the description, for messages.
        written_in: Its format.
        opened: Its path in UTF-8.
        copy: Path of the copy with absolute paths of meshes; empty to look for no meshes.
        packages: Folders of packages.
    """
    refused = refusals(file, written_in)
    if refused or not copy or written_in not in _WITH_PACKAGES:
        return Examined(refused)
    return Examined((), located_copy(opened, copy, packages))
