"""YAML of mappings, lists and scalars: keys and strings quoted as in JSON, which every YAML reader reads alike."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any


def yaml_text(value: Mapping[str, Any]) -> str:
    """Block style for mappings and lists of mappings; other lists in one line."""
    return "\n".join(_lines(value, "")) + "\n"


def _lines(value: Mapping[str, Any], indent: str) -> Iterator[str]:
    for key, item in value.items():
        name = f"{indent}{_scalar(key)}:"
        if isinstance(item, Mapping) and item:
            yield name
            yield from _lines(item, f"{indent}  ")
        elif isinstance(item, Sequence) and item and isinstance(item[0], Mapping):
            yield name
            for one in item:
                first, *others = _lines(one, f"{indent}    ")
                yield f"{indent}  - {first.strip()}"
                yield from others
        else:
            yield f"{name} {_scalar(item)}"


def _scalar(value: Any) -> str:
    if isinstance(value, str) and value.isidentifier() and value.lower() not in _WORDS:
        return value
    return json.dumps(value, ensure_ascii=False)


_WORDS = frozenset({"true", "false", "yes", "no", "on", "off", "null", "y", "n", "nan", "inf"})
"""Identifiers that some YAML readers do not take for strings."""
