"""Options of the commands that cache results."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from stepbot.diagnostics import Diagnostics, Span
from stepbot.runtime.cache import DEFAULT_LIMIT, Cache, default_folder

_SIZE = re.compile(r"(?P<number>\d+(?:\.\d+)?)\s*(?P<prefix>[KMGT]?)i?B?", re.IGNORECASE)
_FACTORS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def size(text: str) -> int:
    """Bytes, from a number with an optional binary prefix.

    Raises:
        click.BadParameter: The text is not a size.
    """
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise click.BadParameter(f"'{text}' is not a size such as 4G or 500M")
    return int(float(match["number"]) * _FACTORS[match["prefix"].upper()])


def in_words(count: int) -> str:
    """A size with a unit prefix: ``1.4 GiB``."""
    amount, unit = float(count), "B"
    for larger in ("KiB", "MiB", "GiB", "TiB"):
        if amount < 1024.0:
            break
        amount, unit = amount / 1024.0, larger
    return f"{amount:.1f} {unit}" if unit != "B" else f"{count} B"


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
