"""Reads an existing robot description, foreign data, in a worker process."""

from pathlib import Path

from stepbot.described.finding import NOT_SHOWN
from stepbot.described.robot import robot_of_description
from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.description import Description
from stepbot.engines.file_references import openable
from stepbot.robot.model import Robot
from stepbot.runtime.file import exists
from stepbot.runtime.worker import RemoteError, Worker, WorkerDied
from stepbot.verification.admission import admitted
from stepbot.verification.files import format_of
from stepbot.verification.folders import robot_file

from .conversion import Options
from .targets import report_missing

_DESCRIBE = "stepbot.engines.describe:describe"


def read_description(path: Path, options: Options, found: Diagnostics) -> Description | None:
    """The content of a URDF, SDFormat or MJCF; None after a diagnostic.

    Args:
        path: The description.
        options: Time and memory limits.
        found: Takes SB001, SB814, SB820, SB821, SB822, SB823 and SB902.
    """
    if not exists(path):
        report_missing(path, found)
        return None
    written_in = format_of(path, found)
    if written_in is None:
        return None
    if not admitted({path: written_in}, found, timeout=options.timeout, memory_limit=options.memory_limit):
        return None
    span = Span(path.as_posix())
    with Worker(_DESCRIBE, memory_limit=options.memory_limit) as worker:
        try:
            description: Description = worker.submit(str(openable(path)), written_in, options.package_path).result(
                options.timeout
            )
        except RemoteError as error:
            if error.kind not in ("EngineRefused", "EngineCannotRead"):
                raise
            first, *more = error.text.splitlines() or [""]
            found.add("SB823", first, span, notes=more)
            return None
        except WorkerDied as death:
            message = f"the process that reads the description died: {death.reason}"
            found.add("SB902", message, span, notes=death.last_lines)
            return None
    if not description.observation.links:
        found.add("SB823", "the file has no links", span)
        return None
    return description


def described_robot(path: Path, options: Options, found: Diagnostics, *, drawn: bool = True) -> Robot | None:
    """The robot of a URDF, SDFormat or MJCF; None after an error.

    Args:
        path: The description, or a folder with the files of one robot, as `stepbot convert` writes it.
        options: Time and memory limits.
        found: Receives the diagnostics.
        drawn: Whether it is for a picture, where shapes and joints that are not shown are reported as SB825; otherwise
            they are errors.
    """
    path = robot_file(path)
    description = read_description(path, options, found)
    if description is None or found.has_errors:
        return None
    described = robot_of_description(description, path.stem, path.name, drawn=drawn)
    if not drawn:
        lacking = [one for one in described.findings if one.code in NOT_SHOWN]
        for one in lacking:
            found.add(one.code, one.text, Span(path.as_posix()))
        return None if lacking else described.robot
    if described.missing:
        count = len(described.missing)
        message = f"{count} {'detail' if count == 1 else 'details'} of the file not shown"
        found.add("SB825", message, Span(path.as_posix()), notes=described.missing)
    return described.robot
