"""``stepbot datasheet``: what the geometry, masses and limits of a robot allow."""

from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics

from .command import PATH, Command, display_options, ignore_option
from .diagnostic_text import printable
from .reading import package_path_option, reading_options, say_trouble
from .terminal import Display, show_diagnostics_of_use, write_document, write_result

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.robot.datasheet import ArmFigures, DataSheet


@click.command(cls=Command, epilog="Example: stepbot datasheet arm.robot.yaml > arm.md")
@click.argument("target", metavar="TARGET", type=PATH)
@ignore_option
@reading_options
@package_path_option
@display_options
def command(options: "Options", target: Path, display: Display) -> int:
    """Print the data sheet of a robot, as Markdown.

    It has masses, motors, reach, payload over reach, Denavit-Hartenberg parameters, and for each joint its limits,
    gravity torque, inertia, acceleration and the natural frequency of its gains.

    TARGET is a sidecar, or any URDF, SDFormat or MJCF file. Forces are the worst of many postures in the range of all
    joints. Robots with closed loops have no figures of joints and arms.
    """
    from stepbot.diagnostics import Ignore, Span, StepbotError
    from stepbot.pipeline.collisions import robot_of
    from stepbot.robot.datasheet import data_sheet

    found = Diagnostics()
    found.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    sheet: DataSheet | None = None
    try:
        read = robot_of(target, options, found)
        sheet = None if read is None else data_sheet(read[0])
    except StepbotError as error:
        found.extend(error.diagnostics)
    say_trouble(options.cache, found)
    if display.json:
        from stepbot.report.plain import plain

        content = None if sheet is None else plain(sheet)
        return write_document({"datasheet": content}, found)
    show_diagnostics_of_use(found, display)
    if sheet is not None:
        write_result(printable("\n".join(_page(sheet))))
    return found.exit_code


def _page(sheet: "DataSheet") -> Iterator[str]:
    yield f"# {sheet.name}"
    yield ""
    yield f"- mass: {sheet.mass:.4g} kg"
    if sheet.size is not None:
        yield "- size at home: " + " x ".join(f"{1e3 * edge:.0f}" for edge in sheet.size) + " mm"
    if sheet.standing is not None:
        height, margin = sheet.standing
        inside = "" if margin is None else f"; its com is {1e3 * margin:.0f} mm inside of what it stands on"
        yield f"- stands with its base {1e3 * height:.0f} mm over the floor{inside}"
    yield from (f"- {actuator}: motor {motor}" for actuator, motor in sheet.motors)
    yield from _table(("link", "mass [kg]"), [(name, f"{mass:.4g}") for name, mass in sheet.links])
    if sheet.joints:
        rows = [
            (
                one.name,
                f"{one.lower:.4g} to {one.upper:.4g}",
                _number(one.velocity),
                _number(one.effort),
                _number(one.gravity),
                f"{one.inertia[0]:.4g} to {one.inertia[1]:.4g}",
                _number(one.acceleration),
                "-" if one.frequency is None else f"{one.frequency[0]:.3g} to {one.frequency[1]:.3g}",
            )
            for one in sheet.joints
        ]
        heads = ("joint [SI]", "range", "velocity", "effort", "gravity", "inertia", "acceleration", "gains [Hz]")
        yield from _table(heads, rows)
    for arm in sheet.arms:
        yield from _arm(arm)


def _arm(arm: "ArmFigures") -> Iterator[str]:
    yield ""
    yield f"## {arm.tip}"
    yield ""
    yield f"- reach: {1e3 * arm.reach:.0f} mm from the axis of {arm.joints[0]}"
    if arm.payloads:
        yield from _table(
            ("tip up to [mm]", "payload [kg]"), [(f"{1e3 * far:.0f}", f"{mass:.3g}") for far, mass in arm.payloads]
        )
    if arm.dh is not None:
        rows = [
            (row.joint, f"{row.theta:.5g}", f"{row.d:.5g}", f"{row.a:.5g}", f"{row.alpha:.5g}") for row in arm.dh.rows
        ]
        yield from _table(("DH, standard", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"), rows)
        shifted = [("0", "0"), *((row[3], row[4]) for row in rows)]
        modified = [(*row[:3], *before) for row, before in zip(rows, shifted, strict=False)]
        yield from _table(("DH, modified", "theta [rad]", "d [m]", "a before [m]", "alpha before [rad]"), modified)
        places = (("first frame in the base", arm.dh.base), (f"{arm.tip} in the last frame", arm.dh.tool))
        yield ""
        for words, X in places:
            xyz, rpy = (" ".join(f"{value:.5g}" for value in values) for values in (X.position, X.rpy))
            yield f"- {words}: xyz {xyz}, rpy {rpy}"


def _table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    yield ""
    for row in (heads, ("---",) * len(heads), *rows):
        yield f"| {' | '.join(row)} |"


def _number(value: float | None) -> str:
    return "-" if value is None or not isfinite(value) else f"{value:.4g}"
