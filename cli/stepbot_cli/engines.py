"""Options of the commands that start the kernel or an engine."""

from collections.abc import Callable
from math import isfinite, nan
from typing import Any

import click

from stepbot.runtime.memory import DEFAULT_TIMEOUT, worker_limit

from .command import names_option
from .sizes import size

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
