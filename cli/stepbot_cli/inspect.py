"""``stepbot inspect``: what a STEP file holds, and what a joint can bind to."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .caching import cache_options, opened, say_trouble
from .command import Command, concise_option, json_option
from .encodings import encoding_option
from .engines import limit_options
from .progress import progress_bar
from .terminal import show_diagnostics, write_json, write_result

if TYPE_CHECKING:
    from stepbot.pipeline import Inspection


@click.command(cls=Command, short_help="Show what a STEP file holds.")
@click.argument("step", metavar="STEP", type=click.Path(path_type=Path))
@click.option(
    "--features", is_flag=True, help="List the axis lines of each component, with the origin that means each."
)
@click.option(
    "--between",
    nargs=2,
    metavar="A B",
    help="Show only the axis lines that two components share, and those up to 2 mm apart.",
)
@encoding_option
@limit_options
@cache_options
@json_option
@concise_option
def command(
    step: Path,
    features: bool,
    between: tuple[str, str] | None,
    encoding: str,
    timeout: float,
    memory_limit: int | None,
    cache: Path | None,
    no_cache: bool,
    as_json: bool,
    concise: bool,
) -> int:
    """Show the components of a STEP file: paths to paste into a sidecar, names, solids, volumes, densities.

    STEP may also be a sidecar: then the STEP that it names is shown, and --between takes the names of links too.
    """
    from stepbot.pipeline import Options, inspect

    with progress_bar(("read",)) as progress:
        progress("read")
        options = Options(
            output=Path(),
            encoding=encoding,
            timeout=timeout,
            memory_limit=memory_limit,
            cache=opened(cache, no_cache),
        )
        inspection = inspect(step, options)
    found = inspection.diagnostics
    say_trouble(options.cache, found)
    if as_json:
        write_json({**_document(inspection, between, features), "diagnostics": found, "exit_code": found.exit_code})
    else:
        show_diagnostics(found, concise=concise)
        if inspection.assembly is not None:
            write_result(_text(inspection, between, features))
    return found.exit_code


def _document(inspection: "Inspection", between: tuple[str, str] | None, features: bool) -> dict[str, Any]:
    from .inspection_json import inspection_document, shared_axes_document
    from .shared_axes import shared_axes

    document = inspection_document(inspection, features=features)
    if between and inspection.assembly is not None:
        document["between"] = shared_axes_document(shared_axes(inspection.assembly, inspection.links, *between))
    return document


def _text(inspection: "Inspection", between: tuple[str, str] | None, features: bool) -> str:
    from .inspection_text import inspection_text, shared_axes_text
    from .shared_axes import shared_axes

    if between and inspection.assembly is not None:
        return shared_axes_text(shared_axes(inspection.assembly, inspection.links, *between))
    return inspection_text(inspection, features=features)
