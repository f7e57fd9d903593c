"""From a file to a sidecar: read, composed, validated, every fault at its place."""

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from stepbot.diagnostics import Diagnostics, Span

from . import VERSION
from .bounds import BoundedDiagnostics, TooManyFaultsError
from .document import Document
from .located import Sidecar
from .quantities import described
from .salvage import check_what_is_left
from .schema_faults import report_schema_faults
from .syntax_faults import compose_around_faults
from .text import file_name, is_text, read_text
from .tree import Keys, Mapping, Scalar, plain_data


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
    written_as = (
        f"'{entry.value.text}'" if isinstance(entry.value, Scalar) and entry.value.plain else described(version)
    )
    message = f"sidecar: version must be the number {VERSION}, not {written_as}"
    help = [f"write `version: {VERSION}`, without quotes and without decimals"]
    found.add("SB127", message, entry.value.span, help=help)
    data["version"] = VERSION
    return True
