"""Options of the commands that keep results."""

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
    help="Folder to keep results in.  [default: stepbot's in the user's cache folder]",
)


def cache_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add where results are kept, or whether."""
    off = click.option("--no-cache", is_flag=True, envvar="STEPBOT_NO_CACHE", help="Compute everything anew.")
    return folder_option(off(command))


def opened(folder: Path | None, off: bool = False) -> Cache | None:
    """The cache that the options ask for; None where they ask for none."""
    if off:
        return None
    limit = size(os.environ[SIZE_VARIABLE]) if os.environ.get(SIZE_VARIABLE) else DEFAULT_LIMIT
    return Cache(folder or default_folder(), limit)


def say_trouble(cache: Cache | None, found: Diagnostics) -> None:
    """Add a note where results could not be kept."""
    if cache is not None and cache.trouble:
        found.add("SB006", cache.trouble, Span("stepbot"), help=["`--cache DIR` names another folder"])
