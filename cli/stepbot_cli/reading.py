"""Options of the commands that read STEP files: code page, limits and cache."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .caching import cache_options, opened
from .diagnostic_text import printable
from .engines import limit_options

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


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
