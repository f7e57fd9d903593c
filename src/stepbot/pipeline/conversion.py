"""Options and results of a conversion; imports no heavy modules."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.formats import default_formats
from stepbot.report import Summary
from stepbot.runtime.cache import Cache
from stepbot.runtime.file import exists
from stepbot.runtime.memory import DEFAULT_TIMEOUT

if TYPE_CHECKING:
    from stepbot.report.results import Results
    from stepbot.robot.joint_table import JointRow
    from stepbot.robot.model import Robot
    from stepbot.runtime.worker import Workers


_SUFFIXES = (".urdf", ".xacro", ".sdf", ".xml", ".mjcf", ".world", ".usd", ".usda", ".usdc", ".proto")
"""The content decides between the formats; OpenUSD, PROTOs and macros are not converted, which readers report."""


def is_description(path: Path) -> bool:
    """Whether a file is taken as a robot description, not as a sidecar."""
    return path.suffix.lower() in _SUFFIXES


REPORT = "report.json"
"""Name of the report among the files."""
REPORT_PAGE = "report.html"
"""Name of the report for people among the files."""


class Options(NamedTuple):
    """How to convert one sidecar."""

    output: Path
    """Output folder; created if missing."""
    formats: tuple[str, ...] = default_formats()
    step: Path | None = None
    """STEP file to read instead of the one named in the sidecar."""
    variant: str = ""
    """Variant of the sidecar; empty for the sidecar as it is."""
    encoding: str = ""
    """Code page of the names in the STEP, overriding the sidecar's; empty to use the sidecar's."""
    verify: bool = True
    strict: bool = False
    """Whether warnings, which include every loss, are errors."""
    require: tuple[str, ...] = ()
    """Engines whose absence is an error."""
    timeout: float = DEFAULT_TIMEOUT
    """Time limit [s] of the kernel and of each engine."""
    ignore: tuple[str, ...] = ()
    """Codes of warnings and notes to suppress, in addition to the sidecar's."""
    memory_limit: int | None = None
    """Address space [bytes] of the kernel's process; None for no limit."""
    cache: Cache | None = None
    """Cache of results; None to disable it."""
    html: bool = False
    """Whether to write the report as a page, too."""
    package: str = ""
    """ROS package that the URDF names in the paths of its meshes; empty for paths relative to the file."""
    package_path: tuple[Path, ...] = ()
    """Folders of the packages that a source names in ``package://`` and ``model://``."""
    base: str = ""
    """``fixed`` or ``floating``, for a source that does not say which: a URDF; empty for fixed."""
    xacro: tuple[tuple[str, str], ...] = ()
    """Names and values of the arguments of a source with macros."""
    assume_inertia: float = 0.0
    """Density [kg/m^3] from which links of a description without possible mass properties get some; 0 for none."""
    ros2: bool = False
    """Whether to add the files that make the output folder this package, and to search for links that can overlap."""
    maintainer: str = ""
    """Name and address of the maintainer of packages, overriding the sidecar's; empty for the sidecar's."""
    license: str = ""
    """Licence of packages, as ``maintainer``."""
    programs: tuple[str, ...] = ()
    """Programs for learning that get a Python file which loads the robot."""
    gazebo: str = ""
    """Name of the Gazebo model that the SDFormat names in the paths of its meshes; empty for relative paths."""

    @property
    def workers(self) -> "Workers":
        """How functions on foreign data run."""
        from stepbot.runtime.worker import Workers

        return Workers(self.timeout, self.memory_limit)


class Checked(NamedTuple):
    """Result of a check, in addition to its diagnostics."""

    named: str = ""
    """Path of the STEP as written in the sidecar; empty if the sidecar has errors."""
    links: int = 0
    joints: int = 0
    """Number of tree joints, and of joints that close loops."""
    joint_table: "tuple[JointRow, ...]" = ()
    """Position of each joint; empty if no STEP was read or there is no robot because of errors."""
    robot: str = ""
    """Name, size and mass of the robot in words; empty as ``joint_table``."""
    is_loaded: bool = True
    """Whether the sidecar has no errors of its own, so that the STEP or the modules were read if they were to be."""


class Kept(NamedTuple):
    """The results of an earlier conversion of the same input."""

    report: bytes
    """A :class:`stepbot.report.results.Results`, encoded."""
    summary: Summary
    """The same in texts, all that most commands need."""


class Conversion(NamedTuple):
    """Result of converting one sidecar."""

    diagnostics: Diagnostics
    robot: "Robot | None" = None
    """None after errors, or if the result came from a cache."""
    files: Mapping[str, bytes] = {}  # read-only by its type: a proxy cannot be pickled
    """Content of the files to write, by path relative to the output folder."""
    results: "Results | Kept | None" = None
    """See :attr:`report` and :attr:`summary`."""
    named: str = ""
    """Path of the STEP as written in the sidecar; empty if it could not be read."""
    geometry: str = ""
    """Hash of the STEP that was read; empty if the file changed meanwhile."""
    read: tuple[Path, ...] = ()
    """The files that a composed robot depends on, its sidecar first; empty for others."""
    hashes: Mapping[str, str] | None = None
    """SHA-256 of each of the files, if it is known."""

    @property
    def report(self) -> "Results | None":
        """The verification results, and what else is known about the files; None without files."""
        if not isinstance(self.results, Kept):
            return self.results
        from stepbot.report.results import Results
        from stepbot.runtime.cache import codec_of

        return codec_of(Results).decode(self.results.report)

    @property
    def summary(self) -> Summary | None:
        """What commands print about the results; None without files."""
        if isinstance(self.results, Kept):
            return self.results.summary
        if self.results is None or self.robot is None:
            return None
        from .verdict import summary_of

        source = "its modules" if self.robot.modules else "its source"
        return summary_of(self.robot, self.results, "the CAD" if self.named else source)


def write(conversion: Conversion, output: Path, sidecar: Path) -> Conversion:
    """Write the files of a sidecar's conversion, if there are any.

    Files that failed verification are kept for inspection, in a folder where no build finds them, until a run passes.
    """
    if not conversion.files:
        return conversion
    from stepbot.runtime.output import discard, failed_output, write_atomically

    diagnostics, failed = conversion.diagnostics, failed_output(output)
    if not diagnostics.has_errors:
        _report_others(conversion.files, output, diagnostics)
    try:
        write_atomically(
            conversion.files, failed if diagnostics.has_errors else output, sidecar, diagnostics, conversion.hashes
        )
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return Conversion(diagnostics)
    if not diagnostics.has_errors:
        discard(failed)
    return conversion


def _report_others(files: Mapping[str, bytes], output: Path, diagnostics: Diagnostics) -> None:
    """Report what earlier runs left in the folder.

    Warn where robots share it, since it has one report (SB022); note files of the robot in formats that this run does
    not write (SB023).
    """
    from stepbot.runtime.output import beside

    robots, earlier = beside(files, output)
    if robots and REPORT in files and exists(output / REPORT):
        names = ", ".join(f"'{name}'" for name in robots)
        message = f"the folder also has files of {names}, and {REPORT} describes one robot"
        help = "convert each robot into a folder of its own: `-o FOLDER`"
        diagnostics.add("SB022", message, Span((output / REPORT).as_posix()), help=(help,))
    if earlier:
        names = ", ".join(f"'{name}'" for name in earlier)
        help = "convert without `-f`, remove the files, or choose another folder: `-o FOLDER`"
        message = f"{names}: from an earlier conversion, not written again"
        diagnostics.add("SB023", message, Span(output.as_posix()), help=(help,))
