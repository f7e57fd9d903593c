"""Where the command line writes: results to standard output, diagnostics and progress to standard error.

Colour only on a terminal, and none where ``NO_COLOR`` is set (https://no-color.org) or ``TERM`` is ``dumb``.
"""

import json
import os
import sys
from collections.abc import Iterable, Mapping
from typing import Any, TextIO

from stepbot.diagnostics import Diagnostic, Diagnostics

from . import render


def wants_color(stream: TextIO) -> bool:
    """Whether ``stream`` should get colours."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def write_result(text: str) -> None:
    """Print what was asked for."""
    _write(sys.stdout, text)


def write_error(text: str) -> None:
    """Print beside the result."""
    _write(sys.stderr, text)


def write_json(document: Mapping[str, Any]) -> None:
    """Print one JSON document; diagnostics in it are written out."""
    write_result(json.dumps(document, indent=2, ensure_ascii=False, default=_plain))


def show_diagnostics(found: Iterable[Diagnostic], *, concise: bool = False, as_result: bool = False) -> None:
    """Print diagnostics, and how many there are of each severity.

    Args:
        found: What to print.
        concise: One line each.
        as_result: Whether they are what was asked for, and go to standard output.
    """
    diagnostics = list(found)
    if not diagnostics:
        return
    stream = sys.stdout if as_result else sys.stderr
    color = wants_color(stream)
    text = render.concise(diagnostics, color=color) if concise else render.full(diagnostics, color=color)
    _write(stream, text if concise else f"{text}\n\n{render.summary(diagnostics)}")


def _write(stream: TextIO, text: str) -> None:
    stream.write(text if text.endswith("\n") else text + "\n")
    stream.flush()


def _plain(value: object) -> Any:
    if isinstance(value, Diagnostics):
        return [render.plain(diagnostic) for diagnostic in value]
    raise TypeError(f"{type(value).__name__} has no JSON form")
