"""What a command is doing and how far it is: a bar on a terminal, elsewhere a line every ten seconds."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from .interrupts import interruptible
from .limits import bounded
from .terminal import wants_color

if TYPE_CHECKING:
    from rich.progress import ProgressColumn

    from stepbot.pipeline.conversion import Options

NO_PROGRESS = "STEPBOT_NO_PROGRESS"
"""Variable that, if set to anything, leaves out the lines in a log, as `-q` does."""
BETWEEN_LINES = 10.0
"""Seconds between two lines in a log, and before the first."""
BAR_WIDTH = 20
"""Width of a progress bar."""
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
    if not sys.stderr.isatty():
        with interruptible() as end_if_interrupted, _lines() as line, bounded(options) as restart:

            def begin_line(stage: str) -> None:
                end_if_interrupted()
                restart()
                line(stage)

            yield begin_line
        return

    from rich.console import Console
    from rich.progress import Progress, ProgressColumn, SpinnerColumn, Task, TextColumn, TimeElapsedColumn
    from rich.text import Text

    color = wants_color(sys.stderr)
    console = Console(stderr=True, no_color=not color)

    class How(ProgressColumn):
        """How far the stage is."""

        def render(self, _task: Task) -> Text:
            return Text(how_far())

    columns = (SpinnerColumn(), bar_column(color), TextColumn("{task.description}"), How(), TimeElapsedColumn())
    shown = Progress(*columns, console=console, transient=True)
    with interruptible() as end_if_interrupted, shown as bar, bounded(options) as restart:
        task = bar.add_task("starting", total=len(stages))

        def begin(stage: str) -> None:
            end_if_interrupted()
            restart()
            done = stages.index(stage) if stage in stages else None
            bar.update(task, description=STAGES.get(stage, stage), completed=done)

        yield begin


def how_far() -> str:
    """``bodies: 120 of 1000, 14/s, 63 s left``, of the latest work on many inputs in any process; empty for none."""
    from stepbot.runtime.progress import counts

    for count in counts():
        if count.remaining is not None:
            rate = f"{count.per_second:.0f}/s" if count.per_second >= 1.0 else f"{60.0 * count.per_second:.1f}/min"
            return f"{count.work}: {count.done} of {count.total}, {rate}, {count.remaining:.0f} s left"
    return ""


@contextmanager
def _lines() -> Iterator[Callable[[str], None]]:
    """Yield a function to call at the start of each stage; a command that takes long prints where it is."""
    start, stage, ended = time.monotonic(), ["starting"], threading.Event()

    def begin(name: str) -> None:
        stage[0] = STAGES.get(name, name)

    def write() -> None:
        while not ended.wait(BETWEEN_LINES):
            seconds = f"{time.monotonic() - start:.0f} s"
            print(f"stepbot: {', '.join(filter(None, (stage[0], seconds, how_far())))}", file=sys.stderr, flush=True)

    context = click.get_current_context(silent=True)
    display = context.params.get("display") if context else None
    if os.environ.get(NO_PROGRESS) or getattr(display, "quiet", False):
        yield begin
        return
    thread = threading.Thread(target=write, name="stepbot-progress", daemon=True)
    thread.start()
    try:
        yield begin
    finally:
        ended.set()
        thread.join()


def bar_column(color: bool) -> "ProgressColumn":
    """The bar itself; rich's own distinguishes done from remaining by colour only."""
    from rich.progress import BarColumn, ProgressColumn, Task
    from rich.text import Text

    if color:
        return BarColumn(BAR_WIDTH)

    class PlainBar(ProgressColumn):
        """A bar of two characters."""

        def render(self, task: Task) -> Text:
            done = int(BAR_WIDTH * (task.completed / task.total if task.total else 0.0))
            return Text("#" * done + "." * (BAR_WIDTH - done))

    return PlainBar()
