"""The functions that ``import stepbot`` offers; see ``docs/api.md``.

Each function does the same as the command of the same name and returns what that command prints. No function prints, or
raises for invalid input: results carry their diagnostics. To get exceptions instead, call
``result.diagnostics.raise_if_errors()``.
"""

from stepbot.diagnostics import Diagnostic, Diagnostics, StepbotError
from stepbot.pipeline.conversion import Conversion

from .arguments import CheckResult, Drafted, DriveResult, Rendered, Verification
from .converting import check, convert
from .using import close_loops, draft, drive, inspect, render, verify

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
