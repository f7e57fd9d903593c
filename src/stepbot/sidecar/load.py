"""Load a sidecar: read, compose and validate; every error has a position."""

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from stepbot.diagnostics import Diagnostics, Span, did_you_mean

from . import VERSION
from .document import document_class
from .fitting import with_motors
from .located import Sidecar
from .quantities import described
from .salvage import check_what_is_left
from .schema_faults import report_schema_faults
from .syntax_faults import compose_around_faults
from .text import BoundedDiagnostics, TooManyFaultsError, file_name, is_text, read_text
from .tree import Keys, Mapping, Scalar, Tree, key_span, plain_data


def load_sidecar(path: Path, found: Diagnostics, variant: str = "", changes: Tree | None = None) -> Sidecar | None:
    """Read a sidecar; None if it has errors, which are all added to ``found``.

    Reports SB001 and SB1xx; where possible also the errors of
    :func:`stepbot.sidecar.check.check_sidecar`.

    Args:
        variant: One of its variants; empty for the sidecar as it is.
        changes: Values that another file merges into it.
    """
    text = read_text(path, found)
    return parse_sidecar(text, path, found, variant, changes) if text is not None else None


def parse_sidecar(
    text: str, path: Path, found: Diagnostics, variant: str = "", changes: Tree | None = None
) -> Sidecar | None:
    """Like :func:`load_sidecar`, from the text of a file."""
    local, sidecar, complete = BoundedDiagnostics(), None, True
    try:
        sidecar = _parsed(text, path, local, variant, changes)
    except TooManyFaultsError:
        complete = False
    local.hand_over(found, file_name(path), complete=complete)
    return None if local.has_errors else sidecar


def _parsed(text: str, path: Path, found: Diagnostics, variant: str, changes: Tree | None) -> Sidecar | None:
    file = file_name(path)
    if not is_text(text, file, found):
        return None
    composed = compose_around_faults(text, file, found)
    root = composed.tree
    if not isinstance(root, Mapping):
        if root is not None and composed.whole:
            help = ["start the sidecar with `version: 1`, without indentation"]
            found.add("SB102", "sidecar: top level is not a mapping", root.span, help=help)
        elif composed.whole and not found.has_errors:
            help = ["start with `version: 1`; see `stepbot docs sidecar`"]
            found.add("SB102", "sidecar: empty file (comments only)", Span(file), help=help)
        return None
    if variant or changes is not None:
        changed = _changed(root, variant, changes, found)
        if changed is None:
            return None
        root = changed
    data: dict[str, Any] = plain_data(root)
    if not _has_known_version(root, data, found):
        return None
    faults: list[Keys] = []
    try:
        document = document_class(data).model_validate(data)
    except ValidationError as failure:
        faults = report_schema_faults(failure, root, composed.whole, found)
    else:
        sidecar = with_motors(
            Sidecar(document, path, text, root, variant=variant, is_changed=changes is not None), found
        )
        if not found.has_errors:
            return sidecar
    if composed.whole:
        check_what_is_left(root, faults, path, text, found)
    return None


def _changed(root: Mapping, variant: str, changes: Tree | None, found: Diagnostics) -> Mapping | None:
    """The sidecar as its variant and with the changes of another file; None after SB160."""
    from .variants import merged, unknown_elements, with_variant

    varied = with_variant(root, variant, found) if variant else root
    if varied is None or changes is None:
        return varied
    for (section, name), known in unknown_elements(varied, changes):
        message = f"set: no {section.removesuffix('s')} '{name}' in '{Path(root.span.file).name}'"
        help = did_you_mean(name, known) or ((f"known: {', '.join(known[:6])}",) if known else ())
        found.add("SB160", message, key_span(changes, (section, name)), help=help)
    whole = merged(varied, changes)
    return whole if isinstance(whole, Mapping) and not found.has_errors else None


def _has_known_version(root: Mapping, data: dict[str, Any], found: Diagnostics) -> bool:
    """Whether the version is supported; keys may differ in other versions.

    A version that is not a number is reported and then replaced by the current one.
    """
    entry = root.entries.get("version")
    if entry is None or entry.value.faulty:
        return True
    version = data["version"]
    if isinstance(version, int) and not isinstance(version, bool):
        if version != VERSION:
            help = [f"supported: `version: {VERSION}`"]
            found.add("SB127", f"sidecar: unsupported version {version}", entry.value.span, help=help)
        return bool(version == VERSION)
    written_as = (
        f"'{entry.value.text}'" if isinstance(entry.value, Scalar) and entry.value.plain else described(version)
    )
    message = f"sidecar: version must be the number {VERSION}, not {written_as}"
    help = [f"write `version: {VERSION}`, without quotes or decimals"]
    found.add("SB127", message, entry.value.span, help=help)
    data["version"] = VERSION
    return True
