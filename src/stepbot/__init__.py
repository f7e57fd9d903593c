"""stepbot: convert a STEP assembly and a small sidecar to URDF, SDFormat and MJCF, verified in simulation engines.

The functions of :mod:`stepbot.api` are names of this package; they are imported on first use.
"""

from .version import __version__ as __version__

TYPE_CHECKING = False
"""Replaces the one of ``typing``, which a file of the current folder could shadow at this point."""

if TYPE_CHECKING:
    from stepbot.api import (
        CheckResult,
        Conversion,
        Diagnostic,
        Diagnostics,
        Drafted,
        DriveResult,
        Rendered,
        StepbotError,
        Verification,
        check,
        close_loops,
        convert,
        draft,
        drive,
        inspect,
        render,
        verify,
    )

__all__ = [
    "CheckResult",
    "Conversion",
    "Diagnostic",
    "Diagnostics",
    "Drafted",
    "DriveResult",
    "Rendered",
    "StepbotError",
    "Verification",
    "check",
    "close_loops",
    "convert",
    "draft",
    "drive",
    "inspect",
    "render",
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
