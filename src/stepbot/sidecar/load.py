"""Load a sidecar: read, compose and validate; every error has a position.

Of a sidecar with errors the valid parts are checked too, so that all errors are reported in one run: invalid values are
removed until the rest is a valid document; then it is checked like any other, and diagnostics that may be caused by the
removal are dropped.
"""

from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from stepbot.diagnostics import Diagnostic, Diagnostics, Span, did_you_mean

from . import VERSION
from .check import check_sidecar
from .document import Document, document_class
from .fitting import with_motors
from .located import NO_MOTORS, OwnMotors, Sidecar
from .quantities import described
from .schema_faults import place_of, report_schema_faults
from .syntax_faults import ParsedText, compose_around_faults
from .text import BoundedDiagnostics, TooManyFaultsError, is_text, read_text
from .tree import Keys, Mapping, Scalar, Tree, child, key_span, plain_data, subject


def load_sidecar(
    path: Path, diagnostics: Diagnostics, variant: str = "", module: Tree | None = None, motors: OwnMotors = NO_MOTORS
) -> Sidecar | None:
    """Read a sidecar; None if it has errors, which are all added to ``diagnostics``.

    Reports SB001 and SB1xx; where possible also the errors of
    :func:`stepbot.sidecar.check.check_sidecar`.

    Args:
        variant: One of its variants; empty for the sidecar as it is.
        module: The module of another file that selects the variant and, under ``set``, changes values.
        motors: The motors of that file, which the module's own go before.
    """
    text = read_text(path, diagnostics)
    return parse_sidecar(text, path, diagnostics, variant, module, motors) if text is not None else None


def parse_sidecar(
    text: str,
    path: Path,
    diagnostics: Diagnostics,
    variant: str = "",
    module: Tree | None = None,
    motors: OwnMotors = NO_MOTORS,
) -> Sidecar | None:
    """Like :func:`load_sidecar`, from the text of a file."""
    local, sidecar, complete = BoundedDiagnostics(), None, True
    try:
        sidecar = _parsed(text, path, local, variant, module, motors)
    except TooManyFaultsError:
        complete = False
    local.hand_over(diagnostics, path.as_posix(), complete=complete)
    return None if local.has_errors else sidecar


def _parsed(
    text: str, path: Path, diagnostics: Diagnostics, variant: str, module: Tree | None, motors: OwnMotors
) -> Sidecar | None:
    file = path.as_posix()
    if not is_text(text, file, diagnostics):
        return None
    try:
        composed, faults_of_text = _composed(text, file)
    except TooManyFaultsError:
        compose_around_faults(text, file, diagnostics)  # ends in the same way, with the faults in `diagnostics`
        raise
    diagnostics.extend(faults_of_text)
    root = composed.tree
    if not isinstance(root, Mapping):
        if root is not None and composed.whole:
            help = ["start the sidecar with `version: 1`, without indentation"]
            diagnostics.add("SB102", "sidecar: top level is not a mapping", root.span, help=help)
        elif composed.whole and not diagnostics.has_errors:
            help = ["start with `version: 1`; see `stepbot docs sidecar`"]
            diagnostics.add("SB102", "sidecar: empty file (comments only)", Span(file), help=help)
        return None
    changes = None if module is None else child(module, "set")
    if variant or changes is not None:
        changed = _changed(root, variant, module, diagnostics)
        if changed is None:
            return None
        root = changed
    data: dict[str, Any] = plain_data(root)
    if not _has_known_version(root, data, diagnostics):
        return None
    faults: list[Keys] = []
    try:
        document = document_class(data).model_validate(data)
    except ValidationError as failure:
        faults = report_schema_faults(failure, root, composed.whole, diagnostics)
    else:
        read = Sidecar(document, path, text, root, own_motors=motors, variant=variant, is_changed=changes is not None)
        sidecar = with_motors(read, diagnostics)
        if not diagnostics.has_errors:
            return sidecar
    if composed.whole:
        check_what_is_left(root, faults, path, text, diagnostics)
    return None


@lru_cache(maxsize=4)
def _composed(text: str, file: str) -> tuple[ParsedText, tuple[Diagnostic, ...]]:
    """The tree of a text with its faults; kept, as a page that edits asks for the text before and after many times."""
    diagnostics = BoundedDiagnostics()
    composed = compose_around_faults(text, file, diagnostics)
    return composed, tuple(diagnostics)


def _changed(root: Mapping, variant: str, module: Tree | None, diagnostics: Diagnostics) -> Mapping | None:
    """The sidecar as its variant and with the changes of another file; None after SB160."""
    from .variants import merged, report_undropped, unknown_elements, with_variant

    changes = None if module is None else child(module, "set")
    varied = with_variant(root, variant, diagnostics, module) if variant else root
    if varied is None or changes is None:
        return varied
    for (section, name), known in unknown_elements(varied, changes):
        message = f"set: no {section.removesuffix('s')} '{name}' in '{Path(root.span.file).name}'"
        help = did_you_mean(name, known) or ((f"known: {', '.join(known[:6])}",) if known else ())
        diagnostics.add("SB160", message, key_span(changes, (section, name)), help=help)
    report_undropped(varied, changes, "set", diagnostics)
    whole = merged(varied, changes)
    return whole if isinstance(whole, Mapping) and not diagnostics.has_errors else None


def _has_known_version(root: Mapping, data: dict[str, Any], diagnostics: Diagnostics) -> bool:
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
            diagnostics.add("SB127", f"sidecar: unsupported version {version}", entry.value.span, help=help)
        return bool(version == VERSION)
    written_as = (
        f"'{entry.value.text}'" if isinstance(entry.value, Scalar) and entry.value.plain else described(version)
    )
    message = f"sidecar: version must be the number {VERSION}, not {written_as}"
    help = [f"write `version: {VERSION}`, without quotes or decimals"]
    diagnostics.add("SB127", message, entry.value.span, help=help)
    data["version"] = VERSION
    return True


_ROUNDS = 6
"""Maximum number of passes that remove invalid values."""
_STAND_INS = {"version": VERSION, "robot": "robot", "step": "robot.step"}
_FOLLOWS_FROM_CUT: dict[str, tuple[str, ...]] = {
    "links": ("SB130:link",),
    "joints": ("SB130:joint", "SB133", "SB450:disconnected"),
    "joint_defaults": ("SB455",),
    "materials": ("SB130:material",),
}
"""Codes that removing a section, or a name in it, may cause elsewhere."""
_FOLLOWS_FROM_POSITION = ("SB460",)
"""Codes that removing a position or a limit of a joint may cause on the joints that follow it."""
_STANDS_ALONE = (
    "SB126",
    "SB128",
    "SB130:link",
    "SB130:joint",
    "SB130:material",
    "SB134",
    "SB135",
    "SB139",
    "SB140",
    "SB521",
    "SB450",
)
"""Codes that a removal elsewhere in the same joint, link or frame cannot cause."""


def check_what_is_left(root: Tree, faults: list[Keys], path: Path, text: str, diagnostics: Diagnostics) -> None:
    """Check the parts of a document that are not affected by the schema errors at the places ``faults``."""
    data = plain_data(root, shared=False)
    cuts: list[Keys] = []
    for _ in range(_ROUNDS):
        new: list[Keys] = []
        for keys in faults:
            if not any(keys[: len(cut)] == cut for cut in new):
                new.append(_cut(data, keys))
        cuts += new
        if () in cuts:
            return
        try:
            document = document_class(data).model_validate(data)
        except ValidationError as failure:
            faults = [place_of(error["loc"], root) for error in failure.errors(include_url=False)]
        else:
            break
    else:
        return
    left = Diagnostics()
    check_sidecar(Sidecar(document, path, text, root), left)
    reported = {d.span for d in diagnostics}
    diagnostics.extend(d for d in left if d.span not in reported and not _follows_from(d, cuts))


def _follows_from(diagnostic: Diagnostic, cuts: list[Keys]) -> bool:
    """Whether a diagnostic may be caused by a removed value."""
    for cut in cuts:
        is_about_cut = diagnostic.message.startswith(subject(cut[:2]) + ":")
        if is_about_cut and (diagnostic.code not in _STANDS_ALONE or {"origin", "frame"} & set(cut[1:])):
            return True
        is_of_kind = cut[0] == "actuators" and cut[-1] == "kind" and diagnostic.code == "SB459"
        if is_of_kind and f"(first is '{cut[1]}')" in diagnostic.message:  # a duplicate of the one without its kind
            return True
        if cut[0] in ("joints", "joint_defaults") and diagnostic.code in _FOLLOWS_FROM_POSITION:
            return True
        is_whole = len(cut) <= 2 or cut[0] == "joint_defaults"
        if is_whole and diagnostic.code in _consequences(str(cut[0])):
            return True
    return False


def _consequences(section: str) -> tuple[str, ...]:
    """Codes that removing a section may cause; for an unknown section, those of the closest match."""
    if section in Document.model_fields:
        return _FOLLOWS_FROM_CUT.get(section, ())
    meant = get_close_matches(section, _FOLLOWS_FROM_CUT, n=1) or _FOLLOWS_FROM_CUT
    return tuple(code for name in meant for code in _FOLLOWS_FROM_CUT[name])


def _cut(data: dict[str, Any], keys: Keys) -> Keys:
    """Remove the value at ``keys``, or the mapping that lacks it; returns its keys, ``()`` for the whole document."""
    if keys[0] in _STAND_INS:
        data[str(keys[0])] = _STAND_INS[str(keys[0])]
        return keys[:1]
    indices = [n for n, key in enumerate(keys) if isinstance(key, int)]
    keys = keys[: indices[0]] if indices else keys  # a list is removed as a whole: its indices would shift
    above: Any = data
    for key in keys[:-1]:
        above = above[key]
    if keys[-1] not in above:  # a missing key: remove the mapping that lacks it
        return _cut(data, keys[:-1]) if len(keys) > 1 else ()
    del above[keys[-1]]
    return keys
