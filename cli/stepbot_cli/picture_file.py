"""The file of a picture: checks before the work, and writing."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.file import replace_file

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.pictures.picture import Picture


def checked_picture_name(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:  # noqa: ARG001
    """The path of a PNG file.

    Raises:
        click.BadParameter: Another suffix.
    """
    if path is not None and path.suffix.lower() != ".png":
        raise click.BadParameter(f"'{path.name}' is not a PNG file; choose a name that ends in .png")
    return path


def require_packages() -> None:
    """Import what drawing needs, before a long STEP file is read.

    Raises:
        ModuleNotFoundError: A package of the extra ``render`` is missing.
    """
    import importlib

    from stepbot.pictures.picture import PACKAGES

    for package in PACKAGES:
        importlib.import_module(package)


def require_plots() -> None:
    """Import what plots need.

    Raises:
        ModuleNotFoundError: The package of the extra ``draw`` is missing.
    """
    import importlib

    from stepbot.driving.plots import PACKAGE

    importlib.import_module(PACKAGE)


def write_picture(path: Path, picture: "Picture", found: Diagnostics) -> None:
    """Write a PNG file; SB004 if that is impossible."""
    from stepbot.pictures.picture import png_bytes

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, png_bytes(picture.pixels))
    except OSError as error:
        help = ["choose another file with -o"]
        found.add("SB004", f"cannot write: {error.strerror or error}", Span(path.as_posix()), help=help)


def picture_lines(path: Path, picture: "Picture", labels: bool) -> list[str]:
    """The written file, and what it does not show."""
    lines = [printable(path.as_posix())]
    for names, why in ((picture.hidden if labels else (), "behind other parts"), (picture.unlabelled, "without label")):
        lines += [printable(f"{why}: {', '.join(dict.fromkeys(names))}")] if names else []
    return lines
