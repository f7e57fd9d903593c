"""``stepbot schema``: the JSON Schema of the sidecar."""

import click

from .command import Command
from .terminal import write_result


@click.command(
    cls=Command,
    short_help="Print the JSON Schema of the sidecar.",
    epilog="Example: stepbot schema > robot-1.schema.json",
)
def command() -> int:
    """Print the JSON Schema of the sidecar, for editors and scripts."""
    from stepbot.sidecar.schema import schema_text

    write_result(schema_text())
    return 0
