"""Options for a URDF, SDFormat or MJCF in place of a sidecar."""

from collections.abc import Callable, Iterable
from functools import wraps
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options

_base_option = click.option(
    "--base",
    type=click.Choice(["fixed", "floating"]),
    help="Whether the base of a converted URDF is fixed to the world: the format does not say.",
)
xacro_option = click.option(
    "--xacro",
    multiple=True,
    metavar="NAME:=VALUE",
    callback=lambda _context, _parameter, given: tuple(map(_argument, given)),
    help="Value of an argument of a xacro; may be repeated.",
)
_inertia_option = click.option(
    "--assume-inertia",
    metavar="DENSITY",
    callback=lambda _context, _parameter, text: _density(text),
    help="Compute mass properties that a description lacks, or states impossibly, from its geometry and this density: "
    "1000, '2.7 g/cm^3'. Each is reported.",
)
folders_option = click.option(
    "--package-path",
    "package_path",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder of a package, or of packages, that a description names in package:// or model://; may be repeated.",
)


def package_path_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--package-path`` and ``--xacro`` to the ``options`` that :func:`.reading.reading_options` makes."""

    @wraps(command)
    def with_packages(
        *, options: "Options", package_path: tuple[Path, ...], xacro: tuple[tuple[str, str], ...], **others: Any
    ) -> int:
        return command(options=options._replace(package_path=package_path, xacro=xacro), **others)

    return folders_option(xacro_option(with_packages))


def description_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--base``, ``--assume-inertia`` and ``--package-path``, too."""

    @wraps(command)
    def with_settings(*, options: "Options", base: str | None, assume_inertia: float, **others: Any) -> int:
        return command(options=options._replace(base=base or "", assume_inertia=assume_inertia), **others)

    return package_path_option(_base_option(_inertia_option(with_settings)))


def _argument(text: str) -> tuple[str, str]:
    """Name and value of an argument, as ROS writes it, or with a plain equals sign."""
    name, sign, value = text.partition(":=") if ":=" in text else text.partition("=")
    if not (sign and name.strip()):
        raise click.BadParameter(f"'{text}' is not NAME:=VALUE: `--xacro ur_type:=ur5e`")
    return name.strip(), value


def _density(text: str | None) -> float:
    """A density [kg/m^3], as in a sidecar; 0 for none."""
    if text is None:
        return 0.0
    from stepbot.sidecar.units import DENSITY, UnitError, read_quantity

    try:
        density = read_quantity(text, DENSITY).value
    except UnitError as error:
        raise click.BadParameter(str(error)) from error
    if not 0.0 < density < inf:
        raise click.BadParameter(f"'{text}' is not a density above 0")
    return density


def reject_descriptions(what: str, paths: Iterable[Path]) -> None:
    """Reject an option or a command that applies to sidecars alone.

    Args:
        what: The option or command, for the message.
        paths: What it was given for.

    Raises:
        click.UsageError: One of the files is a URDF, SDFormat or MJCF.
    """
    from stepbot.pipeline.conversion import is_description

    for path in filter(is_description, paths):
        name = printable(path.name)
        remedy = f"`stepbot init CAD.step --from {name}` drafts a sidecar of a STEP file from it"
        raise click.UsageError(f"{what} needs a sidecar: {name} is a robot description; {remedy}")
