"""The curves of drive tests as SVG, drawn with matplotlib: the same bytes from the same numbers."""

from pathlib import Path
from typing import Any

from stepbot.runtime.file import replace_file

from .driving import Driven
from .judgement import Verdict
from .results import Plot

PACKAGE = "matplotlib"
"""Part of ``pip install 'stepbot[draw]'``."""
_COLORS = ("#1f6feb", "#d1672b", "#2c8c4b", "#8a4fbf", "#b0323d", "#66788a", "#b48a00", "#1b8a99")
_SIZE = (7.2, 2.6)
_MOST_NAMED = 8
"""Curves up to which each has its name in the axes."""
_STYLE = {
    "svg.hashsalt": "stepbot",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 8,
    "path.simplify": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
}
_NO_METADATA = {"Date": None, "Creator": None}


def draw(driven: Driven, folder: Path) -> list[Path]:
    """Write one picture per test, an engine beside the other; returns the paths.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for test, verdicts in _by_test(driven).items():
        path = folder / f"{test}.svg"
        replace_file(path, _svg([verdicts]))
        paths.append(path)
    return paths


def sheet(driven: Driven) -> bytes:
    """All tests in one picture: a row per test, a column per engine."""
    return _svg(list(_by_test(driven).values()))


def _by_test(driven: Driven) -> dict[str, list[Verdict]]:
    verdicts: dict[str, list[Verdict]] = {}
    for verdict in driven.verdicts:
        if verdict.result is not None:
            verdicts.setdefault(verdict.test, []).append(verdict)
    return verdicts


def _svg(rows: list[list[Verdict]]) -> bytes:
    """The curves of tests, each in a row."""
    from io import BytesIO

    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    columns = max(map(len, rows), default=1)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(_SIZE[0], _SIZE[1] * max(1, len(rows))), layout="constrained")
        FigureCanvasSVG(figure)
        for number, verdicts in enumerate(rows):
            first = None
            for column, verdict in enumerate(verdicts):
                axes = figure.add_subplot(len(rows), columns, number * columns + column + 1, sharey=first)
                assert verdict.result is not None
                _panel(axes, verdict.result.plot, f"{verdict.test}, {verdict.engine}: {verdict.status.value}")
                if first is None:
                    first = axes
                    axes.set_ylabel(verdict.result.plot.y)
                    if 1 < len(verdict.result.plot.curves) <= _MOST_NAMED:
                        axes.legend(fontsize=6, frameon=False)
        stream = BytesIO()
        figure.savefig(stream, format="svg", metadata=_NO_METADATA)
    return stream.getvalue()


def _panel(axes: Any, plot: Plot, title: str) -> None:
    for number, (name, (x, y)) in enumerate(plot.curves.items()):
        rounded = [float(f"{value:.4g}") for value in y]  # the same picture where an engine's last bits differ
        axes.plot(x, rounded, color=_COLORS[number % len(_COLORS)], linewidth=1.1, label=name)
    axes.set_title(title, fontsize=8, loc="left")
    axes.set_xlabel(plot.x)
    axes.grid(True, linewidth=0.4, color="#dde3ea")
