"""stepbot: one STEP assembly and one small sidecar become URDF, SDFormat and MJCF, proven equal.

The functions of :mod:`stepbot.api` are names of this package; they are imported when they are first used.
"""

TYPE_CHECKING = False
"""As in ``typing``, which could be a file of the current folder: that is taken off the import path later."""

if TYPE_CHECKING:
    from stepbot.api import (
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


def __getattr__(name: str) -> object:
    from importlib import import_module

    if name not in __all__:
        raise AttributeError(f"module 'stepbot' has no attribute '{name}'")
    value: object = getattr(import_module(f"{__name__}.api"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
