"""Options of the commands that start the kernel or an engine."""

from collections.abc import Callable
from typing import Any

import click

from stepbot.isolation import DEFAULT_TIMEOUT
from stepbot.memory import worker_limit

from .sizes import size

require_option = click.option(
    "--require", multiple=True, metavar="ENGINE", help="Make it an error if this engine is absent; may be repeated."
)


def _limit(text: str) -> int | None:
    """A size, or none at all."""
    return None if text.strip().lower() == "none" else size(text)


def _default_limit() -> str:
    """In the words of the option."""
    return str(worker_limit() or "none")


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add what the worker processes may take."""
    timeout = click.option(
        "--timeout",
        type=click.FloatRange(min=0, min_open=True),
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
