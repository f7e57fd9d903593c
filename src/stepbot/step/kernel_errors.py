"""The errors that the geometry kernel raises on shapes that it cannot handle, as far as it does not crash outright."""

import OCP.Standard as Standard

OUT_OF_MEMORY: tuple[type[Exception], ...] = (MemoryError, Standard.Standard_OutOfMemory)
"""Those that say nothing about the shape."""
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(kind for _, kind in sorted(vars(Standard).items()) if isinstance(kind, type) and issubclass(kind, Exception)),
    RuntimeError,  # what the binding makes of a C++ exception that it does not know
    MemoryError,
)
