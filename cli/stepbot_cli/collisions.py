"""``stepbot collisions``: which links of a robot can overlap."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, counted
from stepbot.robot.self_collision import DEFAULT_SAMPLES, MOST_SAMPLES

from .columns import table_lines
from .command import PATH, Command, display_options, ignore_option
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble
from .terminal import Display, show_diagnostics_of_use, write_document, write_result

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.robot.self_collision import PairContact, SelfCollision

_HEADINGS = ("class", "links", "poses", "first overlap")


@click.command(cls=Command, epilog="Example: stepbot collisions arm.robot.yaml --srdf arm.srdf")
@click.argument("target", metavar="TARGET", type=PATH)
@click.option(
    "--samples",
    type=click.IntRange(1, MOST_SAMPLES),
    metavar="N",
    help=f"Number of poses.  [default: that of the sidecar, or {DEFAULT_SAMPLES}]",
)
@click.option(
    "--srdf",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Write an SRDF with the pairs of links that need no collision check.",
)
@click.option("--strict", is_flag=True, help="Turn warnings into errors.")
@ignore_option
@reading_options
@package_path_option
@display_options
def command(options: "Options", target: Path, samples: int | None, srdf: Path | None, display: Display) -> int:
    """Search random poses within the limits of all joints for links whose collision shapes overlap.

    TARGET is a sidecar, or any URDF, SDFormat or MJCF file. Each pair of links is adjacent (connected by a joint), or
    overlaps always, sometimes or never. Loops are closed in every pose. The first pose is the drawn one.

    If a sidecar has the key `self_collision`, `convert` does the same, excludes contacts of pairs that always overlap,
    and writes the SRDF.
    """
    from stepbot.formats.urdf.srdf import srdf as srdf_of
    from stepbot.pipeline.collisions import search
    from stepbot.report.robot import self_collision_document
    from stepbot.runtime.file import write_file

    diagnostics = Diagnostics()
    with progress_bar(("read", "self-collision"), options) as progress:
        progress("read")
        robot = search(target, samples, options, diagnostics, progress)
    if options.strict:
        diagnostics.make_strict()
    if robot is not None and robot.self_collision is not None and srdf is not None and not diagnostics.has_errors:
        content = srdf_of(robot.name, robot.self_collision, robot.source, excluded=robot.excluded_contacts)
        write_file(srdf, content, diagnostics)
    report_trouble(options.cache, diagnostics)
    searched = None if robot is None else robot.self_collision
    if display.json:
        pairs: dict[str, Any] | None = None if searched is None else self_collision_document(searched)
        name = None if robot is None else robot.name
        return write_document({"robot": name, "self_collision": pairs}, diagnostics)
    failed = "not searched" if searched is None else "no SRDF written"
    show_diagnostics_of_use(diagnostics, display, f"{target.as_posix()}: {failed}")
    if robot is not None and searched is not None and display.shows_results:
        write_result("\n".join(_lines(robot.name, searched, verbose=display.verbose)))
    return diagnostics.exit_code


def _lines(name: str, searched: "SelfCollision", *, verbose: bool) -> Iterator[str]:
    from stepbot.robot.self_collision import PairClass

    yield printable(f"{name}: {counted(len(searched.pairs), 'pair')} of links, {searched.samples:,} poses")
    rows = [_HEADINGS]
    for kind in (PairClass.ALWAYS, PairClass.SOMETIMES, PairClass.NEVER, PairClass.ADJACENT):
        pairs = searched.of_class(kind)
        if kind in (PairClass.NEVER, PairClass.ADJACENT) and not verbose:
            rows += [(kind.value, counted(len(pairs), "pair"), "", "")] if pairs else []
            continue
        rows += [_row(pair, searched.samples) for pair in sorted(pairs, key=lambda pair: -pair.contacts)]
    yield from table_lines(rows, None)
    if not verbose and len(rows) > 1:
        yield "-v lists every pair, and the joint positions of each first overlap"
    for pair in searched.pairs if verbose else ():
        if pair.pose:
            positions = ", ".join(f"{joint} {position:.4g}" for joint, position in pair.pose)
            yield printable(f"pose {pair.first}, {pair.link_a} and {pair.link_b}: {positions}")


def _row(pair: "PairContact", samples: int) -> tuple[str, str, str, str]:
    compared = pair.first is not None
    depth = "" if pair.depth is None else f", {pair.depth * 1e3:.3g} mm"
    return (
        pair.kind.value,
        printable(f"{pair.link_a}, {pair.link_b}"),
        f"{pair.contacts:,} ({pair.contacts / samples:.2%})" if compared else "",
        ("drawn pose" if pair.first == 0 else f"pose {pair.first}") + depth if compared else "",
    )
