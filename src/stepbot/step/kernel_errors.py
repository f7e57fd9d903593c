"""The exceptions that the geometry kernel raises for shapes that it cannot handle, if it does not crash."""

import OCP.Standard as Standard

OUT_OF_MEMORY: tuple[type[Exception], ...] = (MemoryError, Standard.Standard_OutOfMemory)
"""Errors unrelated to the shape."""
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(kind for _, kind in sorted(vars(Standard).items()) if isinstance(kind, type) and issubclass(kind, Exception)),
    RuntimeError,  # the binding's type for unknown C++ exceptions
    MemoryError,
)
