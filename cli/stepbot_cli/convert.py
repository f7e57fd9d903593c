"""``stepbot convert``: convert a sidecar and a STEP file, and verify the written files."""

import json
import shlex
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import counted, did_you_mean
from stepbot.formats import FORMATS, default_formats, format_named

from .command import PATH, Command, display_options, ignore_option, names_option, split_names, usage_errors
from .machine_output import junit_option, output_format_option, write_junit
from .progress import CONVERSION, progress_bar
from .reading import (
    description_options,
    metadata_options,
    reading_options,
    reject_descriptions,
    report_trouble,
    require_option,
    variant_option,
)
from .table import show_joint_rows, show_table, write_filled
from .terminal import Display, screen_width, show_diagnostics, write_json, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Conversion, Options
    from stepbot.report.document import Suite
    from stepbot.report.results import Results

_WRITTEN_BY_OPTIONS = {
    ("ros", "moveit", "xacro", "srdf", "ament"): "a ROS 2 package is written by `--ros2 NAME`",
    ("gazebo", "gz", "ignition"): "a Gazebo model is written by `--gazebo`, a world by `-f sdf`",
    ("gym",): "environments are made of MJCF: `-f mjcf`, then `stepbot.gym.make` in Python",
}
"""Beginnings of the names of programs and their files, in lower case, and what to write for them."""

format_option = names_option(
    "-f",
    "--format",
    "formats",
    metavar="FORMAT,...",
    help=f"Formats to write, of {', '.join(FORMATS)}; may be repeated.  [default: {','.join(default_formats())}]",
)
again_format_option = names_option("-f", "--format", "formats", metavar="FORMAT,...", help="Same as for `convert`.")
strict_option = click.option(
    "--strict", is_flag=True, help="Turn warnings into errors, including all conversion losses."
)
html_option = click.option(
    "--html", is_flag=True, help="Also write report.html, one page with the robot and everything about it."
)
drive_option = click.option(
    "--drive", is_flag=True, help="Also drive the written files in MuJoCo and PyBullet; see `stepbot drive`."
)


def _package(context: click.Context, option: click.Parameter, given: str | None) -> str:  # noqa: ARG001
    """The name of a ROS package."""
    if not given:
        return ""
    from stepbot.formats.urdf.package import package_named

    with usage_errors():
        return package_named(given)


package_option = click.option(
    "--package",
    metavar="NAME",
    callback=_package,
    help="Write mesh paths of the URDF as package://NAME/meshes/..., for a ROS package with the output as its content.",
)
ros2_option = click.option(
    "--ros2",
    metavar="NAME",
    callback=_package,
    help="Make the output folder the ROS 2 package NAME_description: xacro, launch file, ros2_control, MoveIt; implies "
    "--package.",
)
gazebo_option = click.option(
    "--gazebo",
    is_flag=True,
    help="Make the output folder a Gazebo model: model.config, model.sdf, and mesh paths as model://DIR/meshes/...",
)


def _programs(context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    """Names of programs for learning."""
    names = split_names(context, option, given)
    if not names:
        return ()
    from stepbot.formats.learning import MENAGERIE, program_names

    with usage_errors():
        programs = program_names(names)
    if MENAGERIE in programs:
        from .render import require_packages

        require_packages()  # its picture
    return programs


for_option = click.option(
    "--for",
    "programs",
    multiple=True,
    callback=_programs,
    metavar="PROGRAM,...",
    help="Also write a Python file that loads the robot in mjlab, maniskill, genesis, isaaclab, playground, lerobot, "
    "newton or robosuite, with its gains and initial pose; menagerie, simready: a folder for MuJoCo Menagerie, for "
    "Isaac Sim's libraries of assets. Implies their formats.",
)
no_verify_option = click.option(
    "--no-verify",
    "verify",
    is_flag=True,
    callback=lambda _context, _option, given: not given,
    help="Skip loading the written files in engines.",
)


@click.command(
    cls=Command,
    epilog="Example: stepbot convert arm.robot.yaml -f urdf,sdf -o arm\n\n"
    "From another format: stepbot convert robot.urdf -f mjcf,sdf -o robot",
)
@click.argument("sidecar", type=PATH)
@click.option("--step", type=PATH, metavar="FILE", help="STEP file, instead of the one in SIDECAR.")
@format_option
@click.option(
    "-o", "--output", type=PATH, metavar="DIR", help="Output folder.  [default: name of SIDECAR, in the current folder]"
)
@no_verify_option
@drive_option
@strict_option
@require_option
@ignore_option
@reading_options
@variant_option
@description_options
@html_option
@package_option
@ros2_option
@metadata_options
@gazebo_option
@for_option
@junit_option
@display_options
@output_format_option
def command(
    options: "Options",
    sidecar: Path,
    step: Path | None,
    formats: tuple[str, ...],
    output: Path | None,
    drive: bool,
    package: str,
    ros2: str,
    gazebo: bool,
    junit: Path | None,
    display: Display,
) -> int:
    """Convert the robot of SIDECAR to URDF, SDFormat and MJCF, and verify the files.

    SIDECAR names a STEP file; in its place, a URDF, SDFormat or MJCF is converted to the other formats.

    Each file is loaded in every engine that supports its format, and the loaded robot is compared with the CAD model.
    The table lists the largest deviations. If an error occurs, existing files in DIR remain unchanged.
    """
    if step is not None:
        reject_descriptions("--step", [sidecar])
    formats = formats_with(options.programs, formats)
    package = package_name(package, ros2, formats)
    output = output or default_output(sidecar, options.variant)
    options = options._replace(
        output=output,
        formats=formats,
        step=step,
        package=package,
        ros2=bool(ros2),
        gazebo=model_of(output, formats) if gazebo else "",
    )
    return run_conversion(sidecar, options, junit=junit, drive=drive, display=display)


def formats_with(programs: tuple[str, ...], given: tuple[str, ...]) -> tuple[str, ...]:
    """The formats to write: those of `-f`, and those that the programs of `--for` load."""
    formats = format_names(given)
    if not programs:
        return formats
    from stepbot.formats.learning import formats_for

    return formats_for(programs, formats)


def package_name(package: str, ros2: str, formats: tuple[str, ...]) -> str:
    """The ROS package of `--package` or `--ros2`; empty for none.

    Raises:
        click.UsageError: Both are given, or there is no URDF.
    """
    if not (package or ros2):
        return ""
    from stepbot.formats.urdf.package import package_of

    with usage_errors(click.UsageError):
        return package_of(package, ros2, format_names(formats), prefix="--")


def model_of(output: Path, formats: tuple[str, ...]) -> str:
    """The name of the Gazebo model in an output folder.

    Raises:
        click.UsageError: It cannot be in a URI, or there is no SDFormat.
    """
    from stepbot.formats.sdformat.model_name import model_name

    with usage_errors(click.UsageError, "--gazebo: "):
        return model_name(output, format_names(formats))


def run_conversion(
    sidecar: Path, options: "Options", *, display: Display, junit: Path | None = None, drive: bool = False
) -> int:
    """Convert a sidecar and print the result; returns the exit code.

    Raises:
        click.UsageError: Engines are required, and none is to run.
    """
    if options.require and not options.verify:
        raise click.UsageError("--require and --no-verify cannot be combined")
    from stepbot.jobs.incremental import convert
    from stepbot.runtime.output import failed_output

    driven = None
    with progress_bar((*CONVERSION, "drive") if drive else CONVERSION, options) as progress:
        conversion = convert(sidecar, options, progress)
        failed = conversion.diagnostics.has_errors  # before the drive tests: their findings move no file
        folder = failed_output(options.output) if failed else options.output
        if drive and not failed:
            from stepbot.pipeline.driving import DriveOptions
            from stepbot.pipeline.driving import drive as drive_files

            driven = drive_files(options.output, options, DriveOptions(), conversion.diagnostics, progress)
    report_trouble(options.cache, conversion.diagnostics)
    if junit is not None:
        write_junit(junit, [_suite(sidecar, conversion)])
    if display.json:
        document = _document(conversion, folder)
        if drive:
            from stepbot.driving.document import driven_document

            document["drive"] = None if driven is None else driven_document(driven)
        write_json(document)
        return conversion.diagnostics.exit_code
    if failed:
        name = default_output(sidecar, options.variant).name
        then = _left(options.output, wrote_beside=bool(conversion.files))
        write_verdict(f"{name}: not converted", conversion.diagnostics, display, then)
    if display.shows_results:
        _show_verdict(conversion, display)
        if driven is not None:
            from .drive import driven_lines

            write_result("\n".join(driven_lines(driven, screen_width(sys.stdout), verbose=display.verbose)))
    show_diagnostics(conversion.diagnostics, display, after_verdict=failed)
    if display.shows_results and conversion.files:
        _show_files(conversion.files, folder, failed=failed)
    return conversion.diagnostics.exit_code


def _left(output: Path, *, wrote_beside: bool) -> str:
    """What a conversion with errors did to its output folder."""
    from stepbot.runtime.file import exists

    if exists(output):
        return f"{output.as_posix()} is unchanged"
    return f"{output.as_posix()} is not written" if wrote_beside else "nothing is written"


def _show_verdict(conversion: "Conversion", display: Display) -> None:
    """Print what the robot is, what is proven, and which joints are on weak evidence; with -v all results."""
    summary = conversion.summary
    if summary is None:
        return
    write_filled(summary.robot, *summary.proof)
    if display.verbose and (report := conversion.report) is not None:
        write_result("")
        _show_in_full(report)
        write_result("")
    elif summary.weak:
        write_filled(summary.weak)


def _show_files(files: Iterable[str], folder: Path, *, failed: bool) -> None:
    """``19 files in arm: arm.urdf, ...``, and how to see the robot."""
    words = f"{counted(len(list(files)), 'file')} in {folder.as_posix()}"
    if failed:
        write_filled(f"{words}, to look at")
    else:
        write_filled(f"{words}    see it: stepbot view {shlex.quote(folder.as_posix())}")


def _show_in_full(report: "Results") -> None:
    """Print the evidence for each joint, masses, the figures of motors, collision shapes, and each engine's results."""
    from stepbot.report.words import collision_summary, mass_summary, mass_words

    show_joint_rows(report.joint_table)
    if report.masses:
        write_filled(mass_summary(report.masses), *(f"  {link}: {mass_words(m)}" for link, m in report.masses.items()))
    for name, motor in report.motors.items():
        sources = (f"  {figure.quantity} {figure.value:.6g} {figure.unit}: {figure.source}" for figure in motor.figures)
        write_filled(f"actuator {name}: motor {motor.name}", *sources)
    if shapes := report.collision_shapes:
        links = (f"  {shape.link}: {collision_summary([shape]).partition(': ')[2]}" for shape in shapes)
        write_filled(collision_summary(shapes), *links)
    if report.checks:
        show_table(report)


def default_output(sidecar: Path, variant: str = "") -> Path:
    """Folder for the files of a sidecar: ``arm.robot.yaml`` goes to ``arm``, its variant ``long`` to ``arm_long``."""
    name = sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot")
    return Path(f"{name}_{variant}" if variant else name)


def format_names(given: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the formats to write, without duplicates and with aliases resolved."""
    if not given:
        return default_formats()
    names = []
    for name in given:
        try:
            names.append(format_named(name).name)
        except KeyError:
            known = (*FORMATS, *(alias for one in FORMATS.values() for alias in one.aliases))
            remedy = _in_another_program(name) or "".join(did_you_mean(name, known))
            remedy = remedy or f"choose from {', '.join(FORMATS)}"
            raise click.BadParameter(f"unknown format '{name}'; {remedy}", param_hint="--format") from None
    return tuple(dict.fromkeys(names))


def _in_another_program(name: str) -> str:
    """The option or format for a program, library or file that is given as a format; empty if it is unknown."""
    bare = "".join(c for c in name.casefold() if c.isalnum())
    by_option = next((words for programs, words in _WRITTEN_BY_OPTIONS.items() if bare.startswith(programs)), "")
    read = next((one for one in FORMATS.values() if bare.startswith(one.programs)), None)
    return by_option or (f"it reads {read.title}: `-f {read.name}`" if read else "")


def _suite(sidecar: Path, conversion: "Conversion") -> "Suite":
    """The checks of a robot as test cases; named after the sidecar if there is no robot."""
    from stepbot.pipeline.conversion import REPORT
    from stepbot.report.document import Suite

    checks = json.loads(conversion.files[REPORT])["checks"] if conversion.files else []
    name = conversion.robot.name if conversion.robot is not None else default_output(sidecar).name
    return Suite(name, checks, tuple(conversion.diagnostics))


def _document(conversion: "Conversion", folder: Path) -> dict[str, object]:
    """The output of ``--json``."""
    from stepbot.pipeline.conversion import REPORT

    report = json.loads(conversion.files[REPORT]) if conversion.files else None
    return {
        "robot": report["robot"]["name"] if report else None,
        "output": folder.as_posix() if conversion.files else None,
        "files": sorted(conversion.files),
        "report": report,
        "diagnostics": conversion.diagnostics,
        "exit_code": conversion.diagnostics.exit_code,
    }
