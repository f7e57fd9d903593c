"""Comparison of converted files with the file that they came from, as engines read both.

The written files are compared with the model elsewhere; this finds what was misread on the way into the model.
"""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from stepbot.described.finding import LOST
from stepbot.described.robot import Described
from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.description import Description
from stepbot.engines.observation import Quantity
from stepbot.engines.openable import openable
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.mjcf import FORMAT as MJCF
from stepbot.formats.rendering import joined
from stepbot.report.record import Report
from stepbot.robot.model import Robot
from stepbot.runtime.output import write_atomically
from stepbot.runtime.temporary import run_folder
from stepbot.runtime.worker import Worker
from stepbot.verification.renamed import Renaming
from stepbot.verification.source import Converted, verify_against_source

from .conversion import Options
from .writing import Rendered

_CHANGED = {
    "SB729": (Quantity.ACTUATORS,),
    "SB745": (Quantity.ACTUATORS,),
    "SB750": (Quantity.JOINTS, Quantity.LIMITS),
}
"""Quantities in which files differ from the source by what their format lacks: bounds of actuators, far stops."""
_LOCATED = "stepbot.engines.located_copy:located_copy"


def compared_with_source(
    path: Path,
    description: Description,
    described: Described,
    written: Rendered,
    report: Report,
    options: Options,
    found: Diagnostics,
) -> Report:
    """The report with the comparison of each written file with the description that it came from.

    Args:
        path: The file.
        description: Its content.
        described: Its robot.
        written: The converted robot.
        report: The report on the written files.
        options: Limits.
        found: Receives SB8xx and SB9xx.
    """
    with TemporaryDirectory(dir=run_folder()) as folder:
        place = Path(folder) / (options.package or options.gazebo)  # where meshes are found by the name of the folder
        write_atomically(joined(written.by_format), place)
        files = {
            place / (file := next(iter(written.by_format[name]))): Converted(
                file, _given_names(written.robot, one), _lost_by(name, written.robot)
            )
            for name, one in written.lowered.items()
        }
        source = path
        if options.package_path and description.observation.format != MJCF.name:  # whose meshes are in no package
            source = Path(folder) / f"source{path.suffix}"
            with Worker(_LOCATED, memory_limit=options.memory_limit) as worker:
                worker.submit(str(openable(path)), str(source), options.package_path).result(options.timeout)
        checks = verify_against_source(
            source,
            Span(path.as_posix()),
            files,
            _lost(described, description),
            Renaming(described.names.links, described.names.joints, described.names.frames),
            found,
            timeout=options.timeout,
            memory_limit=options.memory_limit,
        )
    return replace(report, checks=(*report.checks, *checks))


def _given_names(robot: Robot, lowered: Robot) -> Renaming:
    """The model's names of the joints that a format needs other names for."""
    names = {joint.child: joint.name for joint in robot.joints}
    changed = {joint.name: names[joint.child] for joint in lowered.joints if joint.child in names}
    return Renaming(joints={new: old for new, old in changed.items() if new != old})


def _lost_by(written_in: str, robot: Robot) -> dict[Quantity, str]:
    """Quantities that a format declares to change."""
    found = Diagnostics()
    lower(robot, format_named(written_in), found)
    codes = sorted({one.code for one in found} & set(_CHANGED))
    return {quantity: f"a loss is declared ({code})" for code in codes for quantity in _CHANGED[code]}


def _lost(described: Described, description: Description) -> dict[Quantity, str]:
    """Quantities that a declared loss changes."""
    seen = description.observation
    lost = {quantity: f"a loss is declared ({one.code})" for one in described.findings for quantity in one.differs}
    if seen.gravity or any(link.gravity_compensation for link in seen.links):
        lost[Quantity.GRAVITY_SETTINGS] = f"a loss is declared ({LOST})"
    return lost
