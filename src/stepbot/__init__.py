"""stepbot: one STEP assembly and one small sidecar become URDF, SDFormat and MJCF, proven equal.

The functions of :mod:`stepbot.api` are names of this package; they are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import (
        CheckResult,
        Conversion,
        Diagnostic,
        Diagnostics,
        StepbotError,
        Verification,
        check,
        close_loops,
        convert,
        inspect,
        verify,
    )

__version__ = "0.1.0"

__all__ = [
    "CheckResult",
    "Conversion",
    "Diagnostic",
    "Diagnostics",
    "StepbotError",
    "Verification",
    "check",
    "close_loops",
    "convert",
    "inspect",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'stepbot' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
