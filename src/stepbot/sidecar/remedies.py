"""Suggested replacements for values of the wrong form, made from the values in the file."""

import json
import re
from collections.abc import Sequence

from stepbot.robot.model import ActuatorKind

from .text import is_number
from .tree import Keys, Listing, Mapping, Scalar, Tree

_NUMBERS = re.compile(r"[\s,;]+")
_POINT = ("xyz", "rpy", "axis", "axis2", "com", "near", "size", "center")
_MEANT = {
    "actuators": "motor",
    "dynamics": "damping",
    "frames": "link",
    "inertial": "mass",
    "materials": "density",
    "mimic": "joint",
    "modules": "file",
    "sensors": "type",
}
"""The key that a plain value means, by the section of which it is an entry, or by the mapping in whose place it is."""
_SHORTEST_NAMES = 3
"""Maximum number of list items in a snippet."""


def written(value: Tree) -> str:
    """A value in one line of YAML."""
    if isinstance(value, Scalar):
        return value.text if value.plain else quoted(value.text)
    if isinstance(value, Listing):
        return "[" + ", ".join(map(written, value.values)) + "]"
    return "{" + ", ".join(f"{key}: {written(entry.value)}" for key, entry in value.entries.items()) + "}"


def quoted(text: str) -> str:
    """A string in double quotes, or in single quotes if it contains a backslash."""
    return f"'{text}'" if "\\" in text and "'" not in text else json.dumps(text, ensure_ascii=False)


def remedy(keys: Keys, value: Tree) -> str:
    """Replacement for a value of the wrong type; empty if unknown."""
    name = str(keys[-1])
    if triple := _triple(value, name):
        return f"write `{name}: {triple}`"
    if isinstance(value, Listing):
        return _for_list(keys, name, value)
    if isinstance(value, Mapping):
        only = [entry.value for entry in value.entries.values()]
        return f"write `{name}: {written(only[0])}`" if len(only) == 1 and isinstance(only[0], Scalar) else ""
    return _for_text(keys, name, value)


def _triple(value: Tree, name: str) -> str:
    """``[0, 0, 0.1]`` for ``0 0 0.1``, the notation of URDF and SDFormat; empty for other values."""
    only = value.values[0] if isinstance(value, Listing) and len(value.values) == 1 else value
    if not isinstance(only, Scalar) or name not in _POINT:
        return ""
    numbers = _NUMBERS.split(only.text.strip("[]() "))
    return f"[{', '.join(numbers)}]" if len(numbers) == 3 and all(map(is_number, numbers)) else ""


def _for_list(keys: Keys, name: str, value: Listing) -> str:
    if name == "limits" and len(value.values) == 2:
        lower, upper = map(written, value.values)
        return f"write `limits: {{lower: {lower}, upper: {upper}}}`"
    if name in ("origin", "frame") and len(value.values) == 3:
        return f"write `{name}: {{xyz: {written(value)}}}`"
    if len(keys) == 2 and keys[0] == "links":
        return f"write `{name}: {{parts: {written(value)}}}`"
    if len(keys) == 1 and (snippets := _named_items(value.values)):
        return f"replace the list by a mapping from names: {', '.join(snippets)}"
    return ""


def _named_items(values: Sequence[Tree]) -> list[str]:
    """``base: {...}`` for each item with a key ``name``; empty unless all have one."""
    snippets = []
    for value in values:
        entry = value.entries.get("name") if isinstance(value, Mapping) else None
        if entry is None or not isinstance(entry.value, Scalar):
            return []
        snippets.append(f"`{entry.value.text}: {{...}}`")
    return [*snippets[:_SHORTEST_NAMES], *(["..."] if len(snippets) > _SHORTEST_NAMES else [])]


def _for_text(keys: Keys, name: str, value: Scalar) -> str:
    if missing := re.fullmatch(r"([^:\s]+):([\[{].*)", name):  # a colon without a space made it one key
        return f"add a space after the colon: `{missing[1]}: {missing[2]}: {value.text}`"
    if "ignore_findings" in keys and value.text.isdecimal():
        return f"write `SB{value.text}`"
    if len(keys) == 2 and keys[0] == "links":
        return f"write `{name}: {{parts: [{quoted(value.text)}]}}`"
    if len(keys) == 2 and keys[0] == "joints":
        return f"write `{name}: {{type: {value.text}, parent: ..., child: ...}}`"
    meant = _MEANT.get(str(keys[0])) if len(keys) == 2 else _MEANT.get(name)
    if keys[0] == "actuators" and value.text in list(ActuatorKind):
        meant = "kind"
    return f"write `{name}: {{{meant}: {written(value)}}}`" if meant else ""
