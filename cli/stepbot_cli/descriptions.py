"""Options for a URDF, SDFormat or MJCF in place of a sidecar."""

from collections.abc import Callable, Iterable
from functools import wraps
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
folders_option = click.option(
    "--package-path",
    "package_path",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder of a package, or of packages, that a description names in package:// or model://; may be repeated.",
)


def package_path_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--package-path`` to the ``options`` that :func:`.reading.reading_options` makes."""

    @wraps(command)
    def with_packages(*, options: "Options", package_path: tuple[Path, ...], **others: Any) -> int:
        return command(options=options._replace(package_path=package_path), **others)

    return folders_option(with_packages)


def description_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--base`` and ``--package-path``, too."""

    @wraps(command)
    def with_base(*, options: "Options", base: str | None, **others: Any) -> int:
        return command(options=options._replace(base=base or ""), **others)

    return package_path_option(_base_option(with_base))


def reject_descriptions(what: str, paths: Iterable[Path]) -> None:
    """Reject an option or a command that applies to sidecars alone.

    Args:
        what: The option or command, for the message.
        paths: What it was given for.

    Raises:
        click.UsageError: One of the files is a URDF, SDFormat or MJCF.
    """
    from stepbot.pipeline.source_names import is_description

    for path in filter(is_description, paths):
        name = printable(path.name)
        remedy = f"`stepbot init CAD.step --from {name}` drafts a sidecar of a STEP file from it"
        raise click.UsageError(f"{what} needs a sidecar: {name} is a robot description; {remedy}")
