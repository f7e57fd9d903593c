"""What pydantic refuses, in a roboticist's words, with subject, place and remedy."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from ..diagnostics import Diagnostics, did_you_mean
from .fields import descriptions, is_origin, keys_below, keys_of, sections_at, top_level_keys_with
from .origins import FORMS
from .quantities import described
from .section import NOT_IN_FILE_NAMES, NOT_IN_NAMES
from .subjects import subject
from .tree import Keys, Mapping, Scalar, Tree, child, key_span, span, way

_ALSO_CALLED = {
    "hinge": "revolute",
    "rotary": "revolute",
    "rotational": "revolute",
    "slide": "prismatic",
    "slider": "prismatic",
    "linear": "prismatic",
    "spherical": "ball",
    "weld": "fixed",
    "rigid": "fixed",
    "free": "floating",
    "wheel": "continuous",
    "convex": "hull",
    "convex_hull": "hull",
    "torque": "motor",
    "effort": "motor",
    "ft": "force_torque",
    "motors": "actuators",
    "transmissions": "actuators",
    "loops": "closures",
    "constraints": "closures",
    "sites": "frames",
    "bodies": "links",
    "components": "parts",
    "pose": "origin",
    "range": "limits",
}
"""What other programs call the words of the sidecar."""


@dataclass(frozen=True)
class _Fault:
    code: str
    message: str
    """Without its subject."""
    help: tuple[str, ...] = ()
    of_key: bool = False
    """Whether the fault is the key's and not its value's."""
    above: bool = False
    """Whether it is told of the mapping above, because the key itself is the fault."""


def report_schema_faults(failure: ValidationError, root: Tree, whole: bool, found: Diagnostics) -> list[Keys]:
    """Report each fault that the schema finds; returns where they are.

    Args:
        failure: What pydantic says.
        root: The tree that it says it of.
        whole: Whether the tree is all of the file; keys that are missing at the top of a part of it are no fault.
        found: Where to report.
    """
    places = []
    for error in failure.errors(include_url=False):
        keys = _keys(error["loc"], root)
        places.append(keys)
        if way(root, keys)[-1].faulty or (not whole and error["type"] == "missing" and len(keys) < 2):
            continue
        fault = _fault(error, keys, root)
        if fault is None:
            continue
        told_of = keys[:-1] if fault.above else keys
        place = key_span(root, keys) if fault.of_key else span(root, keys)
        found.add(fault.code, f"{subject(told_of)}: {fault.message}", place, help=fault.help)
    return places


def _keys(loc: Iterable[str | int], root: Tree) -> Keys:
    """The place in the file that pydantic means, without the tags of unions."""
    keys: list[str | int] = []
    value: Tree | None = root
    for part in loc:
        below = child(value, part) if value is not None else None
        if below is None and isinstance(part, str) and part[:1] + part[-1:] in ("<>", "[]"):
            continue
        keys.append(part)
        value = below
    return tuple(keys)


def _fault(error: ErrorDetails, keys: Keys, root: Tree) -> _Fault | None:
    kind, context = str(error["type"]), error.get("ctx", {})
    value = way(root, keys)[-1]
    if kind.startswith("SB"):
        return _Fault(kind, context["text"], tuple(context["help"]))
    if kind == "extra_forbidden":
        return _unknown_key(error["loc"], str(keys[-1]))
    if kind == "missing":
        return _missing_key(error["loc"], keys)
    if kind.startswith("string_") and kind != "string_type":
        return _bad_name(kind, context, error, keys)
    if kind in ("enum", "literal_error"):
        return _wrong_word(error, keys, value)
    if kind == "union_tag_not_found":
        return _shape_without_type(value)
    if kind in ("too_short", "too_long"):
        return _wrong_count(keys, value)
    return _wrong_type(kind, keys, value, error)


def _unknown_key(loc: tuple[str | int, ...], key: str) -> _Fault:
    sections = sections_at(loc[:-1])
    keys = keys_of(sections)
    if is_origin(sections) and key in keys and key not in sections[0].model_fields:
        form = next((name for name in FORMS if name in sections[0].model_fields), "xyz")
        help = ["keep one of " + ", ".join(("xyz", *FORMS)) + "; radius and near go with axis_of, mate and auto"]
        return _Fault("SB128", f"'{key}' does not go together with '{form}'", tuple(help), of_key=True, above=True)
    help = [*did_you_mean(key, keys)]
    if key in _ALSO_CALLED and _ALSO_CALLED[key] in keys:
        help = [f"did you mean '{_ALSO_CALLED[key]}'?"]
    if not help:
        help = [f"it belongs in '{below}': `{below}: {{{key}: ...}}`" for below in keys_below(sections, key)]
    if not help and (elsewhere := [f"`{name}`" for name in top_level_keys_with(key)]):
        help = ["it is a key of " + ", ".join(elsewhere)]
    return _Fault("SB120", f"unknown key '{key}'", tuple(help or ["keys here: " + ", ".join(keys)]), True, True)


def _missing_key(loc: tuple[str | int, ...], keys: Keys) -> _Fault | None:
    key = keys[-1]
    if isinstance(key, int):  # the list is too short: reported for the list as a whole
        return None
    meaning = descriptions(sections_at(loc[:-1])[0]).get(key, "")
    return _Fault("SB121", f"key '{key}' is missing", (f"{key}: {meaning}",), of_key=True, above=True)


def _bad_name(kind: str, context: dict[str, Any], error: ErrorDetails, keys: Keys) -> _Fault:
    of_key, text = error["loc"][-1] == "[key]", str(error["input"])
    if kind == "string_too_short":
        return _Fault("SB126", "a name cannot be empty", of_key=of_key)
    if kind == "string_too_long":
        return _Fault("SB126", f"has {len(text)} characters, more than {context['max_length']}", of_key=of_key)
    allowed = "use letters, digits, '_', '-' and '.'"
    if text != text.strip():
        return _Fault("SB126", f"'{text}' starts or ends with a blank", (allowed,), of_key)
    names_material = keys[0] == "materials" or keys[-1] == "material"
    characters = NOT_IN_FILE_NAMES if keys == ("robot",) else "" if names_material else NOT_IN_NAMES
    wrong = [f"'{c}'" if c.isprintable() else f"U+{ord(c):04X}" for c in text if c in characters or not c.isprintable()]
    if not wrong:
        return _Fault("SB126", f"'{text}' starts or ends with a point, and files get this name", (allowed,), of_key)
    has = " and ".join(dict.fromkeys(wrong))
    why = "and files get this name" if keys == ("robot",) else "which not every output can carry"
    return _Fault("SB126", f"'{text}' has {has} in it, {why}", (allowed,), of_key)


def _wrong_word(error: ErrorDetails, keys: Keys, value: Tree) -> _Fault:
    if keys[-1] in ("origin", "frame"):
        form = "'auto' or a mapping, such as {axis_of: \"...\"}"
        return _Fault("SB123", f"an origin is {form}, not {_shown(value)}", _auto_hint(value))
    if not isinstance(value, Scalar):
        return _Fault("SB122", f"must be one of {_words(error)}, not {_shown(value)}")
    if keys[-1] == "auto":
        return _Fault("SB123", "must be true: leave it out, or choose another form of origin")
    words = [word.strip("'") for word in _words(error).split(", ")]
    also = _ALSO_CALLED.get(value.text.lower())
    near = (f"did you mean '{also}'?",) if also in words else did_you_mean(value.text, words)
    return _Fault("SB123", f"'{value.text}' is not possible here", (*near, f"possible: {', '.join(words)}"))


def _words(error: ErrorDetails) -> str:
    return str(error.get("ctx", {}).get("expected", "")).replace(" or ", ", ")


def _auto_hint(value: Tree) -> tuple[str, ...]:
    return did_you_mean(value.text, ["auto"]) if isinstance(value, Scalar) else ()


def _shape_without_type(value: Tree) -> _Fault:
    shapes = "box, cylinder, sphere, capsule"
    if not isinstance(value, Mapping):
        return _Fault("SB122", f"a shape is a mapping with a type, not {_shown(value)}", (f"types: {shapes}",))
    if "type" not in value.entries:
        return _Fault("SB121", "key 'type' is missing", (f"type: one of {shapes}",), of_key=True)
    kind = value.entries["type"].value
    near = did_you_mean(kind.text, shapes.split(", ")) if isinstance(kind, Scalar) else ()
    return _Fault("SB123", f"there is no shape of type {_shown(kind)}", (*near, f"possible: {shapes}"))


def _wrong_count(keys: Keys, value: Tree) -> _Fault:
    if keys == ("links",):
        return _Fault("SB121", "there is no link", ("a robot has at least one: `base: {rest: true}`",))
    count = f", not {len(value.values)}" if hasattr(value, "values") else ""
    return _Fault("SB122", f"two component paths are needed{count}", ('mate: ["first", "second"]',))


_TYPES = {
    "string_type": "text",
    "bool_type": "true or false",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "tuple_type": "a list",
}


def _wrong_type(kind: str, keys: Keys, value: Tree, error: ErrorDetails) -> _Fault:
    if kind not in _TYPES:
        return _Fault("SB122", error["msg"][:1].lower() + error["msg"][1:])
    return _Fault("SB122", f"must be {_TYPES[kind]}, not {_shown(value)}", _type_hint(kind, keys, value))


def _type_hint(kind: str, keys: Keys, value: Tree) -> tuple[str, ...]:
    if isinstance(value, Scalar):
        if kind == "string_type":
            return (f'write it in quotes: "{value.text}"',)
        if kind == "bool_type" and value.text.lower() in ("yes", "no", "on", "off", "y", "n"):
            return ("YAML 1.2 knows only true and false",)
        if kind == "tuple_type":
            return (f'a list of one: ["{value.text}"]',)
        if kind != "bool_type" and value.plain and ":" in value.text:
            return ("a colon needs a space after it: `key: value`",)
    if "dict" in kind or "model" in kind:
        names = len(keys) < 2 or kind == "dict_type"
        return ("write `name: {key: value}` for each",) if names else ("write `key: value` lines, or {key: value}",)
    return ()


def _shown(value: Tree) -> str:
    if isinstance(value, Scalar):
        return described(value.value)
    return "a mapping" if isinstance(value, Mapping) else "a list"
