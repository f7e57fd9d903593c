"""Reports exceptions as diagnostics, with a traceback for bug reports."""

import io
import sys
import traceback

import click

from stepbot.diagnostics import Diagnostics, ExitCode, Span, StepbotError

from .diagnostic_text import printable
from .streams import discard
from .terminal import show_diagnostics, write_document, write_error

_OURS = ("stepbot", "stepbot_cli")
_EXTRAS = {"dask": "dask", "distributed": "dask", "embreex": "render", "PIL": "render", "scipy": "render"}
"""Packages that are installed with an extra of stepbot, and its name."""


def show_exception(error: Exception, *, as_json: bool) -> ExitCode:
    """Report an exception that ended a command; returns the exit code."""
    diagnostics = error.diagnostics if isinstance(error, StepbotError) else Diagnostics()
    if isinstance(error, ModuleNotFoundError) and error.name and error.name.partition(".")[0] not in _OURS:
        package = error.name.partition(".")[0]
        extra = _EXTRAS.get(package)
        help = [f"pip install 'stepbot[{extra}]'" if extra else f"pip install {package}"]
        diagnostics.add("SB003", f"Python package missing: no module named '{package}'", Span("stepbot"), help=help)
    elif not isinstance(error, StepbotError):
        write_error("".join(traceback.format_exception(error)))
        _add_internal_error(error, diagnostics)
    if as_json:
        write_document({}, diagnostics)
    else:
        show_diagnostics(diagnostics)
    return diagnostics.exit_code


def show_usage_error(error: click.ClickException, *, as_json: bool) -> ExitCode:
    """Report invalid arguments; returns the exit code."""
    if not as_json:
        text = io.StringIO()
        error.show(text)
        write_error(printable(text.getvalue()))  # it may be an argument, or contained in a file
        return 2
    context = error.ctx if isinstance(error, click.UsageError) else None
    command = context.command_path if context is not None else "stepbot"
    diagnostics = Diagnostics()
    diagnostics.add("SB010", error.format_message(), Span(command), help=[f"`{command} --help`"])
    write_document({}, diagnostics)
    return diagnostics.exit_code


def show_full_output(error: Exception) -> ExitCode:
    """Report that results could not be printed; returns the exit code."""
    discard(sys.stdout)
    diagnostics = Diagnostics()
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    help = ["the command has run; repeat it with another standard output for its results"]
    diagnostics.add("SB004", f"cannot write to standard output: {reason}", Span("stepbot"), help=help)
    show_diagnostics(diagnostics)
    return diagnostics.exit_code


def _add_internal_error(error: Exception, diagnostics: Diagnostics) -> None:
    frames = traceback.extract_tb(error.__traceback__)
    place = [f"in {frames[-1].name}, line {frames[-1].lineno} of {_file_name(frames[-1].filename)}"] if frames else []
    first_line = (str(error).splitlines() or [""])[0]
    diagnostics.add(
        "SB901",
        f"internal error: {type(error).__name__}: {first_line}".rstrip(": "),
        Span("stepbot"),
        help=["please report a bug with the traceback above, the sidecar and the STEP file"],
        notes=place,
    )


def _file_name(path: str) -> str:
    return path.replace("\\", "/").rpartition("/")[2]
