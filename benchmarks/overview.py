"""Results of one comparison over several files: tables with a row per file, and a picture. Nothing is measured here."""

from collections.abc import Callable, Iterable, Mapping
from io import BytesIO
from statistics import median

from msgspec import Struct

from .comparison import Quartiles, Row

PICTURE = "performance.svg"
_COLORS = ("#1f6feb", "#d1672b", "#2c8c4b", "#8a4fbf", "#66788a", "#b0323d", "#b48a00")
_WIDTH = 7.2
"""[inch]."""
_STYLE = {
    "svg.hashsalt": "stepbot",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
}

Results = Mapping[str, list[Row]]
"""The rows of each file, the first contender first."""


class _Quantity(Struct, frozen=True):
    """One table: a number of the first contender in its unit, and ratios to it."""

    title: str
    unit: str
    value: Callable[[Row], float | None]
    ratio: Callable[[Row, Row], float | None]
    """Of a row and the first one."""
    quartiles: Callable[[Row], Quartiles | None] = lambda row: None


def _memory_ratio(row: Row, first: Row) -> float | None:
    return None if row.memory is None or first.memory is None else row.memory / first.memory


_QUANTITIES = (
    _Quantity("Elapsed time", "s", lambda r: r.wall, lambda r, _: r.wall_ratio, lambda r: r.wall_quartiles),
    _Quantity("Processor time", "s", lambda r: r.cpu, lambda r, _: r.cpu_ratio),
    _Quantity("Peak memory", "MiB", lambda r: r.memory, _memory_ratio),
)


def tables(results: Results) -> str:
    """A table each of elapsed time, processor time and memory: ratios to the first contender, and their medians.

    A median is of all files; a contender that was not measured on one of them has none.
    """
    measured = [one for one in _QUANTITIES if any(one.value(rows[0]) is not None for rows in results.values())]
    return "\n".join(f"{one.title}:\n\n{_table(results, one)}\n" for one in measured)


def _table(results: Results, quantity: _Quantity) -> str:
    first, *others = _contenders(results)
    lines = [f"| | {first} | {' | '.join(others)} |", f"| --- | --: | {' | '.join('--:' for _ in others)} |"]
    found: dict[str, list[float]] = {name: [] for name in others}
    for case, rows in results.items():
        by_name = {row.contender: row for row in rows}
        amount = quantity.value(rows[0])
        cells = ["-" if amount is None else f"{amount:.{2 if quantity.unit == 's' else 0}f} {quantity.unit}"]
        for name in others:
            row = by_name.get(name)
            ratio = None if row is None else quantity.ratio(row, rows[0])
            if row is None or ratio is None:
                cells.append("-")
                continue
            found[name].append(ratio)
            cells.append(f"{ratio:.2f}{_spread(quantity.quartiles(row))}")
        lines.append(f"| `{case}` | {' | '.join(cells)} |")
    if len(results) > 1:
        medians = (f"**{median(own):.2f}**" if len(own) == len(results) else "-" for own in found.values())
        lines.append(f"| **median** | | {' | '.join(medians)} |")
    return "\n".join(lines)


def _spread(quartiles: Quartiles | None) -> str:
    return "" if quartiles is None else f" ({quartiles[0]:.2f}–{quartiles[1]:.2f})"


def _contenders(results: Results) -> list[str]:
    return list(dict.fromkeys(row.contender for rows in results.values() for row in rows))


def picture(results: Results) -> bytes:
    """The ratios of elapsed times as SVG: a line per file, a dot per contender with its quartiles.

    Raises:
        ModuleNotFoundError: matplotlib is not installed.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    first, *others = _contenders(results)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(_WIDTH, 1.4 + 0.32 * len(results)), layout="constrained")
        axes = figure.add_subplot()
        for number, name in enumerate(others):
            own = [(y, row) for y, rows in enumerate(results.values()) for row in rows if row.contender == name]
            shift = 0.5 * (number - (len(others) - 1) / 2) / max(len(others), 1)
            ratios = [row.wall_ratio for _, row in own]
            spread = [row.wall_quartiles or (row.wall_ratio, row.wall_ratio) for _, row in own]
            axes.errorbar(
                ratios,
                [y + shift for y, _ in own],
                xerr=[
                    [max(ratio - low, 0.0) for ratio, (low, _) in zip(ratios, spread, strict=True)],
                    [max(high - ratio, 0.0) for ratio, (_, high) in zip(ratios, spread, strict=True)],
                ],
                fmt="o",
                markersize=3.5,
                elinewidth=1.0,
                color=_COLORS[number % len(_COLORS)],
                label=name,
            )
        axes.axvline(1.0, color="#66788a", linewidth=0.8)
        axes.set_xscale("log")
        ticks = [tick for tick in (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0) if _is_near(tick, results)]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        axes.set_yticks(range(len(results)), list(results))
        axes.invert_yaxis()
        axes.grid(axis="x", linewidth=0.3)
        axes.set_xlabel(f"elapsed time / that of the {first}; median and quartiles of the rounds")
        figure.legend(loc="outside upper center", ncols=3, frameon=False)
        written = BytesIO()
        FigureCanvasSVG(figure).print_svg(written, metadata={"Date": None, "Creator": None})
    return written.getvalue()


def _is_near(tick: float, results: Results) -> bool:
    ratios = _ratios(results.values())
    return min(ratios) / 2.0 < tick < max(ratios) * 2.0


def _ratios(results: Iterable[list[Row]]) -> list[float]:
    return [row.wall_ratio for rows in results for row in rows]
