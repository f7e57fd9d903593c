"""Any value of the sidecar set, marks of the draft confirmed, findings ignored: one mechanism for every key."""

from typing import Any

from stepbot.sidecar.draft_comments import without_reviews
from stepbot.sidecar.editing import Annotate, Append, CannotEdit, Change, Put, Remove, value_of
from stepbot.sidecar.ignored import KEY as IGNORED
from stepbot.sidecar.ignored import can_ignore
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.subjects import ELEMENTS
from stepbot.sidecar.tree import Keys, Mapping, way

from .joint_edits import change_type
from .local_server import Refused
from .questions import Json, text
from .renaming import NAMED, require_free, require_portable

_LONGEST = 4000
"""Characters of a value."""
_DEEPEST = 8
"""Keys on the way to a value."""
_DECIDED = ("defaults", "root")
"""Sections whose REVIEW comments a new value answers."""


def set_value(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{keys, text}``, the value at keys as YAML on one line, or ``{keys, value}``; an empty one removes it."""
    keys = keys_of(question)
    value = _value(question)
    if value == "" and "value" in question:
        value = None
    if keys[0] == "joints" and keys[2:] == ("type",):
        return change_type(sidecar, {"joint": keys[1], "kind": value})
    values = way(sidecar.root, keys)
    exists = len(values) == len(keys) + 1
    reviewed: list[Change] = [Annotate(keys[:1], without_reviews)] if keys[0] in _DECIDED and len(values) > 1 else []
    if value is None:
        return [Remove(keys), *(reviewed if _has_other(sidecar, keys) else [])] if exists else []
    if len(values) <= 2 <= len(keys) and keys[0] in ELEMENTS:
        require_portable(str(keys[1]))
        if keys[0] in NAMED:
            require_free(sidecar.document, str(keys[0]), str(keys[1]))
    # A word that stands for settings, such as `limits: todo`, gives way to them.
    last = len(values) - 1
    if not exists and last > 0 and not isinstance(values[-1], Mapping):
        for key in reversed(keys[last:]):
            value = {str(key): value}
        keys = keys[:last]
    return [Put(keys, value), *reviewed]


def append(sidecar: Sidecar, question: Json) -> list[Change]:  # noqa: ARG001 - every action gets it
    """``{keys, value}``: an item at the end of a list."""
    return [Append(keys_of(question), question.get("value"))]


def confirm_marks(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{keys}``: the REVIEW comments of the draft about an entry are settled."""
    keys = keys_of(question)
    if len(way(sidecar.root, keys)) != len(keys) + 1:
        raise Refused(f"there is no {'.'.join(map(str, keys))}")
    return [Annotate(keys, without_reviews)]


def ignore(sidecar: Sidecar, question: Json) -> list[Change]:  # noqa: ARG001
    """``{keys, code}``: a warning or note about an element is ignored there, or everywhere where it has no place."""
    keys, code = keys_of(question), text(question, "code")
    place: Keys = (*keys[:2], IGNORED) if can_ignore(keys) else (IGNORED,)
    return [Append(place, code)]


def keys_of(question: Json) -> Keys:
    """The keys at ``keys``: names, and indices of lists."""
    keys = question.get("keys")
    if not isinstance(keys, list) or not 0 < len(keys) <= _DEEPEST or not isinstance(keys[0], str):
        raise Refused("keys are expected")
    if not all(isinstance(key, str | int) and not isinstance(key, bool) and key != "" for key in keys):
        raise Refused("a key is a name or an index")
    return tuple(keys)


def _has_other(sidecar: Sidecar, keys: Keys) -> bool:
    section = way(sidecar.root, keys[:1])[-1]
    return isinstance(section, Mapping) and len(section.entries) > 1


def _value(question: Json) -> Any:
    if "value" in question:
        return question["value"]
    written = text(question, "text").strip()
    if not written:
        return None
    if len(written) > _LONGEST or not written.isprintable():
        raise Refused("a value is one line")
    try:
        return value_of(written)
    except CannotEdit as error:
        raise Refused(str(error)) from error
