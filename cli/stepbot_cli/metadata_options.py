"""Options for what packages state about a robot's description."""

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


def _maintainer(context: click.Context, option: click.Parameter, given: str | None) -> str:  # noqa: ARG001
    """The name and address of a maintainer."""
    if given is None:
        return ""
    from stepbot.robot.metadata import is_maintainer

    if not is_maintainer(given):
        raise click.BadParameter("expected a name and an address: 'Ada Lovelace <ada@example.com>'")
    return given


_maintainer_option = click.option(
    "--maintainer",
    metavar="'NAME <ADDRESS>'",
    callback=_maintainer,
    help="Maintainer that packages state, instead of the one in SIDECAR.",
)
_license_option = click.option(
    "--license", metavar="NAME", help="Licence that packages state, instead of the one in SIDECAR."
)


def metadata_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--maintainer`` and ``--license`` to the ``options`` that :func:`.reading.reading_options` makes."""

    @wraps(command)
    def with_options(*, options: "Options", maintainer: str, license: str | None, **others: Any) -> int:
        return command(options=options._replace(maintainer=maintainer, license=license or ""), **others)

    return _maintainer_option(_license_option(with_options))
