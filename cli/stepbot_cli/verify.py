"""``stepbot verify``: load robot files in all engines and compare the results."""

from pathlib import Path

import click

from stepbot.diagnostics import Diagnostics, Ignore, Span

from .command import PATH, Command, display_options, ignore_option
from .machine_output import junit_option, output_format_option, write_junit
from .progress import progress_bar
from .reading import limit_options, package_path_option, require_option
from .table import show_joint_rows, show_table, write_filled
from .terminal import Display, show_diagnostics, write_document, write_result, write_verdict


@click.command(cls=Command, epilog="Example: stepbot verify arm.urdf arm.sdf --require mujoco")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=PATH)
@click.option("--strict", is_flag=True, help="Turn warnings into errors.")
@require_option
@ignore_option
@limit_options
@package_path_option
@junit_option
@display_options
@output_format_option
def command(
    files: tuple[Path, ...],
    strict: bool,
    ignore: tuple[str, ...],
    require: tuple[str, ...],
    timeout: float,
    memory_limit: int | None,
    package_path: tuple[Path, ...],
    xacro: tuple[tuple[str, str], ...],
    junit: Path | None,
    display: Display,
) -> int:
    """Load URDF, SDFormat and MJCF files in every engine that supports them, and compare the loaded robots.

    The files may come from any source. Several files must describe the same robot, and are compared with the first. A
    folder stands for the files of the robot in it.
    """
    from stepbot.pipeline.verdict import compared_words
    from stepbot.report.document import Suite, report_document
    from stepbot.runtime.worker import Workers
    from stepbot.verification.admission import robot_files
    from stepbot.verification.files import verify_files

    files = tuple(file for path in files for file in robot_files(path))
    diagnostics = Diagnostics()
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in ignore)
    with progress_bar(("verify",)) as progress:
        progress("verify")
        workers = Workers(timeout, memory_limit)
        report = verify_files(files, diagnostics, require=require, workers=workers, packages=package_path, xacro=xacro)
    if strict:
        diagnostics.make_strict()
    document = report_document(report, diagnostics)
    if junit is not None:
        write_junit(junit, [Suite(files[0].stem, document["checks"], tuple(diagnostics), whole="verification")])
    if display.json:
        return write_document({"report": document}, diagnostics)
    shown = report.checks and display.shows_results
    if shown:
        write_filled(*compared_words(report, files))
        if display.verbose:
            show_joint_rows(report.joint_table)
            show_table(report)
    after_verdict = not shown and write_verdict(f"{files[0].as_posix()}: not verified", diagnostics, display)
    show_diagnostics(diagnostics, display, after_verdict=after_verdict)
    if shown and not display.verbose:
        write_result("joints, engines and deviations: -v; every check: --json")
    return diagnostics.exit_code
