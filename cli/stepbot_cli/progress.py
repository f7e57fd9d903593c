"""What a command is doing and how far it is: a line drawn again on a terminal, elsewhere one every ten seconds."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from .columns import shortened
from .limits import bounded, interruptible
from .terminal import WIDEST_TEXT, screen_width

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options

NO_PROGRESS = "STEPBOT_NO_PROGRESS"
"""Variable that, if set to anything, leaves out the lines in a log, as `-q` does."""
BETWEEN_LINES = 10.0
"""Seconds between two lines in a log, and before the first."""
_REDRAWN = 0.2
"""Seconds between two drawings on a terminal."""
_BAR_WIDTH = 20
_TO_LINE_END = "\x1b[K"
"""Control sequence that erases the rest of a line."""
STAGES = {
    "read": "reading the source",
    "joints": "inferring links and joints",
    "stops": "searching for stops of joints",
    "build": "building the robot",
    "self-collision": "searching self-collisions",
    "write": "writing the formats",
    "verify": "verifying in the engines",
    "save": "saving the files",
    "render": "rendering the picture",
    "drive": "driving the robot",
}
"""Stages, and the text of the bar."""
CONVERSION = ("read", "build", "write", "verify", "save")
"""Stages of a conversion, in order."""


@contextmanager
def progress_bar(
    stages: Sequence[str] = CONVERSION, options: "Options | None" = None
) -> Iterator[Callable[[str], None]]:
    """Yield a function to call at the start of each stage, where Ctrl-C takes effect at the latest.

    Args:
        stages: Stages to expect, of :data:`STAGES`.
        options: Their limits of time, for each stage, and of memory hold for this process, too.
    """
    start, stage = time.monotonic(), ["starting"]

    def text() -> str:
        seconds = f"{time.monotonic() - start:.0f} s"
        return ", ".join(filter(None, (STAGES.get(stage[0], stage[0]), seconds, how_far())))

    def drawn() -> str:
        return f"{bar(stages.index(stage[0]) if stage[0] in stages else 0, len(stages))} {text()}"

    with interruptible() as end_if_interrupted, shown(drawn, text) as draw, bounded(options) as restart:

        def begin(name: str) -> None:
            end_if_interrupted()
            restart()
            stage[0] = name
            draw()

        yield begin


def how_far() -> str:
    """``bodies: 120 of 1000, 14/s, 63 s left``, of the latest work on many inputs in any process; empty for none."""
    from stepbot.runtime.progress import counts

    for count in counts():
        if count.remaining is not None:
            rate = f"{count.per_second:.0f}/s" if count.per_second >= 1.0 else f"{60.0 * count.per_second:.1f}/min"
            return f"{count.work}: {count.done} of {count.total}, {rate}, {count.remaining:.0f} s left"
    return ""


def bar(done: int, total: int) -> str:
    """A bar of two characters."""
    full = int(_BAR_WIDTH * done / total) if total else 0
    return "#" * full + "." * (_BAR_WIDTH - full)


@contextmanager
def shown(drawn: Callable[[], str], logged: Callable[[], str] | None = None) -> Iterator[Callable[[], None]]:
    """Show a line that changes with time; yields a function that draws it at once, on a terminal.

    Args:
        drawn: The line on a terminal, which is erased at the end.
        logged: The line in a log; None for none.
    """
    stream, ended = sys.stderr, threading.Event()
    context = click.get_current_context(silent=True)
    is_quiet = context is not None and context.params.get("quiet", False)
    is_silent = logged is None or is_quiet or bool(os.environ.get(NO_PROGRESS))
    if is_silent and not stream.isatty():
        yield lambda: None
        return

    def draw() -> None:
        if stream.isatty():
            line = shortened(drawn(), (screen_width(stream) or WIDEST_TEXT) - 1)
            print(f"\r{line}{_TO_LINE_END}", end="", file=stream, flush=True)

    def draw_again() -> None:
        while not ended.wait(_REDRAWN if stream.isatty() else BETWEEN_LINES):
            if logged is None or stream.isatty():
                draw()
            else:
                print(f"stepbot: {logged()}", file=stream, flush=True)

    thread = threading.Thread(target=draw_again, name="stepbot-progress", daemon=True)
    thread.start()
    try:
        yield draw
    finally:
        ended.set()
        thread.join()
        if stream.isatty():
            print(f"\r{_TO_LINE_END}", end="", file=stream, flush=True)
