"""The files of an assembly: a STEP file and those that it refers to, directly or through each other.

A reference is followed only to a regular file in the folder of the assembly or below it. Absolute paths, ``..``, URLs
and links that lead out of the folder are never opened. Which file may be read is decided here, before the kernel sees
any of them; the kernel's own search for such files is switched off (:func:`stepbot.step.kernel.read_model`).
"""

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path, PurePosixPath

from msgspec import Struct

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.runtime.file import is_file, resolved

from . import DOCUMENT_FILE
from .part21 import Part21, check_step, opened
from .references import ExternalReference, external_references

NONE = -1
"""Index that means no file."""
_ONE_FILE = "or export the assembly as one STEP file, with external references switched off"
_ABSOLUTE = re.compile(r"[A-Za-z]:|[/\\]|[A-Za-z][A-Za-z0-9+.-]+:")
"""Prefix of a name that is a drive, an absolute or UNC path, or a URL."""


class Link(Struct, frozen=True):
    """A product whose shape is in another file."""

    reference: ExternalReference
    file: int = NONE
    """Index of the other file; -1 if it cannot be read."""
    fault: str = ""
    """Why it cannot be read."""
    help: tuple[str, ...] = ()


class StepFile(Struct, frozen=True):
    """One of the files of an assembly."""

    path: Path
    """The path to open."""
    place: str
    """Name of the file in diagnostics."""
    name: str
    """Path relative to the folder of the assembly, with slashes."""
    part21: Part21
    links: tuple[Link, ...] = ()


def check_files(step: Path, place: str, diagnostics: Diagnostics, encoding: str = "") -> tuple[StepFile, ...] | None:
    """Check an assembly's files, the main one first; None, with errors in ``diagnostics``, if one is not a STEP file.

    A reference that cannot be followed is a link without a file: whether its product needs that file is decided later.

    Args:
        place: Its name in diagnostics; the other files are named relative to it.
        encoding: Declared code page of names; empty for none.
    """
    checked: dict[Path, Part21 | None] = {}

    def references(path: Path, name: PurePosixPath) -> Sequence[ExternalReference]:
        own = place if path == step else str(Path(place).parent / name)
        checked[path] = part21 = check_step(path, own, diagnostics, encoding)
        return part21.references if part21 is not None else ()

    files = []
    for path, name, links in _walk(step, references):
        part21 = checked[path]
        if part21 is not None:
            own = place if path == step else str(Path(place).parent / name)
            files.append(StepFile(path, own, str(name), part21, links))
    return tuple(files) if len(files) == len(checked) else None


def reached_files(step: Path) -> dict[str, Path]:
    """The files of an assembly by their names relative to its folder, the main one first; reports nothing."""
    return {str(name): path for path, name, _ in _walk(step, _references)}


def _references(path: Path, _name: PurePosixPath) -> Sequence[ExternalReference]:
    """The references of an unchecked file; empty if it is unreadable."""
    try:
        with opened(path) as data:
            if data.find(DOCUMENT_FILE) < 0:
                return ()
            references = external_references(data, "", with_products=False)
            return [reference for reference in references if reference.is_step]
    except OSError:
        return ()


def _walk(
    step: Path, references: Callable[[Path, PurePosixPath], Sequence[ExternalReference]]
) -> Iterator[tuple[Path, PurePosixPath, tuple[Link, ...]]]:
    """All files that can be reached, each once, in the order of the references to them: path, name, links."""
    folder = resolved(step.parent)
    index = {resolved(step): 0}
    pending = [(step, PurePosixPath(step.name))]
    while pending:
        path, name = pending.pop(0)
        links, targets = [], references(path, name)
        taken = {path.name, *(reading for reference in targets for reading in reference.readings)}
        for reference in targets:
            target = _resolve(reference, name.parent, step.parent, folder, taken)
            if isinstance(target, tuple):
                fault, help = target
                links.append(Link(reference, NONE, fault, (*help, _ONE_FILE)))
                continue
            real = resolved(target)
            if real not in index:
                index[real] = len(index)
                pending.append((target, PurePosixPath(target.relative_to(step.parent).as_posix())))
            links.append(Link(reference, index[real]))
        yield path, name, tuple(links)


def _resolve(
    reference: ExternalReference, beside: PurePosixPath, root: Path, folder: Path, taken: Collection[str]
) -> Path | tuple[str, tuple[str, ...]]:
    """The file of a reference, within the folder of the assembly; or why it is not followed, and remedies.

    Args:
        reference: The reference in another file.
        beside: Folder of that file, relative to the assembly's.
        root: Folder of the assembly, as it was given.
        folder: The same without links.
        taken: Names of files that cannot be this one under another name.
    """
    missing: Path | None = None
    for reading in reference.readings:
        name = reading.strip().replace("\\", "/")
        if _ABSOLUTE.match(name) or ".." in name.split("/") or "\0" in name:
            help = ("put the file beside it, and name it without a folder in the STEP file",)
            return "which is not beside it: only files in its folder are read", help
        path = root / beside / name
        try:
            real = path.resolve(strict=True)
            if not is_file(real):
                continue
        # missing, no access, a cycle of symbolic links, an invalid file name
        except (OSError, RuntimeError, ValueError):
            missing = missing or path
            continue
        if not real.is_relative_to(folder):
            return "which is a link to a file outside of its folder", ("put the file itself there",)
        return path
    where = root / beside
    help = (f"put '{reference.name}' into '{where}'",) if str(where) != "." else (f"put '{reference.name}' beside it",)
    return "which does not exist", (*help, *_meant(missing, taken))


def _meant(path: Path | None, taken: Collection[str]) -> tuple[str, ...]:
    try:
        beside = sorted(file.name for file in path.parent.iterdir()) if path is not None else []
    except (OSError, ValueError):
        return ()
    beside = [name for name in beside if name not in taken]
    return did_you_mean(path.name, beside) if path is not None else ()
