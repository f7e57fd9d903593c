"""Options of the commands that start the kernel or an engine."""

from collections.abc import Callable
from math import isfinite, nan
from typing import Any

import click

from stepbot.runtime.memory import worker_limit
from stepbot.runtime.worker import DEFAULT_TIMEOUT

from .command import names_option
from .sizes import size

require_option = names_option(
    "--require", metavar="ENGINE,...", help="Make it an error if one of these engines is absent; may be repeated."
)


def _limit(text: str) -> int | None:
    """A size, or none at all."""
    return None if text.strip().lower() == "none" else size(text)


def _seconds(text: str) -> float:
    """A time limit [s]."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = nan
    if not (isfinite(seconds) and seconds > 0.0):
        raise click.BadParameter(f"'{text}' is not a number of seconds above 0, such as 600 or 0.5")
    return seconds


def _default_limit() -> str:
    """In the words of the option."""
    return str(worker_limit() or "none")


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add what the worker processes may take."""
    timeout = click.option(
        "--timeout",
        type=_seconds,
        default=DEFAULT_TIMEOUT,
        show_default=True,
        metavar="SECONDS",
        help="Time that the kernel or an engine may take.",
    )
    memory = click.option(
        "--memory-limit",
        type=_limit,
        default=_default_limit,
        metavar="SIZE",
        help="Memory that the kernel or an engine may take, such as 4G, or none.  [default: 3/4 of what there is]",
    )
    return timeout(memory(command))
