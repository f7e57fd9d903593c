"""Options that several commands share: code page, limits and cache of the STEP; engines; data of the package."""

from collections.abc import Callable
from functools import wraps
from math import isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.runtime.memory import DEFAULT_TIMEOUT, worker_limit

from .caching import cache_options, opened, size
from .command import names_option
from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


require_option = names_option(
    "--require", metavar="ENGINE,...", help="Report an error if one of these engines is not installed; may be repeated."
)


def _limit(text: str) -> int | None:
    """A size, or ``none``."""
    return None if text.strip().lower() == "none" else size(text)


def _seconds(text: str) -> float:
    """A time limit [s]."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = nan
    if not (isfinite(seconds) and seconds > 0.0):
        raise click.BadParameter(f"'{text}' is not a positive number of seconds, such as 600 or 0.5")
    return seconds


def _default_limit() -> str:
    """In the format of the option."""
    return str(worker_limit() or "none")


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the limits of the worker processes."""
    timeout = click.option(
        "--timeout",
        type=_seconds,
        default=DEFAULT_TIMEOUT,
        show_default=True,
        metavar="SECONDS",
        help="Time limit for the geometry kernel, more for STEP files above 30 MB, for each engine, and for the "
        "processor time of the command itself.",
    )
    memory = click.option(
        "--memory-limit",
        type=_limit,
        default=_default_limit,
        metavar="SIZE",
        help="Memory limit for the geometry kernel, each engine and the command itself, such as 4G, or none.  "
        "[default: 3/4 of RAM]",
    )
    return timeout(memory(command))


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


def _code_page(name: str) -> str:
    if not name:
        return ""
    from stepbot.sidecar.text import UnknownCodePage, code_page

    try:
        return code_page(name)
    except UnknownCodePage as failure:
        raise click.BadParameter("; ".join((str(failure), *failure.hints))) from None


encoding_option = click.option(
    "--encoding",
    type=_code_page,
    default="",
    metavar="CODEPAGE",
    help="Code page of names in the STEP file that are neither ASCII nor UTF-8, such as cp1251 or gbk.",
)


def working_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add the limits of workers and the cache; the command receives both as ``options`` and adds its own."""

    @wraps(command)
    def with_options(
        *,
        timeout: float,
        memory_limit: int | None,
        cache: Path | None,
        no_cache: bool,
        encoding: str = "",
        **others: Any,
    ) -> int:
        from stepbot.pipeline.conversion import Options

        options = Options(
            output=Path(),
            encoding=encoding,
            timeout=timeout,
            memory_limit=memory_limit,
            cache=opened(cache, no_cache),
        )
        return command(options=options, **others)

    return limit_options(cache_options(with_options))


def variant_option(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--variant`` to the ``options`` that :func:`reading_options` makes."""

    @wraps(command)
    def with_variant(*, options: "Options", variant: str, **others: Any) -> int:
        named = next(others[key] for key in ("sidecar", "sidecars", "target", "step") if key in others)
        for path in named if isinstance(named, tuple) else (named,):
            if variant and path.suffix.lower() not in (".yaml", ".yml") and not path.is_dir():
                raise click.UsageError(f"--variant needs a sidecar, and {printable(path.name)} is none")
        if variant and others.get("edit"):
            raise click.UsageError("--variant cannot be edited: the page writes the sidecar as it is")
        return command(options=options._replace(variant=variant), **others)

    help = "Variant of the sidecar, by its name under `variants`."
    return click.option("--variant", default="", metavar="NAME", help=help)(with_variant)


def reading_options(command: Callable[..., int]) -> Callable[..., int]:
    """The same, and the code page of STEP files."""
    return encoding_option(working_options(command))
