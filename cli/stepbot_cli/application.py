"""The command group and its exit codes.

Only click is imported for `--version` and `--help`. The module of a command is imported when the command is used.
"""

import atexit
import contextlib
import gc
import importlib
import os
import signal
import sys
import threading
from collections.abc import Sequence
from io import TextIOWrapper
from typing import NoReturn

import click

import stepbot

from .streams import CannotPrint, open_closed_streams

COMMANDS = {
    "init": "Draft a sidecar from a STEP file.",
    "convert": "Write and verify {formats}.",
    "batch": "Convert and verify many robots.",
    "inspect": "Show the contents of a STEP file.",
    "view": "Show a robot in a browser.",
    "watch": "Show robots in a browser, again after each save.",
    "render": "Draw a robot or a STEP file.",
    "collisions": "Show which links can overlap; write an SRDF.",
    "datasheet": "Show reach, payload, inertias and limits.",
    "check": "Check sidecars without writing anything.",
    "lock": "Record shapes, poses and axes, to find CAD changes.",
    "uptodate": "Check that output files are up to date.",
    "verify": "Compare robot files across engines.",
    "drive": "Move a robot in the engines.",
    "diff": "Show what differs between two revisions.",
    "doctor": "Show what works on this machine.",
    "explain": "Explain a diagnostic code.",
    "docs": "Open the documentation.",
    "schema": "Print the JSON Schema of the sidecar.",
    "formats": "List the output formats.",
    "motors": "List or show motors, with their sources.",
    "library": "List, show or export the bundled robots.",
    "cache": "Show or clear the cache.",
}
"""The line of each command in `--help`, in order; each command is the object ``command`` of the module of its name."""

INTERRUPTED = 130
"""Exit code after Ctrl-C."""


class Group(click.Group):
    """A command group that suggests similar commands for unknown ones."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command named by the first argument, or raise a usage error with similar ones."""
        name = args[0]
        if not name.startswith("-") and self.get_command(ctx, name) is None and not ctx.resilient_parsing:
            from stepbot.diagnostics import did_you_mean

            commands = self.list_commands(ctx)
            near = "".join(did_you_mean(name, commands)) or f"choose from {', '.join(commands)}"
            raise click.UsageError(f"unknown command '{name}'; {near}", ctx)
        return super().resolve_command(ctx, args)


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
        command.short_help = _line(cmd_name)  # for completion in shells
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write the list of commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, _line(name)) for name in COMMANDS])


def _line(name: str) -> str:
    """The line of a command, with the titles of the default formats."""
    line = COMMANDS[name]
    if "{formats}" not in line:
        return line
    from stepbot.formats import FORMATS, default_formats

    *others, last = (FORMATS[one].title for one in default_formats())
    return line.format(formats=f"{', '.join(others)} and {last}" if others else last)


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
    """Run ``stepbot`` with arguments, by default those of the process, and return its exit code."""
    open_closed_streams()
    if argv is None:
        _end_by_exit()
    gc.set_threshold(500_000, 20, 20)  # a command creates objects that stay: modules, a robot
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a name in Cyrillic must not raise an exception if the locale is ASCII
            stream.reconfigure(errors="backslashreplace")
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        result = application.main(args=arguments, prog_name="stepbot", standalone_mode=False)
    except click.ClickException as error:
        from .failures import show_usage_error

        return show_usage_error(error, as_json="--json" in arguments)
    except click.Abort:
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except (CannotPrint, OSError) as error:  # click raises the errors of the system
        from .failures import show_exception, show_full_output

        is_full = isinstance(error, CannotPrint) or error.filename is None
        return show_full_output(error) if is_full else show_exception(error, as_json=False)
    except Exception as error:  # noqa: BLE001 - the last place before the user would see a bare traceback
        from .failures import show_exception

        return show_exception(error, as_json=False)
    return result if isinstance(result, int) else 0


def command() -> NoReturn:
    """Run ``stepbot`` as installed, and end the process without freeing what it still holds.

    Freeing takes a fifth of the time of an unchanged `check`. `python -m stepbot` frees it, as profilers require.
    """
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # numpy's, as in workers: another thread would wait, and busily at first
    code = main()
    own = threading.current_thread()
    if all(thread.daemon or thread is own for thread in threading.enumerate()):
        atexit._run_exitfuncs()
        with contextlib.suppress(OSError):  # sys.exit reports it
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    sys.exit(code)


def _end_by_exit() -> None:
    """Have requests to end raise SystemExit until the process ends: the system's way leaves temporary files."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:  # one that is ignored stays ignored
            signal.signal(number, lambda received, _: sys.exit(128 + received))
