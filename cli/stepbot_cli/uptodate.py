"""``stepbot uptodate``: whether committed files are what stepbot would write now."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics

from .caching import say_trouble
from .command import Command, display_options, json_option
from .convert import again_format_option, format_names
from .progress import progress_bar
from .reading import reading_options
from .terminal import Display, show_diagnostics, write_json

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


@click.command(
    cls=Command,
    short_help="Check that written files are what would be written now.",
    epilog="Example: stepbot uptodate arm.robot.yaml -o arm",
)
@click.argument("sidecars", metavar="[SIDECAR|DIR]...", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    help="Folder of the files, where {name} stands for the robot and {folder} for that of its sidecar.  "
    "[default: every folder below the current one that `convert` or `batch` has filled]",
)
@again_format_option
@click.option("--ignore", multiple=True, metavar="GLOB", help="Do not compare these files; may be repeated.")
@click.option("--strict", is_flag=True, help="As for `convert`.")
@reading_options
@json_option
@display_options
def command(
    options: "Options",
    sidecars: tuple[Path, ...],
    output: str | None,
    formats: tuple[str, ...],
    ignore: tuple[str, ...],
    strict: bool,
    as_json: bool,
    display: Display,
) -> int:
    """Compare the files in each robot's folder with what `convert` would write; writes nothing.

    Of a folder all sidecars below it, without any those of the current folder. Robot files and meshes are compared byte
    by byte, of report.json what does not depend on the engines that are installed; no engine is asked.
    """
    from stepbot.jobs.discovery import find_sidecars, robot_name
    from stepbot.jobs.uptodate import check_up_to_date, output_folders

    options = replace(options, formats=format_names(formats), strict=strict)
    found = Diagnostics()
    paths = find_sidecars(sidecars or (Path(),), found)
    filled = output_folders(Path()) if output is None else {}
    with progress_bar() as progress:
        for path in paths:
            folders = filled.get(path.resolve()) or [_folder(output or "{name}", robot_name(path), path)]
            for folder in folders:
                check_up_to_date(path, replace(options, output=folder), found, ignore=ignore, progress=progress)
    say_trouble(options.cache, found)
    if as_json:
        write_json({"files": [path.as_posix() for path in paths], "diagnostics": found, "exit_code": found.exit_code})
    else:
        show_diagnostics(found, display, as_result=True)
    return found.exit_code


def _folder(template: str, name: str, sidecar: Path) -> Path:
    try:
        return Path(template.format(name=name, folder=sidecar.parent.as_posix()))
    except (KeyError, IndexError, ValueError):
        raise click.BadParameter(f"'{template}' has braces other than {{name}} and {{folder}}") from None
