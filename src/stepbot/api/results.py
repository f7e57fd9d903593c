"""What the functions return, beside :class:`stepbot.pipeline.conversion.Conversion`."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Checked

if TYPE_CHECKING:
    from stepbot.draft.draft import Draft
    from stepbot.driving.driving import Driven
    from stepbot.report.robot import Report


@dataclass(frozen=True)
class CheckResult:
    """The result of :func:`check`."""

    diagnostics: Diagnostics
    checked: Checked
    """Number of links and joints; the joint table if the STEP was read."""


@dataclass(frozen=True)
class Verification:
    """The result of :func:`verify`."""

    diagnostics: Diagnostics
    report: "Report"


@dataclass(frozen=True)
class Drafted:
    """The result of :func:`draft`."""

    diagnostics: Diagnostics
    draft: "Draft | None" = None
    """Links and joints with their evidence; None after errors."""
    text: str = ""
    """The sidecar."""


@dataclass(frozen=True)
class DriveResult:
    """The result of :func:`drive`."""

    diagnostics: Diagnostics
    driven: "Driven | None" = None
    """The verdict of each test in each engine; None if nothing could be driven."""


@dataclass(frozen=True)
class Rendered:
    """The result of :func:`render`."""

    diagnostics: Diagnostics
    png: bytes = b""
    """The picture as a PNG file; empty after errors."""
