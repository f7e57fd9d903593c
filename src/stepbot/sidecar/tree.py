"""A YAML file as a tree of values with their positions, and the subjects of messages: ``joint 'elbow': limits``."""

from collections.abc import Iterator, Sequence
from collections.abc import Mapping as MappingType
from typing import Any

from msgspec import Struct

from stepbot.diagnostics import Span

Keys = tuple[str | int, ...]
"""The path from the root to a value: keys of mappings, indices of lists."""


class Scalar(Struct, frozen=True, eq=False):
    """A single value."""

    span: Span
    value: str | int | float | bool | None
    text: str
    """Verbatim, without quotes."""
    plain: bool = True
    """Whether it is written without quotes."""
    faulty: bool = False
    """Whether an error has been reported for it: its consequences are not reported again."""
    size = 1
    depth = 1


class Listing(Struct, frozen=True, eq=False):
    """A list of values."""

    span: Span
    values: Sequence["Tree"]
    size: int
    """Number of values in it, including itself and expanded aliases."""
    depth: int
    """Depth of values in it, including itself."""
    flow: bool = False
    """Whether it is written in brackets."""
    faulty = False


class Entry(Struct, frozen=True, eq=False):
    """A key and its value."""

    key_span: Span
    value: "Tree"


class Mapping(Struct, frozen=True, eq=False):
    """Values by key, in file order."""

    span: Span
    entries: MappingType[str, Entry]
    size: int
    """Number of values in it, including itself and expanded aliases."""
    depth: int
    """Depth of values in it, including itself."""
    faulty = False


Tree = Scalar | Listing | Mapping


def child(tree: Tree, key: str | int) -> Tree | None:
    """The value at a key or index, or None."""
    if isinstance(tree, Listing):
        return tree.values[key] if isinstance(key, int) and 0 <= key < len(tree.values) else None
    entry = entries_of(tree).get(key) if isinstance(key, str) else None
    return entry.value if entry is not None else None


def way(root: Tree, keys: Keys) -> list[Tree]:
    """The values from the root along ``keys``, as far as they exist; the root first."""
    values = [root]
    for key in keys:
        value = child(values[-1], key)
        if value is None:
            break
        values.append(value)
    return values


def entries_of(tree: Tree | None) -> MappingType[str, Entry]:
    """The entries of a mapping; none of anything else."""
    return tree.entries if isinstance(tree, Mapping) else {}


def value_at(root: Tree, keys: Keys) -> Tree | None:
    """The value at ``keys``, or None."""
    values = way(root, keys)
    return values[-1] if len(values) == len(keys) + 1 else None


def key_span(root: Tree, keys: Keys) -> Span:
    """The span of the last key of ``keys``, or of the nearest existing one above it."""
    values = way(root, keys)
    for depth in range(len(values) - 1, 0, -1):
        above, key = values[depth - 1], keys[depth - 1]
        if isinstance(above, Mapping) and isinstance(key, str):
            return above.entries[key].key_span
    return root.span


def span(root: Tree, keys: Keys) -> Span:
    """The span of the value at ``keys``, or of the nearest existing key above it."""
    value = value_at(root, keys)
    return value.span if value is not None else key_span(root, keys)


def scalars(tree: Tree, keys: Keys = ()) -> Iterator[tuple[Keys, Scalar]]:
    """Every single value at and below ``keys``, where ``tree`` is, with its place."""
    if isinstance(tree, Scalar):
        yield keys, tree
    elif isinstance(tree, Listing):
        for index, value in enumerate(tree.values):
            yield from scalars(value, (*keys, index))
    else:
        for key, entry in tree.entries.items():
            yield from scalars(entry.value, (*keys, key))


def last_line(tree: Tree) -> int:
    """The last line on which a value of the tree begins."""
    if isinstance(tree, Mapping):
        return max([tree.span.line, *(last_line(entry.value) for entry in tree.entries.values())])
    if isinstance(tree, Listing):
        return max([tree.span.line, *map(last_line, tree.values)])
    return tree.span.line


def plain_data(tree: Tree, *, shared: bool = True) -> Any:
    """The tree as dictionaries, lists and scalars.

    Args:
        shared: Whether aliases become the same object; otherwise a change at one place does not appear at another.
    """
    return _plain_data(tree, {} if shared else None)


def _plain_data(tree: Tree, done: dict[int, Any] | None) -> Any:
    if isinstance(tree, Scalar):
        return tree.value
    if done is not None and id(tree) in done:
        return done[id(tree)]
    data: Any
    if isinstance(tree, Listing):
        data = [_plain_data(value, done) for value in tree.values]
    else:
        data = {key: _plain_data(entry.value, done) for key, entry in tree.entries.items()}
    if done is not None:
        done[id(tree)] = data
    return data


_SUBJECTS = {
    "materials": "material",
    "parts": "parts rule",
    "links": "link",
    "joint_defaults": "joint default",
    "joints": "joint",
    "closures": "closure",
    "frames": "frame",
    "actuators": "actuator",
    "motors": "motor",
    "sensors": "sensor",
}

SECTIONS = tuple(_SUBJECTS)
"""Sections of members by name."""

ELEMENTS = ("links", "joints", "closures", "frames", "actuators", "sensors")
"""Sections whose members are elements of the robot."""


def subject(keys: Keys) -> str:
    """The subject of the value at ``keys``, with the path to the value: ``link 'jaw': inertial.com[1]``."""
    if not keys:
        return "sidecar"
    if len(keys) > 1 and keys[0] in _SUBJECTS and isinstance(keys[1], str):
        name, rest = f"{_SUBJECTS[str(keys[0])]} '{keys[1]}'", keys[2:]
        return f"{name}: {_joined(rest)}" if rest else name
    return _joined(keys)


def _joined(keys: Keys) -> str:
    text = ""
    for key in keys:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text
