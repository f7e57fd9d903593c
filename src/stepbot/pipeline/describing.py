"""Reads an existing robot description, foreign data, in a worker process."""

import re
from bisect import bisect_left
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.sax.saxutils import escape

from msgspec.structs import replace

from stepbot.described.finding import UNSUPPORTED
from stepbot.described.robot import robot_of_description
from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.description import Description
from stepbot.engines.file_references import openable
from stepbot.engines.macros.expressions import Expansion
from stepbot.robot.model import Robot
from stepbot.runtime.file import exists, open_regular
from stepbot.runtime.temporary import run_folder
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.verification.admission import HEAD, admitted, expanded, has_macros, robot_file
from stepbot.verification.files import format_of

from .conversion import Options
from .sidecars import report_missing

_DESCRIBE = "stepbot.engines.describe:describe"
_SUBJECT = re.compile(r"(link|joint|closure|actuator|sensor|mesh) '([^']+)'")
_NAMED = re.compile(r"""<([a-zA-Z_]+)\b[^<>]*?\bname\s*=\s*("[^"]*"|'[^']*')""")
_TAGS = {"link": ("link", "body"), "joint": ("joint", "freejoint")}
"""Elements that state what a finding is about; other subjects are elements of any name."""


def read_description(path: Path, options: Options, diagnostics: Diagnostics) -> Description | None:
    """The content of a URDF, SDFormat or MJCF; None after a diagnostic.

    Args:
        diagnostics: Takes SB001, SB814, SB820, SB823 and SB902.
    """
    if not exists(path):
        report_missing(path, diagnostics)
        return None
    written_in = format_of(path, diagnostics)
    if written_in is None:
        return None
    if not admitted({path: written_in}, diagnostics, options.workers, options.package_path):
        return None
    if has_macros(path):
        return _expanded(path, options, diagnostics)
    return _described(path, written_in, options, diagnostics)


def _described(
    path: Path, written_in: str, options: Options, diagnostics: Diagnostics, macros: Expansion | None = None
) -> Description | None:
    """The content of a file that engines may read; with ``macros``, messages name the files that it is from."""
    span = Span(path.as_posix())
    try:
        names = str(openable(path)), written_in
        description: Description = options.workers.call(_DESCRIBE, *names, options.package_path)
    except RemoteError as error:
        if error.kind not in ("EngineRefused", "EngineCannotRead"):
            raise
        first, *more = error.text.splitlines() or [""]
        text, line = _without_line(first)
        span = Span(span.file, line) if macros is None else macros.places[min(line, len(macros.places) - 1)]
        diagnostics.add("SB823", text, span, notes=more)
        return None
    except WorkerDied as death:
        message = f"the process that reads the description died: {death.reason}"
        diagnostics.add("SB902", message, span, notes=death.last_lines)
        return None
    if not description.observation.links:
        diagnostics.add("SB823", "the file has no links", span if macros is None else macros.places[0])
        return None
    if macros is None:
        return description
    files = (*macros.files, *description.files)
    return replace(description, files=files, expanded=macros.text, places=macros.places)


def _expanded(path: Path, options: Options, diagnostics: Diagnostics) -> Description | None:
    """The content of a file with macros; None after SB877 or what :func:`read_description` reports."""
    macros = expanded(path, options.xacro, options.package_path, diagnostics, options.workers)
    if macros is None:
        return None
    with TemporaryDirectory(dir=run_folder()) as folder:
        copy = Path(folder) / f"{path.name.partition('.')[0]}.urdf"
        copy.write_bytes(macros.text)
        return _described(copy, "urdf", options, diagnostics, macros)


def _without_line(message: str) -> tuple[str, int]:
    """A message of a parser without the line that it begins with, and this line; 0 for none."""
    line, text = re.match(r"(?:line (\d+): )?(.*)", message, re.DOTALL).groups()  # type: ignore[union-attr]
    return text, int(line or 0)


class Places:
    """Where a description states what findings begin with, such as ``joint 'elbow' ...``."""

    def __init__(self, path: Path, description: Description) -> None:
        self._path, self._description = path, description

    def of(self, finding: str) -> Span:
        """The place of a finding; the file alone where its subject is not stated."""
        subject = _SUBJECT.match(finding)
        offset = self._offset(*subject.groups()) if subject is not None else -1
        line = 0 if offset < 0 else bisect_left(self._ends, offset) + 1
        return self._description.place(self._path.as_posix(), line)

    def _offset(self, kind: str, name: str) -> int:
        if kind == "mesh":  # by its file
            offsets = (self._text.find(f"{quote}{escape(name)}{quote}") for quote in "\"'")
            return min((offset for offset in offsets if offset >= 0), default=-1)
        stated = self._elements.get(escape(name), ())
        return next((offset for tag, offset in stated if tag in _TAGS.get(kind, (tag,))), -1)

    @cached_property
    def _text(self) -> str:
        with open_regular(self._path) as file:
            content = self._description.expanded or file.read(HEAD)
        return content.decode("utf-8", "replace")

    @cached_property
    def _ends(self) -> list[int]:
        """Where lines end."""
        return [end.start() for end in re.finditer("\n", self._text)]

    @cached_property
    def _elements(self) -> dict[str, list[tuple[str, int]]]:
        """For each name the tags of its elements, and where these begin."""
        elements: dict[str, list[tuple[str, int]]] = {}
        for element in _NAMED.finditer(self._text):
            elements.setdefault(element[2][1:-1], []).append((element[1], element.start()))
        return elements


def described_robot(path: Path, options: Options, diagnostics: Diagnostics, *, drawn: bool = True) -> Robot | None:
    """The robot of a URDF, SDFormat or MJCF; None after an error.

    Args:
        path: The description, or a folder with the files of one robot, as `stepbot convert` writes it.
        drawn: Whether it is for a picture, where shapes and joints that are not shown are reported as SB825; otherwise
            they are errors.
    """
    path = robot_file(path)
    description = read_description(path, options, diagnostics)
    if description is None or diagnostics.has_errors:
        return None
    described = robot_of_description(description, path.stem, path.name, drawn=drawn)
    if not drawn:
        lacking = [finding for finding in described.findings if finding.code == UNSUPPORTED]
        places = Places(path, description)
        for one in lacking:
            diagnostics.add(one.code, one.text, places.of(one.text))
        return None if lacking else described.robot
    if described.missing:
        count = len(described.missing)
        message = f"{count} {'detail' if count == 1 else 'details'} of the file not shown"
        diagnostics.add("SB825", message, Span(path.as_posix()), notes=described.missing)
    return described.robot
