"""Base classes and options of all commands; unexpected exceptions become diagnostics."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from itertools import takewhile
from pathlib import Path
from typing import Any

import click

from stepbot.diagnostics import code_to_ignore
from stepbot.runtime.file import exists

from .streams import CannotPrint
from .terminal import Display

PATH = click.Path(path_type=Path)
"""A path as an argument or an option."""


class Command(click.Command):
    """A command whose function returns the exit code."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments; the usage error of a setting that is not an option states where it belongs."""
        given = list(args)
        if words := _formats_apart(args):
            raise click.UsageError(f"formats are separated by commas: `-f {','.join(words)}`", ctx)
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            if place := _place_in_sidecar(error.option_name):
                raise click.UsageError(f"no such option '{error.option_name}'; {place}", ctx) from None
            raise
        except click.UsageError as error:
            has_step = any(parameter.name == "step" for parameter in self.params)
            if has_step and "unexpected extra argument" in error.message and any(map(_is_step, given)):
                remedy = "the sidecar names its STEP file; `--step FILE` reads another one"
                raise click.UsageError(f"{error.message}; {remedy}", ctx) from None
            raise

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; returns its exit code."""
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit, BrokenPipeError, CannotPrint):
            raise
        except Exception as error:  # noqa: BLE001 - reported with its traceback
            from .failures import show_exception

            return show_exception(error, as_json=bool(ctx.params.get("as_json")))


@contextmanager
def usage_errors(kind: type[click.UsageError] = click.BadParameter, before: str = "") -> Iterator[None]:
    """Report a ValueError within the block as invalid arguments; ``before`` is put in front of its message."""
    try:
        yield
    except ValueError as error:
        raise kind(f"{before}{error}") from None


def _place_in_sidecar(option: str) -> str:
    """The place of a setting in the sidecar, for an unknown option of this name; empty if it has none."""
    from stepbot.sidecar.fields import top_level_keys_with  # costs 0.1 s

    key = option.lstrip("-").replace("-", "_")
    places = ", ".join(f"`{name}`" for name in top_level_keys_with(key))
    return f"`{key}` is set in the sidecar, under {places}" if places else ""


def _formats_apart(args: list[str]) -> list[str]:
    """The formats of ``-f urdf mjcf``, which are separated by spaces; empty for any other arguments."""
    option = next((n for n, arg in enumerate(args) if arg in ("-f", "--format")), len(args))
    if not args[option + 2 :]:
        return []
    from stepbot.formats import FORMATS

    known = {name for one in FORMATS.values() for name in (one.name, *one.aliases)}
    apart = list(takewhile(lambda arg: arg.casefold() in known and not exists(Path(arg)), args[option + 2 :]))
    return [args[option + 1], *apart] if apart else []


def _is_step(argument: str) -> bool:
    from stepbot.robot.step_names import is_step_name

    return is_step_name(argument)


def names_option(*declarations: str, **attributes: Any) -> Callable[..., Any]:
    """An option that may be repeated and accepts a comma-separated list."""
    return click.option(*declarations, multiple=True, callback=split_names, **attributes)


def _codes(context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    """Codes of diagnostics to suppress."""
    with usage_errors():
        return tuple(map(code_to_ignore, split_names(context, option, given)))


ignore_option = click.option(
    "--ignore",
    multiple=True,
    callback=_codes,
    metavar="CODE,...",
    help="Do not report warnings and notes of these codes; may be repeated.",
)


def split_names(context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:  # noqa: ARG001
    """The names in an option that may be repeated and accepts comma-separated lists."""
    return tuple(name.strip() for several in given for name in several.split(","))


json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")


def display_options(command: Callable[..., int]) -> Callable[..., int]:
    """Add ``--json`` and the options for verbosity; the command receives them as ``display``."""

    @wraps(command)
    def with_display(*, as_json: bool, concise: bool, verbose: bool, quiet: bool, **others: Any) -> int:
        if verbose and quiet:
            raise click.UsageError("--verbose and --quiet cannot be combined")
        return command(display=Display(concise, verbose, quiet, json=as_json), **others)

    options = (
        json_option,
        click.option("-v", "--verbose", is_flag=True, help="Print full output instead of a summary."),
        click.option("-q", "--quiet", is_flag=True, help="Print errors and warnings only, no results."),
        click.option("--concise", is_flag=True, help="Print one line per diagnostic, and nothing else."),
    )
    decorated: Callable[..., int] = with_display
    for option in reversed(options):
        decorated = option(decorated)
    return decorated
