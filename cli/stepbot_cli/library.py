"""``stepbot library``: list, show or export the bundled robots."""

import shlex
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.runtime.file import exists, is_file, read_regular, replace_file

from .application import Group
from .columns import aligned, table_lines
from .command import PATH, Command, display_options, json_option
from .convert import format_names, format_option, no_verify_option, run_conversion
from .reading import require_option, working_options
from .terminal import (
    Display,
    screen_width,
    show_diagnostics,
    text_width,
    write_document,
    write_json,
    write_result,
    write_verdict,
)

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.runtime.robot_library import LibraryRobot


_SCHEMA_ID = b'"$id": "urn:stepbot:robot-1"'
"""What no file but the schema has: a sidecar is YAML of another form, and a STEP has no such line."""


@click.group(cls=Group, epilog="Example: stepbot library export ur5e -o ur5e")
def command() -> None:
    """List, show or export the bundled robots: STEP file, sidecar, and a page with the source of every number.

    NAME is a name printed by `stepbot library list`; the manufacturer prefix is optional.
    """


@command.command("list", cls=Command, short_help="List all robots.", epilog="Example: stepbot library list")
@json_option
def list_(as_json: bool) -> int:
    """List all robots with a short description."""
    from stepbot.runtime.robot_library import library_robots

    robots = library_robots()
    if as_json:
        write_json({"robots": [_described(robot) for robot in robots]})
    else:
        rows = [(robot.name, robot.facts(), robot.summary()) for robot in robots]
        write_result("\n".join(table_lines(rows, screen_width(sys.stdout))))
    return 0


@command.command("show", cls=Command, short_help="Show one robot.", epilog="Example: stepbot library show ur5e")
@click.argument("name")
@json_option
def show(name: str, as_json: bool) -> int:
    """Show the joints, links and files of the robot NAME."""
    robot = _robot_named(name)
    if as_json:
        write_json(_described(robot))
        return 0
    width = screen_width(sys.stdout)
    blocks = [robot.name, textwrap.fill(robot.overview(), text_width(sys.stdout)), robot.facts()]
    blocks += ["\n".join(table_lines(rows, width)) for rows in (robot.table("Joints"), robot.table("Links")) if rows]
    files = [("sidecar", str(robot.sidecar)), ("page", f"{robot.page} (sources, verification, licence)")]
    if not robot.is_composed:
        files.insert(1, ("STEP", str(robot.step)))
    blocks += ["\n".join(aligned(files)), f"stepbot library export {robot.name} -o {robot.short_name}"]
    write_result("\n\n".join(filter(None, blocks)))
    return 0


@command.command(
    "export",
    cls=Command,
    short_help="Write one robot in the selected formats.",
    epilog="Example: stepbot library export four_bar -f mjcf -o four_bar",
)
@click.argument("name")
@format_option
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="DIR",
    help="Output folder.  [default: name of the robot, in the current folder]",
)
@click.option("--source", is_flag=True, help="Write only the STEP file and the sidecar, for editing.")
@no_verify_option
@require_option
@working_options
@display_options
def export(
    options: "Options", name: str, formats: tuple[str, ...], output: Path | None, source: bool, display: Display
) -> int:
    """Write the robot NAME as URDF, SDFormat and MJCF, and verify the files, as `stepbot convert` does."""
    robot = _robot_named(name)
    if source:
        if formats or not options.verify or options.require:
            raise click.UsageError("--source cannot be combined with --format, --no-verify or --require")
        return _export_source(robot, output or Path(robot.short_name), display)
    options = options._replace(output=output or Path(robot.short_name), formats=format_names(formats))
    return run_conversion(robot.sidecar, options, display=display)


def _export_source(robot: "LibraryRobot", folder: Path, display: Display) -> int:
    """Write the drawing, the sidecar and its schema; if a different file of such a name exists, nothing is written."""
    files, diagnostics, then = robot.source(), Diagnostics(), "nothing is written"
    help = ["choose another folder with -o DIR"]
    for name, content in files.items():
        path = folder / name
        old = read_regular(path) if is_file(path) else None
        is_schema = old is not None and _SCHEMA_ID in old and _SCHEMA_ID in content  # of another version of stepbot
        if exists(path) and old != content and not is_schema:
            diagnostics.add("SB004", "a different file with this name exists", Span(path.as_posix()), help=help)
    if not diagnostics.has_errors:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, content in files.items():
                replace_file(folder / name, content)
        except OSError as error:
            message, place = f"cannot write: {error.strerror or error}", Span(str(error.filename or folder))
            diagnostics.add("SB004", message, place, help=help)
            then = ""  # some may be
    if display.json:
        written = [] if diagnostics.has_errors else sorted(files)
        return write_document({"output": folder.as_posix(), "files": written}, diagnostics)
    if diagnostics.has_errors:
        after_verdict = write_verdict(f"{robot.short_name}: not exported", diagnostics, display, then)
        show_diagnostics(diagnostics, display, after_verdict=after_verdict)
    else:
        write_result("\n".join((folder / name).as_posix() for name in files))
        write_result(f"next: stepbot view {shlex.quote((folder / robot.sidecar.name).as_posix())}")
    return diagnostics.exit_code


def _robot_named(name: str) -> "LibraryRobot":
    from stepbot.runtime.robot_library import library_robot, library_robots

    try:
        return library_robot(name)
    except KeyError:
        robots = library_robots()
        same = [robot.name for robot in robots if robot.short_name == name]
        known = [*(robot.name for robot in robots), *(robot.short_name for robot in robots)]
        near = " or ".join(same) or "".join(did_you_mean(name, known))
        remedy = near or "list all robots with `stepbot library list`"
        raise click.BadParameter(f"unknown robot '{name}'; {remedy}", param_hint="NAME") from None


def _described(robot: "LibraryRobot") -> dict[str, object]:
    return {
        "name": robot.name,
        "summary": robot.summary(),
        "facts": robot.facts(),
        "sidecar": robot.sidecar.as_posix(),
        "step": None if robot.is_composed else robot.step.as_posix(),
        "page": robot.page.as_posix(),
    }
