"""What every command has in common: an unforeseen exception becomes a diagnostic, in JSON where JSON was asked for."""

from typing import Any

import click

from .failures import show_exception


class Command(click.Command):
    """A command whose function returns the exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; returns its exit code."""
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit, BrokenPipeError):
            raise
        except Exception as error:  # noqa: BLE001 - reported with its traceback
            return show_exception(error, as_json=bool(ctx.params.get("as_json")))


json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
concise_option = click.option("--concise", is_flag=True, help="One line per finding, without code frame and help.")
