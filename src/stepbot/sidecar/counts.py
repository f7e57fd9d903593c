"""Whole numbers of the sidecar."""

from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from .quantities import described, fault, two


def _count(value: Any) -> int:
    """A whole number of at least one."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise fault("SB122", f"expected an integer, not {described(value)}")
    if value < 1:
        raise fault("SB125", f"{value} is out of range: must be at least 1")
    return value


Count = Annotated[int, BeforeValidator(_count), WithJsonSchema({"type": "integer", "minimum": 1})]
Resolution = Annotated[tuple[Count, Count], BeforeValidator(two)]
