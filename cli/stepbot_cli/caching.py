"""Options of the commands that cache results."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.cache import DEFAULT_LIMIT, Cache, default_folder

from .sizes import size

SIZE_VARIABLE = "STEPBOT_CACHE_SIZE"

folder_option = click.option(
    "--cache",
    type=click.Path(path_type=Path),
    metavar="DIR",
    envvar="STEPBOT_CACHE",
    help="Cache folder.  [default: stepbot in the user's cache folder]",
)


def cache_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options for the cache."""
    off = click.option("--no-cache", is_flag=True, envvar="STEPBOT_NO_CACHE", help="Disable the cache.")
    return folder_option(off(command))


def opened(folder: Path | None, off: bool = False) -> Cache | None:
    """The cache selected by the options; None if disabled."""
    if off:
        return None
    limit = size(os.environ[SIZE_VARIABLE]) if os.environ.get(SIZE_VARIABLE) else DEFAULT_LIMIT
    return Cache(folder or default_folder(), limit)


def say_trouble(cache: Cache | None, found: Diagnostics) -> None:
    """Add a note if results could not be cached."""
    if cache is not None and cache.trouble:
        found.add("SB006", cache.trouble, Span("stepbot"), help=["choose another folder with `--cache DIR`"])
