"""The command group and its exit codes.

The module of a command is imported on demand, and imports only click before the command runs.
"""

import importlib
import sys
from collections.abc import Sequence
from io import TextIOWrapper

import click

import stepbot

from .command import Group
from .failures import show_exception, show_usage_error

COMMANDS = (
    "init",
    "convert",
    "batch",
    "inspect",
    "view",
    "watch",
    "render",
    "collisions",
    "check",
    "lock",
    "uptodate",
    "verify",
    "drive",
    "diff",
    "explain",
    "schema",
    "formats",
    "library",
    "cache",
)
"""In the order of `--help`; each is the object ``command`` of the module of the same name."""

INTERRUPTED = 130
"""Exit code after Ctrl-C."""


class Commands(Group):
    """Loads each command from the module of the same name."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """All commands, in the order of a typical workflow."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """The command of this name, or None."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"{__package__}.{cmd_name}").command
        return command


@click.command(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Example: stepbot convert arm.robot.yaml -o arm\n\n"
    "Exit codes: 0 clean, 1 findings, 2 could not run (bad option, missing file, missing package), 130 interrupted.",
)
@click.version_option(stepbot.__version__, prog_name="stepbot")
def application() -> None:
    """Convert a STEP assembly and a YAML sidecar to URDF, SDFormat and MJCF, and verify the files.

    Results are written to standard output, diagnostics and progress to standard error. The results of `check` are
    diagnostics.
    """


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``stepbot`` and return its exit code.

    Args:
        argv: Arguments without the program name; default ``sys.argv[1:]``.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a name in Cyrillic must not raise an exception if the locale is ASCII
            stream.reconfigure(errors="backslashreplace")
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        result = application.main(args=arguments, prog_name="stepbot", standalone_mode=False)
    except click.ClickException as error:
        return show_usage_error(error, as_json="--json" in arguments)
    except click.Abort:
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except Exception as error:  # noqa: BLE001 - the last place before the user would see a bare traceback
        return show_exception(error, as_json=False)
    return result if isinstance(result, int) else 0
