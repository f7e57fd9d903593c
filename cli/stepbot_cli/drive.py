"""``stepbot drive``: move a robot by its actuators in MuJoCo and PyBullet, and judge how it behaves."""

import shlex
import sys
from collections.abc import Collection, Iterator, Mapping
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, counted, did_you_mean
from stepbot.driving.plan import ENGINES, TESTS

from .command import PATH, Command, display_options, names_option
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble, variant_option
from .table import filled, status_lines
from .terminal import Display, screen_width, show_diagnostics_of_use, wants_color, write_document, write_result

if TYPE_CHECKING:
    from stepbot.driving.driving import Driven
    from stepbot.driving.judgement import Verdict
    from stepbot.driving.results import Measure
    from stepbot.driving.survey import SweptRange
    from stepbot.pipeline.conversion import Options


_ALL = 0.995
"""Share of a range from which it counts as covered."""
_HEADINGS = ("test", "engine", "result", "steps/s", "worst")


def driven_lines(driven: "Driven", width: int | None, *, verbose: bool = False) -> list[str]:
    """The counts, the verdicts as a table, the tests that do not apply, and the engines that did not run."""
    speeds = [_speed(verdict) for verdict in driven.verdicts]
    digits = max(map(len, (*speeds, _HEADINGS[3])))
    texts = [_HEADINGS, *(_cells(*one) for one in zip(driven.verdicts, (s.rjust(digits) for s in speeds), strict=True))]
    statuses = [verdict.status.value for verdict in driven.verdicts]
    counts = f"{counted(len(statuses), 'test')}: {statuses.count('passed')} passed, {statuses.count('failed')} failed"
    absent = f"; not run in {' and '.join(driven.not_run)}" if driven.not_run else ""
    lines = [f"driven: {counts}{absent}"]
    lines += status_lines(texts, statuses, width, wants_color(sys.stdout))
    if verbose:
        for verdict in driven.verdicts:
            lines += filled(f"{verdict.test} in {verdict.engine}: {', '.join(_numbers(verdict))}", width)
    for text in _inapplicable(driven.inapplicable, verbose=verbose):
        lines += filled(printable(text), width)
    for one in driven.ranges:
        if one.share < _ALL:
            lines += filled(f"sweep covers {_covered(one)}", width)
    for engine, reason in driven.not_run.items():
        lines += filled(f"not run in {engine}: {printable(reason)}", width)
    return lines


def _inapplicable(reasons: Mapping[str, str], *, verbose: bool) -> Iterator[str]:
    """The tests that do not apply: those of one reason, or all of them unless verbose, in one line."""
    names_of: dict[str, list[str]] = {}
    for name, reason in reasons.items():
        names_of.setdefault(reason, []).append(name)
    tests = [name for name in reasons if name in TESTS]
    if not verbose and len({reasons[name] for name in tests}) > 1:
        yield f"do not apply: {', '.join(tests)} (-v shows why)"
        names_of = {reason: [name for name in names if name not in TESTS] for reason, names in names_of.items()}
    for reason, names in names_of.items():
        if not names:
            continue
        yield f"{', '.join(names)} {'does' if len(names) == 1 else 'do'} not apply: {reason}"


def _covered(one: "SweptRange") -> str:
    """What a sweep covers, in degrees or millimetres, and what stops it."""
    factor, unit = (degrees(1.0), "deg") if one.angular else (1e3, "mm")
    swept, limits = (f"{factor * ends[0]:.4g} to {factor * ends[1]:.4g} {unit}" for ends in (one.swept, one.limits))
    stops = " and ".join(f"{way} by {stop}" for way, stop in zip(("below", "above"), one.stops, strict=True) if stop)
    return printable(f"{100.0 * one.share:.0f} % of the range of {one.joint}: {swept} of {limits}; stopped {stops}")


def _speed(verdict: "Verdict") -> str:
    return f"{verdict.result.steps_per_second:,.0f}" if verdict.result else "-"


def _cells(verdict: "Verdict", speed: str) -> tuple[str, ...]:
    worst = verdict.worst
    if verdict.why or worst is None or verdict.bounds is None:
        text = printable(verdict.why) or "-"
    else:
        text = f"{_number(worst)}, limit {_value(verdict.bounds[worst.quantity], worst.quantity)}"
    return verdict.test, verdict.engine, verdict.status.value, speed, text


def _number(measure: "Measure") -> str:
    place = f" of {printable(measure.where)}" if measure.where else ""
    return f"{measure.quantity}{place} {_value(measure.value, measure.quantity)}"


def _value(value: float, quantity: str) -> str:
    """A number with the unit of its quantity."""
    from stepbot.driving.limits import UNITS

    return f"{value:.3g} {UNITS[quantity]}".rstrip()


def _numbers(verdict: "Verdict") -> list[str]:
    return [_number(measure) for measure in verdict.result.measures] if verdict.result else [verdict.why]


_NOTHING: dict[str, Any] = {"robot": None, "tests": [], "inapplicable": {}, "not_run": {}, "ranges": []}


def _known(given: tuple[str, ...], known: Collection[str], noun: str) -> tuple[str, ...]:
    names = tuple(name.lower() for name in given)
    for name in names:
        if name not in known:
            near = "".join(did_you_mean(name, known)) or f"choose from {', '.join(known)}"
            raise click.BadParameter(f"unknown {noun} '{name}'; {near}")
    return names


@click.command(cls=Command, epilog="Example: stepbot drive gripper.robot.yaml --test hold,grip")
@click.argument("target", metavar="TARGET", type=PATH)
@names_option(
    "--test", "tests", metavar="TEST,...", help=f"Tests to run, of {', '.join(TESTS)}.  [default: all that apply]"
)
@names_option(
    "--engine",
    "engines",
    metavar="ENGINE,...",
    help=f"Engines, of {', '.join(ENGINES)}; one that is not installed is then an error.  [default: those installed]",
)
@click.option(
    "--limits",
    type=PATH,
    metavar="FILE",
    help="JSON file whose object `drive` has the robot's own limits, such as an expected.json of the library.",
)
@click.option("--plots", type=PATH, metavar="DIR", help="Draw the curves of each test, as SVG files in DIR.")
@reading_options
@variant_option
@package_path_option
@display_options
def command(
    options: "Options",
    target: Path,
    tests: tuple[str, ...],
    engines: tuple[str, ...],
    limits: Path | None,
    plots: Path | None,
    display: Display,
) -> int:
    """Move the robot of TARGET by its actuators in MuJoCo and PyBullet, and compare its behaviour with limits.

    TARGET is a sidecar, a folder that `stepbot convert` wrote, or an MJCF or URDF in such a folder. The files are
    driven as they are; a floor or a cube is added around the robot. Tests that do not apply are listed, with -v each
    with its reason, and so is an engine that is not installed.
    """
    from stepbot.pipeline.driving import DriveOptions, drive

    if plots is not None:
        from .render import require_plots

        require_plots()
    chosen = DriveOptions(_known(tests, TESTS, "test"), _known(engines, ENGINES, "engine"), limits)
    diagnostics = Diagnostics()
    with progress_bar(("read", "build", "write", "drive"), options) as progress:
        driven = drive(target, options, chosen, diagnostics, progress)
    report_trouble(options.cache, diagnostics)
    drawn: list[str] = []
    if driven is not None and plots is not None:
        from stepbot.driving.plots import draw

        drawn = [path.as_posix() for path in draw(driven, plots)]
    if display.json:
        from stepbot.driving.document import driven_document

        document = driven_document(driven) if driven is not None else _NOTHING
        return write_document({**document, "plots": drawn}, diagnostics)
    if driven is not None and display.shows_results:
        write_result("\n".join(driven_lines(driven, screen_width(sys.stdout), verbose=display.verbose)))
    failed = f"{target.as_posix()}: not driven" if driven is None else ""
    show_diagnostics_of_use(diagnostics, display, failed, after_verdict=driven is not None and display.shows_results)
    if driven is not None and display.shows_results and not diagnostics.has_errors:
        write_result(f"each number: -v    next: stepbot datasheet {printable(shlex.quote(target.as_posix()))}")
    return diagnostics.exit_code
