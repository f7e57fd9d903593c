"""``stepbot datasheet``: what the geometry, masses and limits of a robot allow."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics

from .command import PATH, Command, display_options, ignore_option
from .diagnostic_text import printable
from .reading import package_path_option, reading_options, report_trouble
from .terminal import Display, show_diagnostics_of_use, write_document, write_result

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.robot.datasheet import DataSheet


@click.command(cls=Command, epilog="Example: stepbot datasheet arm.robot.yaml > arm.md")
@click.argument("target", metavar="TARGET", type=PATH)
@ignore_option
@reading_options
@package_path_option
@display_options
def command(options: "Options", target: Path, display: Display) -> int:
    """Print the data sheet of a robot, as Markdown.

    It has masses by link, motor and material, reach, payload over reach, Denavit-Hartenberg parameters, and for each
    joint its limits, gravity torque, inertia, acceleration, jerk and the natural frequency of its gains.

    TARGET is a sidecar, or any URDF, SDFormat or MJCF file. Forces are the worst of many postures in the range of all
    joints. In closed loops, they are those of the joints that drive the others; reach and payload are of arms without
    loops.
    """
    from stepbot.diagnostics import Ignore, Span, StepbotError
    from stepbot.pipeline.collisions import robot_of
    from stepbot.robot.datasheet import data_sheet

    diagnostics = Diagnostics()
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    sheet: DataSheet | None = None
    try:
        read = robot_of(target, options, diagnostics)
        sheet = None if read is None else data_sheet(read[0])
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
    report_trouble(options.cache, diagnostics)
    if display.json:
        from stepbot.report.plain import plain

        content = None if sheet is None else plain(sheet)
        return write_document({"datasheet": content}, diagnostics)
    show_diagnostics_of_use(diagnostics, display, f"{target.as_posix()}: no data sheet")
    if sheet is not None:
        write_result(printable("\n".join(_page(sheet))))
    return diagnostics.exit_code


def _page(sheet: "DataSheet") -> Iterator[str]:
    from stepbot.report.words import sheet_blocks

    yield f"# {sheet.name}"
    last = ""
    for block in sheet_blocks(sheet):
        if isinstance(block, str):
            if not (last.startswith("- ") and block.startswith("- ")):
                yield ""
            yield block
            last = block
        else:
            heads, rows = block
            yield ""
            for row in (heads, ("---",) * len(heads), *rows):
                yield f"| {' | '.join(row)} |"
            last = ""
