"""The table of docs/commands.md: time of what users wait for, relative to what anybody can run.

Each line is the median of the ratios of rounds, with the least and the largest, for the working tree and for an earlier
revision, which run in turn on the same files.
"""

import argparse
import re
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines import engines_for
from stepbot.formats import default_formats

from . import contenders as who
from .assemblies import SIDECAR
from .comparison import alternate
from .contenders import ROOT, STEPBOT, Case, Contender
from .gate import Source, source_of
from .instances import write_instances
from .live import seconds_to_page
from .timing import Cost, peak_memory, timed

PAGE = ROOT / "docs" / "commands.md"
_PART = re.compile(r"(<!-- table -->\n).*?(<!-- end -->)", re.DOTALL)
_ROWS = (
    (who.BARE, who.COLD, "first conversion to three formats, not verified (`--no-verify`)"),
    (who.BARE, who.VERIFIED, "the same, verified"),
    (who.BARE, who.EDITED, "after an edit of the sidecar, not verified"),
    (who.BARE, who.EDITED_VERIFIED, "the same, verified"),
    (who.CLICK, who.CHECK, "`check` of an unchanged sidecar"),
)
CaseOf = Callable[[Path, Path], Case]
"""The case of a sidecar, in a folder."""


class Line(Struct, frozen=True):
    """A line of the table: ratios of the working tree and of the revision."""

    what: str
    reference: str
    now: Sequence[float]
    before: Sequence[float]
    elapsed: Sequence[float] = ()
    """Likewise of elapsed times of the working tree, where it differs from processor time."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of the command."""
    parser.add_argument("files", nargs="+", type=Path, metavar="STEP", help="the robot, and others for one line")
    parser.add_argument("--against", required=True, metavar="REVISION", help="an earlier stepbot")
    parser.add_argument("-n", "--rounds", type=int, default=5, metavar="N", help="[default: 5]")
    parser.add_argument("--instances", type=int, default=60, metavar="N", help="0 for none [default: 60]")
    parser.add_argument("--distinct", type=int, default=20, metavar="N", help="0 for none [default: 20]")
    parser.add_argument(
        "--engines", metavar="PYTHON", help="that of an environment with `stepbot[verify,usd]`, for one line more"
    )
    parser.add_argument("--write", action="store_true", help="update the page")


def lines(options: argparse.Namespace, sidecar: Path, folder: Path, case_of: CaseOf) -> Iterator[Line]:
    """Measure all lines, one after the other; those of several files and of many robots in one round.

    Args:
        options: Those of :func:`add_options`.
        sidecar: The robot of most lines.
        folder: For copies and results.
        case_of: Makes the case of a sidecar.
    """
    sources, rounds = (Source("now", ROOT), source_of(options.against, folder / "earlier")), options.rounds
    case = case_of(sidecar, folder / "robot")
    for reference, contender, what in _ROWS:
        yield _line(what, case, reference, contender, sources, rounds)
        if contender is who.VERIFIED and options.engines:
            every = replace(contender, command=lambda one: [options.engines, *who.VERIFIED.command(one)[1:]])
            yield _line("the same with all engines of `stepbot[verify,usd]`", case, reference, every, sources, rounds)
    bare = peak_memory(who.BARE.command(case), case.folder, case.environment)
    peaks = [peak_memory(who.COLD.command(case), case.folder, one.environment(case)) / bare for one in sources]
    yield Line("memory of the first conversion", who.BARE.name, peaks[:1], peaks[1:])
    ofs = [_line("", _plain(step, folder, case_of), who.BARE, who.COLD, sources, 1) for step in options.files[1:]]
    if ofs:
        values = ([one for line in ofs for one in getattr(line, name)] for name in ("now", "before", "elapsed"))
        yield Line(f"first conversion of {len(ofs)} assemblies with one link", who.BARE.name, *values)
    yield _batch(sources, folder)
    seconds = [list(seconds_to_page(case, one.environment(case), rounds)) for one in sources]
    yield Line("from a save to the changed robot in the page of `view --edit`, elapsed", "seconds", *seconds)
    if options.instances:
        yield from _many(case.step, options.instances, sources, folder, case_of)
    if options.distinct:
        yield from _distinct(case.step, options.distinct, sources, folder, case_of)


def _line(
    what: str, case: Case, reference: Contender, contender: Contender, sources: Sequence[Source], rounds: int
) -> Line:
    # What a cache shortens needs a round that fills it, of each revision.
    is_kept = contender.before_all is not who.BARE.before_all
    each = [
        replace(
            contender,
            name=one.name,
            environment={"PYTHONPATH": one.environment(case)["PYTHONPATH"]},
            before_all=who.BARE.before_all,
        )
        for one in sources
    ]
    costs = alternate(case, [reference, *each], rounds, warm_up=is_kept)
    first = costs[reference.name]
    now, before = ([a.cpu / b.cpu for a, b in zip(costs[one.name], first, strict=True)] for one in sources)
    elapsed = [a.wall / b.wall for a, b in zip(costs[sources[0].name], first, strict=True)]
    return Line(what, reference.name, now, before, elapsed)


def _plain(step: Path, folder: Path, case_of: CaseOf) -> Case:
    """A STEP file whose parts are one link."""
    place = folder / "plain" / step.stem
    place.mkdir(parents=True)
    shutil.copy(step, place)
    sidecar = place / f"{step.stem}.robot.yaml"
    sidecar.write_text(SIDECAR.format(step=step.name), encoding="utf-8", newline="\n")
    return case_of(sidecar, folder / "cases")


def _batch(sources: Sequence[Source], folder: Path) -> Line:
    """Each revision's library on two cores, relative to one: what a second process loads again and saves."""
    robots = [{path.parent.name for path in one.root.glob("robot_library/*/*.robot.yaml")} for one in sources]
    names = sorted(set.intersection(*robots))
    ratios = []
    for one in sources:
        place = folder / "batch" / one.name
        for name in names:
            shutil.copytree(one.root / "robot_library" / name, place / "robots" / name)
        case = Case("batch", place, place, place)
        costs = []
        for jobs in (1, 2):
            contender = who.batch(jobs, place / "robots")
            contender.before_each(case)
            costs.append(timed(contender.command(case), place, one.environment(case)))
        ratios.append((costs[1].cpu / costs[0].cpu, costs[1].wall / costs[0].wall))
    (now, elapsed), (before, _) = ratios
    return Line(f"`batch -j 2` of the library, {len(names)} folders", "`batch -j 1`", [now], [before], [elapsed])


def _many(step: Path, count: int, sources: Sequence[Source], folder: Path, case_of: CaseOf) -> Iterator[Line]:
    """Conversion and draft of many instances, relative to those of one."""
    cases = []
    for number in (1, count):
        path = folder / f"instances{number}.step"
        write_instances(step, number, path)
        cases.append(_plain(path, folder, case_of))
    for what, arguments in (("first conversion", ("convert", "-o", "out", "--no-verify")), ("`init`", ("init",))):
        ratios = []
        for one in sources:
            costs = [_cost(case, arguments, one.environment(case)).cpu for case in cases]
            ratios.append([costs[1] / costs[0]])
        yield Line(f"{what} of {count} instances of the robot", "one instance", *ratios)


def _distinct(step: Path, count: int, sources: Sequence[Source], folder: Path, case_of: CaseOf) -> Iterator[Line]:
    """Large assemblies of different parts, relative to the script that reads and meshes them."""
    path = folder / f"distinct{count}.step"
    write_instances(step, count, path, distinct=True)
    case = _plain(path, folder, case_of)
    bare = timed(who.BARE.command(case), case.folder, case.environment)
    for arguments in (("inspect",), ("convert", "-o", "out", "--no-verify"), ("init",)):
        costs = [_cost(case, arguments, one.environment(case)) for one in sources]
        (now,), (before,) = ([cost.cpu / bare.cpu] for cost in costs)
        what = f"`{arguments[0]}` of {count} distinct robots in one file of {path.stat().st_size / 1e6:.0f} MB"
        yield Line(what, who.BARE.name, [now], [before], [costs[0].wall / bare.wall])


def _cost(case: Case, arguments: Sequence[str], environment: Mapping[str, str]) -> Cost:
    name, *options = arguments
    given = {
        "convert": [case.sidecar.name],
        "init": [case.step.name, "-o", "drafted.robot.yaml", "--force"],
        "inspect": [case.step.name],
    }[name]
    return timed([*STEPBOT, name, *given, *options, "--no-cache"], case.folder, environment)


def engines_here() -> str:
    """Names of the engines that verify a conversion to the default formats, without stepbot's own parsers."""
    every = sorted({engine for name in default_formats() for engine in engines_for(name)}, key=lambda one: one.order)
    return ", ".join(one.title or one.name for one in every if not one.own_parser and one.available() is None)


def publish(found: Iterable[Line], conditions: str, *, write: bool) -> None:
    """Print each line when it is there; then update the page."""
    kept = []
    for line in found:
        print(row(line), flush=True)
        kept.append(line)
    if write:
        page = page_with(PAGE.read_text(encoding="utf-8"), table(kept, conditions))
        PAGE.write_text(page, encoding="utf-8", newline="\n")


def row(line: Line) -> str:
    """A line in Markdown."""
    return (
        f"| {line.what} | {line.reference} | {_spread(line.now)} | {_spread(line.before)} | {_spread(line.elapsed)} |"
    )


def table(found: Sequence[Line], conditions: str) -> str:
    """The table in Markdown."""
    heads = ("| | relative to | now | before | elapsed, now |", "| --- | --- | --: | --: | --: |")
    return "\n".join([conditions, "", *heads, *map(row, found), ""])


def page_with(text: str, made: str) -> str:
    """The page with another table."""
    return _PART.sub(lambda match: match[1] + made + match[2], text)


def _spread(values: Sequence[float]) -> str:
    if not values:
        return ""
    if len(values) < 2:
        return f"{values[0]:.2f}"
    return f"{median(values):.2f} ({min(values):.2f}–{max(values):.2f})"
