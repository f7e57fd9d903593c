"""Diagnostics for pydantic validation errors, with subject, position and remedy."""

from collections.abc import Iterable, Sequence
from typing import Any

from msgspec import Struct
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.robot.model import JointKind

from .contact import ContactMaterial
from .fields import descriptions, is_origin, keys_below, keys_of, sections_at, top_level_keys_with
from .joint_settings import position_dimension, settings_of
from .origins import FORMS
from .quantities import described
from .remedies import remedy, written
from .section import NOT_IN_FILE_NAMES, NOT_IN_NAMES, REFERENCE_PATTERN
from .tree import Keys, Listing, Mapping, Scalar, Tree, child, key_span, span, subject, way
from .units import Dimension, UnitError, read_quantity
from .variants import OWN_KEYS
from .vocabulary import ALSO_CALLED, NOT_SAID_SO, likely_meant, meant_by

_FIRST_LINES = {
    "version": "add the line `version: 1` at the top",
    "robot": "add the name of the robot and its files at the top, for example `robot: arm`",
    "step": "add the path of the STEP file, relative to the sidecar, at the top, for example `step: arm.step`",
}
"""Remedies for missing top-level keys."""
_GAINS = {"kp": "stiffness", "kv": "damping"}
"""Settings of a joint with the dimensions of an actuator's gains."""
_LONGEST_SNIPPET = 60
"""Maximum length of a value in a snippet."""


class _Fault(Struct, frozen=True):
    code: str
    message: str
    """Without its subject."""
    help: tuple[str, ...] = ()
    """Empty texts are left out."""
    of_key: bool = False
    """Whether the position is that of the key, not of its value."""
    above: bool = False
    """Whether the subject is the parent mapping, because the key itself is invalid."""


def report_schema_faults(failure: ValidationError, root: Tree, whole: bool, diagnostics: Diagnostics) -> list[Keys]:
    """Report all validation errors; returns their positions.

    Args:
        whole: Whether the tree is the whole file; if not, missing top-level keys are not reported.
    """
    places = []
    for error in failure.errors(include_url=False):
        keys = place_of(error["loc"], root)
        places.append(keys)
        if way(root, keys)[-1].faulty or (not whole and error["type"] == "missing" and len(keys) < 2):
            continue
        fault = _fault(error, keys, root)
        if fault is None:
            continue
        told_of = keys[:-1] if fault.above else keys
        place = key_span(root, keys) if fault.of_key else span(root, keys)
        diagnostics.add(fault.code, f"{subject(told_of)}: {fault.message}", place, help=[*filter(None, fault.help)])
    return places


def place_of(loc: Iterable[str | int], root: Tree) -> Keys:
    """The place of an error as given by pydantic, without the tags of unions."""
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
        if kind == "SB124" and (exact := _fault_of_unit(keys, value, root)):
            return exact
        snippet = remedy(keys, value) if kind in ("SB122", "SB123") else ""
        if not snippet and context["text"].startswith(("expected a number", "expected an integer")):
            snippet = _one_of_list(keys, value)
        return _Fault(kind, context["text"], (snippet, *context["help"]))
    if kind == "extra_forbidden":
        return _unknown_key(error["loc"], keys, root)
    if kind == "missing":
        return _missing_key(error["loc"], keys, root)
    if kind.startswith("string_") and kind != "string_type":
        return _bad_name(kind, context, error, keys, root)
    if kind in ("enum", "literal_error"):
        return _wrong_word(error, keys, value)
    if kind == "union_tag_not_found":
        return _shape_without_type(value)
    if kind in ("too_short", "too_long"):
        return _wrong_count(keys, value)
    if kind not in _TYPES:
        return _Fault("SB122", error["msg"][:1].lower() + error["msg"][1:])
    hint = _type_hint(kind, error["loc"], keys, value)
    return _Fault("SB122", f"expected {_TYPES[kind]}, not {_shown(value)}", (hint,))


def _unknown_key(loc: tuple[str | int, ...], place: Keys, root: Tree) -> _Fault:
    key, value = str(place[-1]), way(root, place)[-1]
    sections = sections_at(loc[:-1])
    keys = keys_of(sections)
    if is_origin(sections) and key in keys and key not in sections[0].model_fields:
        form = next((name for name in FORMS if name in sections[0].model_fields), "xyz")
        help = ["keep one of " + ", ".join(("xyz", *FORMS)) + "; radius and near are valid with axis_of, mate and auto"]
        return _Fault("SB128", f"'{key}' cannot be combined with '{form}'", tuple(help), of_key=True, above=True)
    below = keys_below(sections, key)
    if key == "material" and getattr(value, "text", "") not in {*ContactMaterial}:  # that of a part, not of a contact
        below = tuple(section for section in below if section != "contact")
    help = _where_a_key_belongs(place, value, root, keys, below)
    return _Fault("SB120", f"unknown key '{key}'", tuple(help or ["keys here: " + ", ".join(keys)]), True, True)


def _where_a_key_belongs(place: Keys, value: Tree, root: Tree, keys: Sequence[str], below: Sequence[str]) -> list[str]:
    """Suggestions for an unknown key: aliases and sections that define it first, similar names last."""
    key = str(place[-1])
    in_section = bool(below) and isinstance(value, Scalar)  # `material: pla` belongs to `defaults`, not `materials`
    if (meant := meant_by(key, keys)) and not in_section:
        snippet = remedy((*place[:-1], meant), value) if isinstance(value, Listing) else ""
        return [f"did you mean '{meant}'?", snippet]
    if key in NOT_SAID_SO:
        return [NOT_SAID_SO[key]]
    if below:
        return [f"move it to '{section}': `{section}: {{{key}: {_shortly(value)}}}`" for section in below]
    if place[0] == "modules" and key in keys_of(sections_at(())):
        return [f"what it changes in the module's file is under `set`: `set: {{{key}: {_shortly(value)}}}`"]
    elsewhere = [name for name in top_level_keys_with(key) if name != "expect"]  # which states results
    if "parts" in elsewhere and place[0] == "links" and isinstance(value, Scalar):
        parts = child(way(root, place[:-1])[-1], "parts")
        first = written(parts.values[0]) if isinstance(parts, Listing) and parts.values else '"..."'
        rule = f"`parts: {{{first}: {{{key}: {_shortly(value)}}}}}`"
        return [f"it belongs to the top-level section `parts`: {rule}"]
    if elsewhere:
        return ["it is valid in " + ", ".join(f"`{name}`" for name in elsewhere)]
    return list(did_you_mean(key, keys) or did_you_mean(key, OWN_KEYS if len(place) == 1 else ()))


def _shortly(value: Tree) -> str:
    text = written(value)
    return text if len(text) <= _LONGEST_SNIPPET else "..."


def _missing_key(loc: tuple[str | int, ...], keys: Keys, root: Tree) -> _Fault | None:
    key = keys[-1]
    if isinstance(key, int) or _where_a_module_has_it(keys, root):
        return None  # reported for the list as a whole, or for the name
    sections = sections_at(loc[:-1])
    above = way(root, keys[:-1])[-1]
    if isinstance(above, Mapping):
        known = keys_of(sections)
        if any(likely_meant(name, known) == key for name in above.entries if name not in known):
            return None  # it exists under another name: reported as an unknown key
    meaning = descriptions(sections[0]).get(key, "")
    help = _FIRST_LINES.get(key, "") if len(keys) == 1 else ""
    return _Fault("SB121", f"missing key '{key}'", (help or f"{key}: {meaning}",), of_key=True, above=True)


def _where_a_module_has_it(keys: Keys, root: Tree) -> str:
    """Where `leg/knee` below `joints` can be changed, if `leg` is a module; else nothing."""
    module, _, name = str(keys[1]).partition("/") if len(keys) > 1 else ("", "", "")
    if not name or len(way(root, ("modules", module))) < 3:
        return ""
    return f"`modules: {{{module}: {{set: {{{keys[0]}: {{{name}: ...}}}}}}}}` changes that of module '{module}'"


def _bad_name(kind: str, context: dict[str, Any], error: ErrorDetails, keys: Keys, root: Tree) -> _Fault:
    of_key, text = error["loc"][-1] == "[key]", str(error["input"])
    if kind == "string_too_short":
        return _Fault("SB126", "empty name", of_key=of_key)
    if kind == "string_too_long":
        return _Fault("SB126", f"name has {len(text)} characters (maximum {context['max_length']})", of_key=of_key)
    allowed = "use letters, digits, '_', '-' and '.'"
    if text != text.strip():
        return _Fault("SB126", f"'{text}' starts or ends with a space", (allowed,), of_key)
    names_material = keys[0] == "materials" or keys[-1] == "material"
    if context.get("pattern") == REFERENCE_PATTERN and "/" in text and not all(text.split("/")):
        return _Fault("SB126", f"'{text}': empty name before or after '/'", ("example: arm/tool0",), of_key)
    characters = NOT_IN_FILE_NAMES if keys == ("robot",) else "" if names_material else NOT_IN_NAMES
    wrong = [f"'{c}'" if c.isprintable() else f"U+{ord(c):04X}" for c in text if c in characters or not c.isprintable()]
    if not wrong:
        message = f"'{text}' starts or ends with a dot, which is not allowed in file names"
        return _Fault("SB126", message, (allowed,), of_key)
    has = " and ".join(dict.fromkeys(wrong))
    why = "which is not allowed in file names" if keys == ("robot",) else "which is not supported by all formats"
    return _Fault("SB126", f"'{text}' contains {has}, {why}", (_where_a_module_has_it(keys, root) or allowed,), of_key)


def _wrong_word(error: ErrorDetails, keys: Keys, value: Tree) -> _Fault:
    if keys[-1] in ("origin", "frame"):
        form = "'auto' or a mapping such as {axis_of: \"...\"}"
        help = did_you_mean(value.text, ["auto"]) if isinstance(value, Scalar) else (remedy(keys, value),)
        return _Fault("SB123", f"expected {form}, not {_shown(value)}", help)
    if keys[-1] == "limits":
        help = ("write {lower: ..., upper: ...}, or `todo` as a placeholder",)
        return _Fault("SB123", f"expected a mapping or `todo`, not {_shown(value)}", help)
    if keys[:-1] == ("self_collision", "exclude"):
        return _Fault("SB123", f"expected one of {_words(error)}, not {_shown(value)}", (_KINDS_OF_PAIRS,))
    if not isinstance(value, Scalar):
        first, choices = child(value, 0), _words(error)
        meant = f"'{first.text}'" in choices if isinstance(first, Scalar) else False
        help = (_one_of_list(keys, value) if meant else f"choices: {choices}",)
        return _Fault("SB122", f"expected one of {choices}, not {_shown(value)}", help)
    if keys[-1] == "auto":
        return _Fault("SB123", "the only valid value is true; remove `auto` to use another form of origin")
    words = [word.strip("'") for word in _words(error).split(", ")]
    also = ALSO_CALLED.get(value.text.lower())
    near = (f"did you mean '{also}'?",) if also in words else did_you_mean(value.text, words)
    return _Fault("SB123", f"invalid choice '{value.text}'", (*near, f"choices: {', '.join(words)}"))


def _words(error: ErrorDetails) -> str:
    return str(error.get("ctx", {}).get("expected", "")).replace(" or ", ", ")


def _shape_without_type(value: Tree) -> _Fault:
    shapes = "box, cylinder, sphere, capsule"
    if not isinstance(value, Mapping):
        message = f"expected a mapping with `type`, not {_shown(value)}"
        return _Fault("SB122", message, (f"choices for `type`: {shapes}",))
    if "type" not in value.entries:
        return _Fault("SB121", "key 'type' is missing", (f"type: one of {shapes}",), of_key=True)
    kind = value.entries["type"].value
    near = did_you_mean(kind.text, shapes.split(", ")) if isinstance(kind, Scalar) else ()
    return _Fault("SB123", f"invalid shape type: {_shown(kind)}", (*near, f"choices: {shapes}"))


def _wrong_count(keys: Keys, value: Tree) -> _Fault | None:
    if keys == ("links",):
        return _Fault("SB121", "no links are defined", ("add at least one link: `base: {rest: true}`",))
    if isinstance(value, Listing) and len(value.values) == 2:
        return None  # one of the two is of a wrong type, which is reported
    count = f", not {len(value.values)}" if isinstance(value, Listing) else ""
    return _Fault("SB122", f"expected two component paths{count}", ('mate: ["first", "second"]',))


_KINDS_OF_PAIRS = (
    "write `exclude: [always]`, `[always, never]` or `[]`; `excluded_contacts: [[link_a, link_b]]` excludes one pair"
)
_TYPES = {
    "string_type": "a string",
    "bool_type": "true or false",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "tuple_type": "a list",
}


def _type_hint(kind: str, loc: tuple[str | int, ...], keys: Keys, value: Tree) -> str:
    """Remedy for a value of another type; empty without any."""
    if keys == ("self_collision", "exclude"):
        return _KINDS_OF_PAIRS
    if snippet := remedy(keys, value) or (_one_of_list(keys, value) if kind == "string_type" else ""):
        return snippet
    if isinstance(value, Scalar):
        if kind == "string_type":
            return f'quote the value: "{value.text}"'
        if kind == "bool_type" and value.text.lower() in ("yes", "no", "on", "off", "y", "n"):
            return "YAML 1.2 booleans are true and false"
        if kind == "tuple_type":
            return f'write a list: ["{value.text}"]'
        if kind != "bool_type" and value.plain and ":" in value.text:
            return "add a space after the colon: `key: value`"
    if "dict" in kind or "model" in kind:
        if len(keys) < 2 or kind == "dict_type":
            return "write `name: {key: value}` for each"
        return f"write `key: value` lines, or {{key: value}}; keys here: {', '.join(keys_of(sections_at(loc)))}"
    return ""


def _one_of_list(keys: Keys, value: Tree) -> str:
    """Remedy for a list in place of a single value: the first of its values; empty for anything else."""
    if not isinstance(value, Listing) or not value.values or not isinstance(value.values[0], Scalar):
        return ""
    first = written(value.values[0])
    single = f"`{first}`" if isinstance(keys[-1], int) else f"`{keys[-1]}: {first}`"
    return f"write {single}" if len(value.values) == 1 else f"one value only, such as {single}"


def _fault_of_unit(keys: Keys, value: Tree, root: Tree) -> _Fault | None:
    """A wrong unit of a value whose dimension depends on the type of its joint; None where that is unknown."""
    dimension = _dimension(keys, root)
    if dimension is None or not isinstance(value, Scalar):
        return None
    try:
        read_quantity(value.text, dimension)
    except UnitError as failure:
        return _Fault("SB124", str(failure), failure.hints)
    return None


def _dimension(keys: Keys, root: Tree) -> Dimension | None:
    """The dimension of a joint's or an actuator's value, by the type of the joint; None if unknown."""
    name: Tree | None = way(root, (*keys[:2], "joint"))[-1] if keys[0] == "actuators" else None
    joint = name.text if isinstance(name, Scalar) else str(keys[1]) if keys[0] == "joints" else ""
    kind = way(root, ("joints", joint, "type"))[-1]
    if not isinstance(kind, Scalar) or kind.text not in list(JointKind):
        return None
    if keys[-1] in ("zero", "offset"):
        return position_dimension(JointKind(kind.text))
    return settings_of(JointKind(kind.text)).get(_GAINS.get(str(keys[-1]), str(keys[-1])))


def _shown(value: Tree) -> str:
    if isinstance(value, Scalar):
        return described(value.value)
    return "a mapping" if isinstance(value, Mapping) else "a list"
