"""From a file to a sidecar: read, composed, validated, every fault at its place."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..diagnostics import Diagnostics, Span
from .bounds import BoundedDiagnostics, TooManyFaultsError
from .document import Document
from .quantities import described
from .schema_faults import report_schema_faults
from .syntax_faults import compose_around_faults
from .text import file_name, is_text, read_text
from .tree import Keys, Listing, Mapping, Scalar, Tree, key_span, plain_data, span, way

VERSION = 1
"""The version of the sidecar that this stepbot reads."""


@dataclass(frozen=True)
class Sidecar:
    """A sidecar that was read, and the places of all its values."""

    document: Document
    path: Path
    """As the user gave it."""
    text: str
    """With line feeds at line ends."""
    root: Tree
    """The values with their places."""

    @property
    def step_path(self) -> Path:
        """The STEP file that it names."""
        return self.path.parent / self.document.step

    def span(self, *keys: str | int) -> Span:
        """Place of the value at ``keys``, or of the nearest key above it that exists."""
        return span(self.root, keys)

    def key_span(self, *keys: str | int) -> Span:
        """Place of the last of ``keys`` itself, or of the nearest above it that exists."""
        return key_span(self.root, keys)

    def written(self, *keys: str | int) -> str:
        """A single value as the file writes it, without quotes; empty where there is none."""
        value = self._scalar(keys)
        return value.text if value is not None else ""

    def quoting_hints(self, *keys: str | int) -> tuple[str, ...]:
        """Remedies for a path that matches nothing, where missing quotes may have cut it short.

        Without quotes ``[XL,XC-330 v1]`` is a list of two, and ``ID #71`` ends before its ``#``, a comment.
        """
        value = self._scalar(keys)
        if value is None or not value.plain or not value.span.end_column:
            return ()
        line = self.text.split("\n")[value.span.line - 1]
        before, after = line[: value.span.column - 1], line[value.span.end_column - 1 :]
        if comment := re.match(r" +#\S[^,\]}]*", after):
            return (f'a # after a blank starts a comment; in quotes it does not: "{value.text}{comment[0].rstrip()}"',)
        above = way(self.root, keys)[-2] if keys else None
        if isinstance(above, Listing) and above.flow and (before.endswith(",") or re.match(r",\S", after)):
            return ("a comma in a list without quotes separates two values; a name with a comma goes in quotes",)
        return ()

    def plain_number(self, *keys: str | int) -> float | None:
        """A value that is written as a number without a unit; None where it is anything else."""
        value = self._scalar(keys)
        if value is None or isinstance(value.value, bool) or not isinstance(value.value, int | float):
            return None
        return float(value.value)

    def _scalar(self, keys: Keys) -> Scalar | None:
        values = way(self.root, keys)
        value = values[-1]
        return value if isinstance(value, Scalar) and len(values) == len(keys) + 1 else None


def load_sidecar(path: Path, found: Diagnostics) -> Sidecar | None:
    """Read a sidecar; None where it has errors, all of which are then in ``found``.

    Reports SB001 and SB1xx; where the rest of a faulty file allows it, also what
    :func:`stepbot.sidecar.check.check_sidecar` would find.
    """
    text = read_text(path, found)
    return parse_sidecar(text, path, found) if text is not None else None


def parse_sidecar(text: str, path: Path, found: Diagnostics) -> Sidecar | None:
    """Like :func:`load_sidecar`, from the text of a file."""
    local, sidecar, complete = BoundedDiagnostics(), None, True
    try:
        sidecar = _parsed(text, path, local)
    except TooManyFaultsError:
        complete = False
    local.hand_over(found, file_name(path), complete=complete)
    return None if local.has_errors else sidecar


def _parsed(text: str, path: Path, found: Diagnostics) -> Sidecar | None:
    file = file_name(path)
    if not is_text(text, file, found):
        return None
    composed = compose_around_faults(text, file, found)
    root = composed.tree
    if not isinstance(root, Mapping):
        if root is not None and composed.whole:
            help = ["a sidecar starts with `version: 1` at the left margin"]
            found.add("SB109", "sidecar: the file is not a mapping", root.span, help=help)
        elif composed.whole and not found.has_errors:
            found.add("SB103", "sidecar: the file holds nothing but comments", Span(file))
        return None
    data: dict[str, Any] = plain_data(root)
    if not _has_known_version(root, data, found):
        return None
    faults: list[Keys] = []
    try:
        document = Document.model_validate(data)
    except ValidationError as failure:
        faults = report_schema_faults(failure, root, composed.whole, found)
    else:
        if not found.has_errors:
            return Sidecar(document, path, text, root)
    if composed.whole:
        from .salvage import check_what_is_left

        check_what_is_left(root, faults, path, text, found)
    return None


def _has_known_version(root: Mapping, data: dict[str, Any], found: Diagnostics) -> bool:
    """Whether the rest can be read: of another version, keys may mean something else.

    A version that is no number is reported, and read as ours.
    """
    entry = root.entries.get("version")
    if entry is None or entry.value.faulty:
        return True
    version = data["version"]
    if isinstance(version, int) and not isinstance(version, bool):
        if version != VERSION:
            help = [f"this stepbot reads `version: {VERSION}`"]
            found.add("SB127", f"sidecar: version {version} is not known", entry.value.span, help=help)
        return bool(version == VERSION)
    message = f"sidecar: version must be the number {VERSION}, not {described(version)}"
    found.add("SB127", message, entry.value.span, help=[f"write `version: {VERSION}`, without quotes"])
    data["version"] = VERSION
    return True
