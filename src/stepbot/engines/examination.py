"""What is found in a foreign description before any engine reads it; to be called in a worker process."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from .description.statements import Statement, mesh_hash, statements
from .file_references import Refusal, refusals
from .observation import EngineRefused
from .source_copy import MissingMesh, located_copy

_WITH_PACKAGES = ("urdf", "sdf")


class Examination(NamedTuple):
    """What was found in a file."""

    refusals: tuple[Refusal, ...]
    """Why engines must not read it."""
    missing: tuple[MissingMesh, ...] = ()
    """Meshes that it names and that do not exist."""
    stated: tuple[Statement, ...] = ()
    """What it states, if that is asked for."""
    meshes: str = ""
    """A hash of its mesh files, if what it states is asked for without surfaces."""


def examine(
    file: str, written_in: str, opened: str, copy: str, packages: Iterable[Path], stated: bool, surfaces: bool
) -> Examination:
    """See :func:`.refusals` and :func:`.located_copy`.

    Args:
        file: Path of the description, for messages.
        opened: Its path in UTF-8.
        copy: Path of the copy with absolute paths of meshes; empty to look for no meshes.
        packages: Folders of packages, or those that contain them; an MJCF may include files of these.
        stated: Whether to return what the file states.
        surfaces: Whether this includes the surfaces of its mesh files.
    """
    refused = refusals(file, written_in, packages)
    if refused or not copy:
        return Examination(refused)
    missing = located_copy(opened, copy, packages) if written_in in _WITH_PACKAGES else ()
    if not stated:
        return Examination((), missing)
    try:
        said = statements(Path(opened), written_in, packages, surfaces=surfaces)
        return Examination((), missing, said, "" if surfaces else mesh_hash(Path(opened), packages))
    except EngineRefused:  # it is not XML, which engines report
        return Examination((), missing)
