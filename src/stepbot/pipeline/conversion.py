"""Options and results of a conversion; imports no heavy modules."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.formats import default_formats
from stepbot.robot.joint_table import JointRow
from stepbot.runtime.cache import Cache
from stepbot.runtime.output import discard, failed_output, write_atomically
from stepbot.runtime.worker import DEFAULT_TIMEOUT

if TYPE_CHECKING:
    from stepbot.report.record import Report
    from stepbot.robot.model import Robot

REPORT = "report.json"
"""Name of the proof among the files."""


@dataclass(frozen=True)
class Options:
    """How to convert one sidecar."""

    output: Path
    """Folder that receives the files; made where it is missing."""
    formats: tuple[str, ...] = field(default_factory=default_formats)
    step: Path | None = None
    """STEP file to read in place of the one that the sidecar names."""
    encoding: str = ""
    """Code page of the names in the STEP, in place of the one that the sidecar declares; empty for that one."""
    verify: bool = True
    strict: bool = False
    """Whether warnings, and so every loss, are errors."""
    require: tuple[str, ...] = ()
    """Engines whose absence is an error."""
    timeout: float = DEFAULT_TIMEOUT
    """Seconds that the kernel or an engine may take."""
    ignore: tuple[str, ...] = ()
    """Codes of warnings and notes that are not reported, beside those that the sidecar names."""
    memory_limit: int | None = None
    """Address space [bytes] of the kernel's process; None for no limit."""
    cache: Cache | None = None
    """Where results are kept and found; None for nowhere."""


@dataclass(frozen=True)
class Checked:
    """Result of a check, in addition to its diagnostics."""

    named: str = ""
    """What the sidecar calls its STEP; empty where it has errors."""
    links: int = 0
    joints: int = 0
    """Joints of the tree, and those that close loops."""
    joint_table: tuple[JointRow, ...] = ()
    """Where each joint is; empty where no STEP was read, or errors left no robot."""


@dataclass(frozen=True)
class Conversion:
    """Result of converting one sidecar."""

    diagnostics: Diagnostics
    robot: "Robot | None" = None
    """None where errors ended the conversion before there was one, and where it was taken from a cache."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """What there is to write, relative to the output folder."""
    report: "Report | None" = None
    named: str = ""
    """What the sidecar calls its STEP; empty where that could not be read."""
    geometry: str = ""
    """Hash of the STEP that was read; empty where the file changed meanwhile."""


def write(conversion: Conversion, output: Path, sidecar: Path) -> Conversion:
    """Write the files of the conversion of a sidecar, if there are any.

    What failed is kept for whoever wants to know why, but not where a build would pick it up, and until a
    run passes.
    """
    if not conversion.files:
        return conversion
    found, failed = conversion.diagnostics, failed_output(output)
    try:
        write_atomically(conversion.files, failed if found.has_errors else output, sidecar, found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Conversion(found)
    if not found.has_errors:
        discard(failed)
    return conversion
