"""A progress bar on a terminal, nothing in a pipe."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from .interrupts import interruptible
from .terminal import wants_color

if TYPE_CHECKING:
    from rich.progress import ProgressColumn

BAR_WIDTH = 20
"""Width of a progress bar."""
STAGES = {
    "read": "reading the STEP file",
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
def progress_bar(stages: Sequence[str] = CONVERSION) -> Iterator[Callable[[str], None]]:
    """Yield a function to call at the start of each stage, where Ctrl-C takes effect at the latest.

    Args:
        stages: Stages to expect, of :data:`STAGES`.
    """
    if not sys.stderr.isatty():
        with interruptible() as end_if_interrupted:
            yield lambda stage: end_if_interrupted()
        return

    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    color = wants_color(sys.stderr)
    console = Console(stderr=True, no_color=not color)
    columns = (SpinnerColumn(), bar_column(color), TextColumn("{task.description}"), TimeElapsedColumn())
    with interruptible() as end_if_interrupted, Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=len(stages))

        def begin(stage: str) -> None:
            end_if_interrupted()
            done = stages.index(stage) if stage in stages else None
            bar.update(task, description=STAGES.get(stage, stage), completed=done)

        yield begin


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
