"""The exceptions that the geometry kernel raises for shapes that it cannot handle, if it does not crash."""

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import OCP.Standard as Standard

T = TypeVar("T")

OUT_OF_MEMORY: tuple[type[Exception], ...] = (MemoryError, Standard.Standard_OutOfMemory)
"""Errors unrelated to the shape."""
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(kind for _, kind in sorted(vars(Standard).items()) if isinstance(kind, type) and issubclass(kind, Exception)),
    RuntimeError,  # the binding's type for unknown C++ exceptions
    MemoryError,
)


def evaluated(evaluate: Callable[[Any], T], shapes: Iterable[Any], errors: list[str]) -> list[T]:
    """A function's results for the shapes that it does not fail on; ``errors`` receives its errors on the others."""
    found = []
    for shape in shapes:
        try:
            found.append(evaluate(shape))
        except OUT_OF_MEMORY:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it costs this shape's result alone
            errors.append(f"{type(error).__name__} {error}".rstrip())
    return found
