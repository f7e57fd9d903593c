"""A sidecar as a tree for mutations that a Python mapping could not represent, and its text.

Keys and scalars are pieces of YAML source, written unchanged: a mutation may insert an alias, a tag, a tab, half a
string. Mappings are lists of pairs, so that a key may be duplicated.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from msgspec import Struct, field
from ruamel.yaml import YAML


class Scalar(Struct):
    """A piece of YAML source."""

    source: str


class Listing(Struct):
    """A list."""

    values: list["Node"] = field(default_factory=list)
    prefix: str = ""
    """An anchor or a tag before it."""


class Table(Struct):
    """A mapping."""

    pairs: list[tuple[str, "Node"]] = field(default_factory=list)
    """Source of each key, and its value."""
    prefix: str = ""


Node = Scalar | Listing | Table


def read_tree(path: Path) -> Table:
    """The tree of a valid sidecar."""
    root = _node(YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8")))
    assert isinstance(root, Table)
    return root


def written(root: Node) -> str:
    """The text of a tree, in block style."""
    return "\n".join(_lines(root)) + "\n"


def places(node: Node) -> Iterator[tuple[Table | Listing, int]]:
    """Every value below a node, as its container and its index there, from the top down."""
    for index, value in enumerate(values_of(node)):
        assert not isinstance(node, Scalar)
        yield node, index
        yield from places(value)


def values_of(node: Node) -> list[Node]:
    """The values that a node contains."""
    if isinstance(node, Table):
        return [value for _, value in node.pairs]
    return node.values if isinstance(node, Listing) else []


def replace_value(container: Table | Listing, index: int, value: Node) -> None:
    """Put another value in a place."""
    if isinstance(container, Table):
        container.pairs[index] = (container.pairs[index][0], value)
    else:
        container.values[index] = value


def _node(value: Any) -> Node:
    if isinstance(value, dict):
        return Table([(_source(key), _node(one)) for key, one in value.items()])
    if isinstance(value, list):
        return Listing([_node(one) for one in value])
    return Scalar(_source(value))


def _source(value: Any) -> str:
    if isinstance(value, str) and value and all(c.isalnum() or c in "_./-^ " for c in value):
        return value
    return json.dumps(value, ensure_ascii=False)


def _lines(node: Node) -> list[str]:
    if isinstance(node, Scalar):
        return [node.source]
    if not values_of(node):
        return [(node.prefix + " " if node.prefix else "") + ("{}" if isinstance(node, Table) else "[]")]
    heads = [f"{key}:" for key, _ in node.pairs] if isinstance(node, Table) else ["-"] * len(node.values)
    lines: list[str] = []
    for head, value in zip(heads, values_of(node), strict=True):
        below = _lines(value)
        prefix = "" if isinstance(value, Scalar) or not values_of(value) else value.prefix
        if len(below) == 1 and (isinstance(value, Scalar) or not values_of(value)):
            lines.append(f"{head} {below[0]}")
        else:
            lines += [f"{head} {prefix}".rstrip(), *(f"  {line}" for line in below)]
    return lines
