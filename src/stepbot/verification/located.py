"""Finds the meshes of files before engines read them: each engine searches packages in its own way, or not at all."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.openable import openable
from stepbot.engines.source_copy import MissingMesh
from stepbot.runtime.worker import Start, Worker, WorkerDied

_LOCATE = "stepbot.engines.source_copy:located_copy"
_WITH_PACKAGES = ("urdf", "sdf")
_MOST_NOTES = 5


def located(
    formats: Mapping[Path, str],
    packages: Iterable[Path],
    folder: Path,
    found: Diagnostics,
    *,
    timeout: float,
    memory_limit: int | None = None,
    start: Start | None = None,
) -> dict[Path, Path]:
    """Where engines find each file: a copy with absolute paths, if it names meshes in packages.

    Args:
        formats: The files and their formats.
        packages: Folders of packages, or the folders that contain them; those above a file are searched, too.
        folder: Receives the copies.
        found: Receives SB861 for files whose meshes are missing.
        timeout: Time limit [s] for one file.
        memory_limit: Address space [bytes] of the process that reads it; None for no limit.
        start: Starts that process; None to start a new interpreter.

    Returns:
        The files without missing meshes, each with its own path or that of its copy.
    """
    places = {}
    for number, (path, written_in) in enumerate(formats.items()):
        places[path] = path
        if written_in not in _WITH_PACKAGES:
            continue
        copy = folder / str(number) / path.name
        copy.parent.mkdir()
        with Worker(_LOCATE, memory_limit=memory_limit, start=start) as worker:
            asked = worker.submit(str(openable(path)), str(copy), tuple(packages))
            try:
                missing: tuple[MissingMesh, ...] = asked.result(timeout)
            except WorkerDied as death:
                message = f"the process that looks for the file's meshes died: {death.reason}"
                found.add("SB902", message, Span(path.as_posix()), notes=death.last_lines)
                del places[path]
                continue
        if missing:
            _report(path, missing, found)
            del places[path]
        elif copy.exists():
            places[path] = copy
    return places


def _report(path: Path, missing: tuple[MissingMesh, ...], found: Diagnostics) -> None:
    """Report meshes that a file names and that do not exist (SB861)."""
    first, *others = missing
    more = f" and {len(others)} more" if others else ""
    notes = [f"also missing: '{one.uri}'" for one in others[:_MOST_NOTES]]
    left = len(others) - len(notes)
    if left > 0:
        notes.append(f"and {left} more")
    remedy = "put the meshes where the file names them"
    if any("://" in one.uri for one in missing):
        remedy = "name the folder of the package: `--package-path DIR`"
    message = f"mesh '{first.uri}'{more} not found"
    found.add("SB861", message, Span(path.as_posix(), first.line), help=[remedy], notes=notes)
