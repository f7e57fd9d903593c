"""Output of the command line: results to standard output, diagnostics and progress to standard error.

Colour only on a terminal, and not if ``NO_COLOR`` is set (https://no-color.org) or ``TERM`` is ``dumb``.
"""

import json
import os
import sys
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, TextIO

from stepbot.diagnostics import Diagnostic, Diagnostics

from . import diagnostic_text
from .streams import CannotPrint, discard

NARROWEST = 40
"""Minimum width of the screen for layouts."""
WIDEST_TEXT = 100
"""Maximum width of paragraphs."""


def wants_color(stream: TextIO) -> bool:
    """Whether ``stream`` should get colours."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def screen_width(stream: TextIO) -> int | None:
    """Width of the terminal of ``stream``, or ``COLUMNS``; None for a pipe."""
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns):
        return max(int(columns), NARROWEST)
    try:
        return max(os.get_terminal_size(stream.fileno()).columns, NARROWEST)
    except (OSError, ValueError):  # a pipe, or not a file
        return None


def text_width(stream: TextIO) -> int:
    """Width of paragraphs: that of the screen, at most 100, which is easy to read."""
    return min(screen_width(stream) or WIDEST_TEXT, WIDEST_TEXT)


def write_result(text: str) -> None:
    """Print to standard output."""
    _write(sys.stdout, text)


def write_error(text: str) -> None:
    """Print to standard error."""
    _write(sys.stderr, text)


def write_json(document: Mapping[str, Any]) -> None:
    """Print one JSON document; diagnostics in it are written out."""
    from stepbot.report.document import indented

    # Some characters valid in JSON control a terminal: U+009B starts an escape sequence, U+202E reverses text.
    write_result("\n".join(map(_printable, indented(document, _plain).split("\n"))))


def write_document(document: Mapping[str, Any], diagnostics: Diagnostics, exit_code: int | None = None) -> int:
    """Print the results of a command as JSON, with its diagnostics and the exit code, by default theirs; returns it."""
    code = diagnostics.exit_code if exit_code is None else exit_code
    write_json({**document, "diagnostics": diagnostics, "exit_code": code})
    return code


def _printable(line: str) -> str:
    return line if line.isprintable() else "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in line)


class Display(NamedTuple):
    """The verbosity of a command."""

    concise: bool = False
    """One line per diagnostic."""
    verbose: bool = False
    """Full output instead of a summary."""
    quiet: bool = False
    """Errors and warnings only."""
    machine: str = ""
    """The format for another program, of :mod:`.machine_output`; empty for people."""
    json: bool = False
    """One JSON document instead of text."""

    @property
    def shows_results(self) -> bool:
        """Whether results are printed beside diagnostics."""
        return not (self.quiet or self.concise)


_DEFAULT = Display()


def write_verdict(
    subject: str, diagnostics: Iterable[Diagnostic], display: Display, then: str = "", *, stream: TextIO | None = None
) -> bool:
    """Print ``arm: not converted, 3 errors, 1 warning; arm is unchanged``, if there are errors; returns whether it did.

    Args:
        subject: What failed, and how: ``arm: not converted``.
        then: What became of the files; empty if it goes without saying.
        stream: Where to; None for standard output.
    """
    findings = list(diagnostics)
    if not display.shows_results or all(one.severity != "error" for one in findings):
        return False
    from .table import filled

    counts = diagnostic_text.count_of_causes(findings)
    text = f"{subject}{' ' if subject.endswith(':') else ', '}{counts}{f'; {then}' if then else ''}"
    to = stream or sys.stdout
    _write(to, "\n".join(filled(diagnostic_text.printable(text), screen_width(to))))
    return True


def show_diagnostics(
    diagnostics: Iterable[Diagnostic],
    display: Display = _DEFAULT,
    *,
    as_result: bool = False,
    after_verdict: bool = False,
) -> None:
    """Print diagnostics and their numbers, to standard output if they are the command's result.

    Args:
        after_verdict: Whether a verdict has counted errors and warnings already.
    """
    shown = [diagnostic for diagnostic in diagnostics if not (display.quiet and diagnostic.severity == "note")]
    if display.machine:
        from .machine_output import FORMATS

        _write(sys.stdout, FORMATS[display.machine](shown))
        return
    ignored = len(diagnostics.ignored) if isinstance(diagnostics, Diagnostics) and display.shows_results else 0
    if not shown and not ignored:
        return
    stream = sys.stdout if as_result else sys.stderr
    color = wants_color(stream)
    width = screen_width(stream)
    if display.concise:
        _write(stream, diagnostic_text.concise(shown, color=color))
        return
    if display.verbose:
        text = diagnostic_text.full(shown, color=color, width=width or diagnostic_text.FRAME_WIDTH)
        closing = diagnostic_text.summary(shown, ignored=ignored, after_verdict=after_verdict)
        _write(stream, "\n\n".join(filter(None, (text, closing))))
        return
    _write(
        stream,
        diagnostic_text.screen(
            shown, ignored=ignored, color=color, width=width, counts=not display.quiet, after_verdict=after_verdict
        ),
    )


def show_diagnostics_of_use(
    diagnostics: Diagnostics, display: Display, subject: str = "", *, after_verdict: bool = False
) -> None:
    """Print diagnostics of a command that builds a robot to use it, below a verdict if its subject failed.

    Notes about sidecar, STEP file and robot are those of ``check`` and ``convert``; only ``--verbose`` repeats them.
    """
    shown = Diagnostics()
    shown.extend(
        diagnostic
        for diagnostic in diagnostics
        if display.verbose or diagnostic.severity != "note" or not _is_of_conversion(diagnostic.code)
    )
    shown.add_ignored(diagnostics.ignored)
    after_verdict = after_verdict or (bool(subject) and write_verdict(subject, shown, display))
    show_diagnostics(shown, display, after_verdict=after_verdict)


def _is_of_conversion(code: str) -> bool:
    return "SB1" <= code < "SB620" or code.startswith("SB7")


def _write(stream: TextIO, text: str) -> None:
    """Print; what standard error does not take is not reported, and the exit code is still that of the command."""
    try:
        stream.write(text if text.endswith("\n") else text + "\n")
        stream.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        discard(stream)
        if stream is not sys.stderr:
            raise CannotPrint(error.strerror) from error


def _plain(value: object) -> Any:
    if isinstance(value, Diagnostics):
        return [diagnostic_text.plain(diagnostic) for diagnostic in value]
    raise TypeError(f"{type(value).__name__} has no JSON form")
