"""Whether files that were written are what would be written now, byte by byte."""

import fnmatch
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from .conversion import REPORT, Options
from .diagnostics import Diagnostics, Span
from .incremental import produce
from .output import MANIFEST


def check_up_to_date(
    sidecar: Path,
    options: Options,
    found: Diagnostics,
    *,
    ignore: Iterable[str] = (),
    progress: Callable[[str], None] = lambda stage: None,
) -> None:
    """Compare the files in ``options.output`` with what a conversion would put there; writes nothing.

    Args:
        sidecar: The sidecar.
        options: How it was converted. Engines are asked only where the folder has a report to compare.
        found: Receives what is wrong with the input, and SB007 for each file that differs.
        ignore: Globs of files that are not compared, relative to the folder.
        progress: Told each stage.
    """
    ignored = tuple(ignore)
    folder = options.output
    has_report = (folder / REPORT).exists() and not _is_ignored(REPORT, ignored)
    conversion = produce(sidecar, replace(options, verify=options.verify and has_report), progress)
    if conversion.diagnostics.has_errors or not conversion.files:
        found.extend(conversion.diagnostics)
        return
    files = {name: content for name, content in conversion.files.items() if not _is_ignored(name, ignored)}
    if not has_report:
        files.pop(REPORT, None)
    remedy = [f"`stepbot convert {sidecar.as_posix()} -o {folder.as_posix()}`, and commit what it writes"]
    for name, what in _differences(files, folder):
        found.add("SB007", what, Span((folder / name).as_posix()), help=remedy)
    for name in _left_over(conversion.files, folder):
        if not _is_ignored(name, ignored):
            found.add("SB007", "is not written any more", Span((folder / name).as_posix()), help=remedy)


def _differences(files: Mapping[str, bytes], folder: Path) -> list[tuple[str, str]]:
    different = []
    for name, content in files.items():
        try:
            same = (folder / name).read_bytes() == content
        except OSError:
            different.append((name, "is missing"))
            continue
        if not same:
            different.append((name, "is not what stepbot writes now"))
    return different


def _left_over(files: Mapping[str, bytes], folder: Path) -> list[str]:
    """Files that an earlier run wrote, by its own list, and that are still there."""
    try:
        written = json.loads((folder / MANIFEST).read_bytes())["files"]
        names = sorted({*written, *(name for needed in written.values() for name in needed)})
    except (OSError, ValueError, KeyError, TypeError, AttributeError):  # nobody knows who wrote what
        return []
    return [name for name in names if name not in files and (folder / name).exists()]


def _is_ignored(name: str, globs: tuple[str, ...]) -> bool:
    return any(fnmatch.fnmatchcase(name, glob) for glob in globs)
