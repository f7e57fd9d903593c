"""Changes single values in the text of a sidecar; every other byte is unchanged.

The text is spliced at the positions of YAML nodes, because a YAML writer would lay the file out anew. The result is
read again and must hold the former values with exactly these changes.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from msgspec import Struct
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from stepbot.diagnostics import Diagnostics

from .compose import TooMuchError, compose
from .document import Document
from .draft_comments import Rewrite, above, below
from .load import parse_sidecar
from .starter import scalar
from .text import is_number
from .tree import SECTIONS, Keys, Mapping, plain_data


class Put(Struct, frozen=True):
    """Set the value at keys; what does not exist on the way is created."""

    keys: Keys
    value: Any
    """A string, number, bool, list or dictionary."""


class Append(Struct, frozen=True):
    """Add an item to the list at keys; a missing list is created."""

    keys: Keys
    value: Any


class Remove(Struct, frozen=True):
    """Remove the entry or item at keys, which must exist; of a list or mapping that would be empty, all of it."""

    keys: Keys
    with_draft: bool = False
    """Whether the comments go with it that `stepbot init` wrote about it; other comments above it stay."""


class Rename(Struct, frozen=True):
    """Give the entry at keys, which must exist, another name; it keeps its place."""

    keys: Keys
    name: str


class Annotate(Struct, frozen=True):
    """Rewrite the comments that `stepbot init` wrote about the entry at keys, which must exist; no value changes.

    Without keys the comments are those of the whole file.
    """

    keys: Keys
    rewrite: Rewrite


Change = Put | Append | Remove | Rename | Annotate


class CannotEdit(Exception):
    """The text is written in a way that allows no such change; the message states why."""


_ANY = Path("sidecar")


def edited(text: str, changes: Sequence[Change], path: Path = _ANY) -> str:
    """The text of a sidecar with changes, one after the other.

    Args:
        text: With line feeds at line ends; without syntax errors.
        path: Of the sidecar; a text that was just read under it is not read again.

    Raises:
        CannotEdit: The result would be no sidecar, or not have exactly these changes.
    """
    expected = _values(text, path)
    for change in changes:
        text = _spliced(text, change)
        expected = expected if isinstance(change, Annotate) else _applied(expected, change)
    if _values(text, path) != expected:
        raise CannotEdit("the sidecar is written in a way that this change does not fit; edit it in an editor")
    return text


def value_of(text: str) -> Any:
    """The value that a text on one line is in a sidecar.

    Raises:
        CannotEdit: It is not YAML, or YAML that a sidecar may not have.
    """
    diagnostics = Diagnostics()
    try:
        tree = compose(f"value: {text}", "value", diagnostics)
    except (YAMLError, TooMuchError) as error:
        raise CannotEdit(f"'{text}' is not a value of YAML; put a text in double quotes") from error
    if diagnostics.has_errors or not isinstance(tree, Mapping) or list(tree.entries) != ["value"]:
        raise CannotEdit(next((diagnostic.message for diagnostic in diagnostics), f"'{text}' is not a value"))
    return plain_data(tree, shared=False)["value"]


def _values(text: str, path: Path) -> Any:
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, path, diagnostics)
    if sidecar is None:
        errors = (
            "; ".join((diagnostic.message, *diagnostic.help[:1]))
            for diagnostic in diagnostics
            if diagnostic.severity == "error"
        )
        first = next(errors, "it cannot be read")
        raise CannotEdit(f"the result would not be a sidecar: {first}")
    return plain_data(sidecar.root, shared=False)


def _applied(data: Any, change: Put | Append | Remove | Rename) -> Any:
    """The values after a change, computed on plain data."""
    *above, last = change.keys
    at = data
    for key in above:
        at = at.setdefault(key, {}) if isinstance(at, dict) else at[key]
    if isinstance(change, Put):
        at[last] = change.value
    elif isinstance(change, Append):
        at.setdefault(last, []).append(change.value)
    elif isinstance(change, Rename):
        entries = [(change.name if key == last else key, value) for key, value in at.items()]
        at.clear()
        at.update(entries)
    else:
        del at[last]
        if not at and above:
            return _applied(data, Remove(tuple(above)))
    return data


def _spliced(text: str, change: Change) -> str:
    try:
        root = YAML(typ="safe", pure=True).compose(text)
    except YAMLError as error:
        raise CannotEdit(f"the sidecar has a syntax error: {error}") from error
    if not isinstance(root, MappingNode):
        raise CannotEdit("the sidecar is not a mapping")
    nodes = _way(root, change.keys)
    missing = change.keys[len(nodes) - 1 :]
    if isinstance(change, Remove | Rename | Annotate) and missing:
        raise CannotEdit(f"there is no {'.'.join(map(str, change.keys))}")
    if isinstance(change, Rename):
        return _renamed(text, nodes, change.name)
    if isinstance(change, Annotate):
        return _annotated(text, nodes, change.keys, change.rewrite)
    if isinstance(change, Remove):
        return _without(text, nodes, change.keys, str(change.keys[-1]) if change.with_draft else None)
    if isinstance(change, Append) and not missing:
        return _with_item(text, nodes[-1], change.value)
    value = [change.value] if isinstance(change, Append) else change.value
    if not missing:
        return text[: nodes[-1].start_mark.index] + _flow(value) + text[_end(nodes[-1]) :]
    return _with_entry(text, nodes[-1], missing, value)


def _way(root: Node, keys: Keys) -> list[Node]:
    """The nodes from the root along keys, as far as they exist."""
    nodes = [root]
    for key in keys:
        node = _child(nodes[-1], key)
        if node is None:
            break
        nodes.append(node)
    return nodes


def _child(node: Node, key: str | int) -> Node | None:
    if isinstance(node, MappingNode):
        return next((value for name, value in node.value if name.value == key), None)
    is_item = isinstance(node, SequenceNode) and isinstance(key, int) and 0 <= key < len(node.value)
    return node.value[key] if is_item else None


def _end(node: Node) -> int:
    """Where the text of a node ends; a block collection ends with its last value."""
    if isinstance(node, MappingNode | SequenceNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _end(last[1] if isinstance(node, MappingNode) else last)
    return int(node.end_mark.index)


def _with_entry(text: str, node: Node, keys: Keys, value: Any) -> str:
    if not isinstance(node, MappingNode):
        raise CannotEdit(f"'{keys[0]}' cannot be added to a single value or a list")
    for key in reversed(keys[1:]):
        value = {str(key): value}
    if node.flow_style:
        return _into_flow(text, node, f"{scalar(str(keys[0]))}: {_flow(value)}")
    indent = node.value[0][0].start_mark.column if node.value else 0
    lines = _block(str(keys[0]), value, indent)
    if indent > 0:
        return _as_lines(text, _end(node), lines, indent)
    key, former = max(node.value, key=lambda entry: _rank(str(keys[0]), entry[0].value))
    is_section = len(lines) > 1 or former.start_mark.line != key.start_mark.line
    if is_section and _SPACE.search(text, node.value[0][0].start_mark.index):
        lines = ["", *lines, ""]
    return _as_lines(text, _end(former), lines, 1)


_ORDER = {name: place for place, name in enumerate(Document.model_fields)}


def _rank(new: str, key: str) -> int:
    """How good it is to have a new key at the top below another one: the sidecar's keys have an order."""
    place = _ORDER.get(key, 0)
    return place if place < _ORDER.get(new, len(_ORDER)) else -1


def _with_item(text: str, node: Node, value: Any) -> str:
    if not isinstance(node, SequenceNode):
        raise CannotEdit("a single value is not a list")
    if node.flow_style:
        return _into_flow(text, node, _flow(value))
    dash = node.start_mark.column
    return _as_lines(text, _end(node), [f"{' ' * dash}- {_flow(value)}"], dash + 1)


def _into_flow(text: str, node: Node, entry: str) -> str:
    if not node.value:
        at = node.start_mark.index + 1
        return text[:at] + entry + text[at:]
    last = node.value[-1]
    at = _end(last[1] if isinstance(last, tuple) else last)
    return f"{text[:at]}, {entry}{text[at:]}"


def _as_lines(text: str, after: int, lines: Sequence[str], indent: int) -> str:
    """Lines inserted below the line that holds a position and its comments: those that are indented so far.

    An empty line at an end of ``lines`` is there once.
    """
    all_lines = text.split("\n")
    at = text.count("\n", 0, after) + 1
    while at < len(all_lines) and all_lines[at].lstrip(" ").startswith("#") and all_lines[at].find("#") >= indent:
        at += 1
    head, tail = all_lines[:at], all_lines[at:] or [""]
    if not lines[-1] and not tail[0]:
        lines = lines[:-1]
    return "\n".join([*head, *lines, *tail])


def _annotated(text: str, nodes: Sequence[Node], keys: Keys, rewrite: Rewrite) -> str:
    lines: list[str | None] = list(text.split("\n"))
    if len(nodes) == 1:
        return "\n".join(line for line in rewrite(text.split("\n")) if line is not None)
    parent, node = nodes[-2], nodes[-1]
    if not isinstance(parent, MappingNode):
        raise CannotEdit("an item of a list has no comments of the draft")
    start = next(key for key, value in parent.value if value is node).start_mark.line
    places = [*above([str(line) for line in lines], start), start]
    if len(keys) > 1 or keys[0] not in SECTIONS:  # the entries of a section have comments of their own
        places += range(start + 1, text.count("\n", 0, _end(node)) + 1)
    for at, line in zip(places, rewrite([str(lines[at]) for at in places]), strict=True):
        lines[at] = line
    return "\n".join(line for line in lines if line is not None)


def _renamed(text: str, nodes: Sequence[Node], name: str) -> str:
    parent, node = nodes[-2], nodes[-1]
    if not isinstance(parent, MappingNode):
        raise CannotEdit("an item of a list has no name")
    key = next(key for key, value in parent.value if value is node)
    return text[: key.start_mark.index] + scalar(name) + text[key.end_mark.index :]


def _without(text: str, nodes: Sequence[Node], keys: Keys, drafted: str | None) -> str:
    """The text without the last node; ``drafted`` is the name of a joint or link whose drafted comments go, too."""
    parent, node = nodes[-2], nodes[-1]
    if len(parent.value) == 1 and len(nodes) > 2:
        return _without(text, nodes[:-1], keys[:-1], drafted)
    is_mapping = isinstance(parent, MappingNode)
    start = next(name for name, value in parent.value if value is node).start_mark.index if is_mapping else None
    first = node.start_mark.index if start is None else start
    stop = _end(node)
    if isinstance(parent, MappingNode | SequenceNode) and parent.flow_style:
        members = [value for _, value in parent.value] if is_mapping else list(parent.value)
        index = next(i for i, member in enumerate(members) if member is node)
        if index + 1 < len(members):
            following = parent.value[index + 1]
            return text[:first] + text[(following[0] if is_mapping else following).start_mark.index :]
        return text[: _end(members[index - 1])] + text[stop:]
    lines = text.split("\n")
    start_line, after = text.count("\n", 0, first), text.count("\n", 0, stop) + 1
    gone = set(range(start_line, after))
    if drafted is not None:
        gone.update(above(lines, start_line), range(after, below(lines, after, scalar(drafted))))
    kept = [one for index, one in enumerate(lines) if index not in gone]
    return "\n".join(kept if after < len(lines) else [*kept, ""])


def _block(key: str, value: Any, indent: int) -> list[str]:
    """An entry of a block mapping: its values in one line each, unless they fit into one line as a whole."""
    head = f"{' ' * indent}{scalar(key)}:"
    line = f"{head} {_flow(value)}"
    if not isinstance(value, dict) or (len(line) <= _LONGEST_LINE and not (indent == 0 and key in SECTIONS)):
        return [line]
    return [head, *(part for name, one in value.items() for part in _block(name, one, indent + 2))]


_LONGEST_LINE = 120
_SPACE = re.compile(r"\n\n(?:#.*\n)*\S")


def _flow(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{scalar(key)}: {_flow(one)}' for key, one in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_flow, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return value if _is_quantity(value) else scalar(value)
    return repr(value)


def _is_quantity(text: str) -> bool:
    """Whether a text is a number with a unit, or an axis, which need no quotes: ``-90 deg``, ``-z``."""
    number, _, unit = text.partition(" ")
    return text in _AXES or (is_number(number) and _UNIT.fullmatch(unit) is not None)


_AXES = frozenset(("x", "y", "z", "-x", "-y", "-z"))
_UNIT = re.compile(r"[A-Za-z%°][\w^*/.%°-]*")
"""Of these characters a plain scalar of YAML may be."""
