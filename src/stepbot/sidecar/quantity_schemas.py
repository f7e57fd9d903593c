"""JSON Schemas of the scalar types of the sidecar."""

from typing import Any

from pydantic import WithJsonSchema

from . import units
from .units import Dimension

NUMBERS3 = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
CHANNELS = {"type": "array", "items": {"type": "number", "minimum": 0, "maximum": 1}, "minItems": 3, "maxItems": 4}
HEX_COLOR = {"type": "string", "pattern": "^#([0-9a-fA-F]{3,4}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})$"}


def quantity_schema(*dimensions: Dimension, word: str = "", **bounds: float) -> WithJsonSchema:
    """A quantity: a number in SI units, or a string with the unit; or one word, if given."""
    examples = [dimension.example for dimension in dimensions]
    quoted = ", ".join(dict.fromkeys(f"`{example}`" for example in examples))
    described = f"{units.described(*dimensions)}: a number without a unit is SI; with a unit: {quoted}."
    forms = _number_or_text(**bounds)
    if word:
        forms["anyOf"].append({"const": word})
    return WithJsonSchema({**forms, "description": described, "examples": examples})


def vector_schema(dimension: Dimension) -> WithJsonSchema:
    """Three quantities of one dimension."""
    of_each = f"each a {dimension.name} [{dimension.unit}] or with a unit: `{dimension.example}`"
    return WithJsonSchema(
        {
            "type": "array",
            "items": _number_or_text(),
            "minItems": 3,
            "maxItems": 3,
            "description": f"`[x, y, z]`, {of_each}.",
            "examples": [[0, 0, dimension.example]],
        }
    )


def _number_or_text(**bounds: float) -> dict[str, Any]:
    return {"anyOf": [{"type": "number", **bounds}, {"type": "string", "pattern": units.QUANTITY_PATTERN}]}
