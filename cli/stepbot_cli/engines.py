"""Options of the commands that start the kernel or an engine."""

from collections.abc import Callable
from typing import Any

import click

from stepbot.isolation import DEFAULT_TIMEOUT

from .sizes import size

require_option = click.option(
    "--require", multiple=True, metavar="ENGINE", help="Make it an error if this engine is absent; may be repeated."
)


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
        type=size,
        metavar="SIZE",
        help="Memory that the kernel may take, such as 4G.  [default: no limit]",
    )
    return timeout(memory(command))
