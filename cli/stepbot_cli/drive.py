"""``stepbot drive``: move a robot by its actuators in MuJoCo and PyBullet, and judge how it behaves."""

import sys
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.driving.plan import ENGINES, TESTS

from .caching import say_trouble
from .command import Command, display_options, json_option, names_option
from .descriptions import package_path_option
from .drive_table import driven_json, driven_lines
from .picture_file import require_plots
from .progress import progress_bar
from .reading import reading_options, variant_option
from .terminal import Display, screen_width, show_diagnostics_of_use, write_json, write_result

if TYPE_CHECKING:
    from stepbot.driving.driving import Driven
    from stepbot.pipeline.conversion import Options

_NOTHING: dict[str, Any] = {"robot": None, "tests": [], "inapplicable": {}, "not_run": {}, "ranges": []}


def _known(given: tuple[str, ...], known: Collection[str], noun: str) -> tuple[str, ...]:
    names = tuple(name.lower() for name in given)
    for name in names:
        if name not in known:
            near = "".join(did_you_mean(name, known)) or f"choose from {', '.join(known)}"
            raise click.BadParameter(f"unknown {noun} '{name}'; {near}")
    return names


@click.command(
    cls=Command,
    epilog="Example: stepbot drive gripper.robot.yaml --test hold,grip",
)
@click.argument("target", metavar="TARGET", type=click.Path(path_type=Path))
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
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="JSON file whose object `drive` has the robot's own limits, such as an expected.json of the library.",
)
@click.option(
    "--plots", type=click.Path(path_type=Path), metavar="DIR", help="Draw the curves of each test, as SVG files in DIR."
)
@reading_options
@variant_option
@package_path_option
@json_option
@display_options
def command(
    options: "Options",
    target: Path,
    tests: tuple[str, ...],
    engines: tuple[str, ...],
    limits: Path | None,
    plots: Path | None,
    as_json: bool,
    display: Display,
) -> int:
    """Move the robot of TARGET by its actuators in MuJoCo and PyBullet, and compare its behaviour with limits.

    TARGET is a sidecar, a folder that `stepbot convert` wrote, or an MJCF or URDF in such a folder. The files are
    driven as they are; a floor or a cube is added around the robot. Tests that do not apply, and an engine that is not
    installed, are listed with the reason.
    """
    from stepbot.pipeline.driving import DriveOptions, drive

    if plots is not None:
        require_plots()
    chosen = DriveOptions(_known(tests, TESTS, "test"), _known(engines, ENGINES, "engine"), limits)
    found = Diagnostics()
    with progress_bar(("read", "build", "write", "drive"), options) as progress:
        driven = drive(target, options, chosen, found, progress)
    say_trouble(options.cache, found)
    drawn = _draw(driven, plots) if driven is not None and plots is not None else []
    if as_json:
        write_json(
            {
                **(driven_json(driven) if driven is not None else _NOTHING),
                "plots": drawn,
                "diagnostics": found,
                "exit_code": found.exit_code,
            }
        )
        return found.exit_code
    if driven is not None and not (display.quiet or display.concise):
        write_result("\n".join(driven_lines(driven, screen_width(sys.stdout), verbose=display.verbose)))
    show_diagnostics_of_use(found, display)
    return found.exit_code


def _draw(driven: "Driven", folder: Path) -> list[str]:
    from stepbot.driving.plots import draw

    return [path.as_posix() for path in draw(driven, folder)]
