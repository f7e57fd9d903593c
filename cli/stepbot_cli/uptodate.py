"""``stepbot uptodate``: check that committed files are up to date."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, counted
from stepbot.runtime.file import is_folder, resolved

from .command import PATH, Command, display_options, ignore_option, usage_errors
from .convert import (
    again_format_option,
    for_option,
    formats_with,
    gazebo_option,
    model_of,
    package_name,
    package_option,
    ros2_option,
)
from .machine_output import output_format_option
from .progress import progress_bar
from .reading import description_options, metadata_options, reading_options, report_trouble
from .terminal import Display, show_diagnostics, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


@click.command(cls=Command, epilog="Example: stepbot uptodate arm.robot.yaml -o arm")
@click.argument("sidecars", metavar="[SIDECAR|DIR]...", nargs=-1, type=PATH)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    help="Output folder, or one with a subfolder per robot; {name} is the robot, {folder} the folder of its sidecar.  "
    "[default: all output folders of `convert` and `batch` below the current folder]",
)
@again_format_option
@package_option
@ros2_option
@gazebo_option
@for_option
@click.option("--exclude", multiple=True, metavar="GLOB", help="Do not compare matching files; may be repeated.")
@click.option("--strict", is_flag=True, help="Same as for `convert`.")
@ignore_option
@reading_options
@description_options
@metadata_options
@display_options
@output_format_option
def command(
    options: "Options",
    sidecars: tuple[Path, ...],
    output: str | None,
    formats: tuple[str, ...],
    package: str,
    ros2: str,
    gazebo: bool,
    exclude: tuple[str, ...],
    display: Display,
) -> int:
    """Compare the output files of each robot with what `convert` would write. No files are written.

    Folders are searched recursively for sidecars; the default is the current folder. Robot files and meshes are
    compared byte by byte, report.json without the parts that depend on installed engines. No engine is started.
    """
    from stepbot.jobs.discovery import find_sidecars, robot_name, variants_of
    from stepbot.jobs.uptodate import check_up_to_date, output_folders

    formats = formats_with(options.programs, formats)
    options = options._replace(formats=formats, package=package_name(package, ros2, formats), ros2=bool(ros2))
    diagnostics = Diagnostics()
    paths = find_sidecars(sidecars or (Path(),), diagnostics)
    filled = output_folders(Path()) if output is None else {}
    compared = 0
    with progress_bar(options=options) as progress:
        for path in paths:
            folders = list(filled.get(resolved(path), {}).items()) or [
                (_folder(output or "{name}", robot_name(path, variant), path), variant)
                for variant in ("", *variants_of(path))
            ]
            for folder, variant in folders:
                model = model_of(folder, formats) if gazebo else ""
                asked = options._replace(output=folder, gazebo=model, variant=variant)
                check_up_to_date(path, asked, diagnostics, exclude=exclude, progress=progress)
                compared += 1
    report_trouble(options.cache, diagnostics)
    if display.json:
        return write_document({"files": [path.as_posix() for path in paths]}, diagnostics)
    after_verdict = write_verdict(f"{counted(compared, 'output folder')} compared:", diagnostics, display)
    show_diagnostics(diagnostics, display, as_result=True, after_verdict=after_verdict)
    if display.shows_results and not diagnostics.has_errors:
        write_result(f"ok: {counted(compared, 'output folder')} up to date")
    return diagnostics.exit_code


def _folder(template: str, name: str, sidecar: Path) -> Path:
    from stepbot.jobs.discovery import output_folder

    with usage_errors():
        folder = output_folder(template, name, sidecar)
    return folder / name if is_folder(folder / name) else folder  # as `batch` writes several into one folder
