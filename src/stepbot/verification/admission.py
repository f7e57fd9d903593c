"""Examines files before engines read them, each in a process of its own.

Engines must not read files with entities, includes from other folders, pipes or devices. Each engine searches packages
in its own way, or not at all, so that meshes are found here.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.description.statements import Statement
from stepbot.engines.examination import Examined
from stepbot.engines.file_references import openable
from stepbot.engines.source_copy import MissingMesh
from stepbot.runtime.file import exists
from stepbot.runtime.worker import Start, Worker, WorkerDied

_EXAMINE = "stepbot.engines.examination:examine"
_MOST_NOTES = 5


def admitted(
    formats: Mapping[Path, str],
    found: Diagnostics,
    *,
    timeout: float,
    memory_limit: int | None = None,
    start: Start | None = None,
) -> dict[Path, str]:
    """The files that engines may read, each with its format.

    Args:
        formats: The files and their formats.
        found: Receives SB820 for rejected files.
        timeout: Time limit [s] of the check of one file.
        memory_limit: Address space [bytes] of the process that checks; None for no limit.
        start: Starts that process; None to start a new interpreter.
    """
    copies = dict.fromkeys(formats)
    examined = _examined(formats, copies, (), found, timeout=timeout, memory_limit=memory_limit, start=start)
    return {path: formats[path] for path, _ in examined}


def located(
    formats: Mapping[Path, str],
    packages: Iterable[Path],
    folder: Path,
    found: Diagnostics,
    *,
    timeout: float,
    memory_limit: int | None = None,
    start: Start | None = None,
) -> tuple[dict[Path, Path], dict[Path, tuple[Statement, ...]]]:
    """The files that engines may read, and where they find each: a copy with absolute paths, if it names packages.

    Files that share a format come with what they say.

    Args:
        formats: The files and their formats.
        packages: Folders of packages, or the folders that contain them; those above a file are searched, too.
        folder: Receives the copies.
        found: Receives SB820 for rejected files, and SB861 for those whose meshes are missing.
        timeout: Time limit [s] for one file.
        memory_limit: Address space [bytes] of the process that reads it; None for no limit.
        start: Starts that process; None to start a new interpreter.
    """
    copies: dict[Path, Path | None] = {path: folder / str(n) / path.name for n, path in enumerate(formats)}
    places, said = {}, {}
    shared = len(set(formats.values())) < len(formats)
    for path, one in _examined(
        formats, copies, tuple(packages), found, stated=shared, timeout=timeout, memory_limit=memory_limit, start=start
    ):
        copy = copies[path]
        if one.missing:
            _report_missing(path, one.missing, found)
        else:
            places[path] = copy if copy is not None and exists(copy) else path
            said[path] = one.stated
    return places, said


def _examined(
    formats: Mapping[Path, str],
    copies: Mapping[Path, Path | None],
    packages: tuple[Path, ...],
    found: Diagnostics,
    *,
    stated: bool = False,
    timeout: float,
    memory_limit: int | None,
    start: Start | None,
) -> Iterator[tuple[Path, Examined]]:
    """The files that engines may read, with what was found in each."""
    for path, written_in in formats.items():
        copy = copies[path]
        if copy is not None:
            copy.parent.mkdir()
        with Worker(_EXAMINE, memory_limit=memory_limit, start=start) as worker:
            asked = worker.submit(str(path), written_in, str(openable(path)), str(copy or ""), packages, stated)
            try:
                examined: Examined = asked.result(timeout)
            except WorkerDied as death:
                message = f"the process that reads the file's references died: {death.reason}"
                found.add("SB902", message, Span(path.as_posix()), notes=death.last_lines)
                continue
        for one in examined.refusals:
            found.add(one.code, one.message, Span(Path(one.file).as_posix(), one.line))
        if not examined.refusals:
            yield path, examined


def _report_missing(path: Path, missing: tuple[MissingMesh, ...], found: Diagnostics) -> None:
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
