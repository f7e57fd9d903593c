"""Checks the valid parts of a sidecar with errors, so that all errors are reported in one run.

Invalid values are removed until the rest is a valid document; then it is checked like any other, and diagnostics that
may be caused by the removal are dropped.
"""

from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from stepbot.diagnostics import Diagnostic, Diagnostics

from . import VERSION
from .check import check_sidecar
from .document import Document, document_class
from .located import Sidecar
from .subjects import subject
from .tree import Keys, Listing, Mapping, Scalar, Tree

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


def check_what_is_left(root: Tree, faults: list[Keys], path: Path, text: str, found: Diagnostics) -> None:
    """Check the parts of a document that are not affected by schema errors.

    Args:
        faults: The places of the schema errors.
        path: The user's path of the file.
    """
    data = _copy(root)
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
            faults = [_without_tags(error["loc"], data) for error in failure.errors(include_url=False)]
        else:
            break
    else:
        return
    left = Diagnostics()
    check_sidecar(Sidecar(document, path, text, root), left)
    reported = {d.span for d in found}
    found.extend(d for d in left if d.span not in reported and not _follows_from(d, cuts))


def _follows_from(diagnostic: Diagnostic, cuts: list[Keys]) -> bool:
    """Whether a diagnostic may be caused by a removed value."""
    for cut in cuts:
        is_about_cut = diagnostic.message.startswith(subject(cut[:2]) + ":")
        if is_about_cut and (diagnostic.code not in _STANDS_ALONE or {"origin", "frame"} & set(cut[1:])):
            return True
        if cut[0] == "actuators" and cut[-1] == "kind" and _is_on_one_joint_with(str(cut[1]), diagnostic):
            return True
        if cut[0] in ("joints", "joint_defaults") and diagnostic.code in _FOLLOWS_FROM_POSITION:
            return True
        is_whole = len(cut) <= 2 or cut[0] == "joint_defaults"
        if is_whole and diagnostic.code in _consequences(str(cut[0])):
            return True
    return False


def _is_on_one_joint_with(actuator: str, diagnostic: Diagnostic) -> bool:
    """Whether a diagnostic is a duplicate of an actuator whose invalid kind was removed."""
    return diagnostic.code == "SB459" and f"(first is '{actuator}')" in diagnostic.message


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


def _without_tags(loc: tuple[str | int, ...], data: Any) -> Keys:
    keys: list[str | int] = []
    for part in loc:
        inside = (isinstance(data, dict) and part in data) or (isinstance(data, list) and isinstance(part, int))
        if not inside and isinstance(part, str) and part[:1] + part[-1:] in ("<>", "[]"):
            continue
        keys.append(part)
        data = data[part] if inside and (isinstance(data, dict) or len(data) > int(part)) else None
    return tuple(keys)


def _copy(tree: Tree) -> Any:
    """The tree as data without shared objects, so that removing one leaves the other."""
    if isinstance(tree, Scalar):
        return tree.value
    if isinstance(tree, Listing):
        return [_copy(value) for value in tree.values]
    assert isinstance(tree, Mapping)
    return {key: _copy(entry.value) for key, entry in tree.entries.items()}
