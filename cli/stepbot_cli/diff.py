"""``stepbot diff``: what differs between two STEP files, two sidecars, or two robots."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from msgspec.structs import asdict

from stepbot.diagnostics import Diagnostic, Diagnostics, Span, counted
from stepbot.runtime.file import exists, is_folder

from .columns import wrapped_rows
from .command import PATH, Command, display_options
from .diagnostic_text import paint, printable
from .machine_output import output_format_option
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble
from .terminal import Display, screen_width, show_diagnostics, wants_color, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options
    from stepbot.pipeline.differences import Differences
    from stepbot.revisions.differences import Difference

SAME, DIFFERENT, COULD_NOT_RUN = 0, 1, 2
"""Exit codes."""
_OF_STEPS = {
    "renamed": "SB314",
    "probably renamed": "SB311",
    "removed": "SB316:lost",
    "added": "SB316:gained",
    "moved": "SB318:pose",
    "reshaped": "SB318:shape",
    "material": "SB318:shape",
}
"""Codes of differences of STEP files in the output for other programs; those of robots have the code of `verify`."""
_STEP = (".step", ".stp", ".p21", ".stpz")
_SIDECAR = (".yaml", ".yml")
_OF_ROBOTS = "SB803"
_SINGLE_SHAPE = "box of "
"""Beginning of the names of differences in one visual or collision."""
_HEADINGS = ("difference", "what", "how")


@click.command(
    cls=Command,
    epilog="Example: stepbot diff arm_v1.step arm_v2.step\n\nExit codes: 0 same, 1 different, 2 could not run.",
)
@click.argument("old", type=PATH)
@click.argument("new", type=PATH)
@click.option("--markdown", is_flag=True, help="Print a table in Markdown, for a comment on a pull request.")
@reading_options
@package_path_option
@display_options
@output_format_option
def command(options: "Options", old: Path, new: Path, markdown: bool, display: Display) -> int:
    """Compare two STEP files, two sidecars, or two robots (output folders, or URDF, SDFormat or MJCF files).

    Components of STEP files are matched by shape and pose, not by name or order. Sidecars are compared by the robots
    that they describe, variants included: links, joints, limits, masses, frames. Robot files are compared as engines
    load them.
    """
    diagnostics = Diagnostics()
    kind = _kind(old, new)
    with progress_bar(("read",), options) as progress:
        progress("read")
        differences = _compared(kind, old, new, options, diagnostics)
    report_trouble(options.cache, diagnostics)
    exit_code = _exit_code(differences, diagnostics)
    if display.json:
        rows = [] if differences is None else [_record(row) for row in map(asdict, differences.rows)]
        document = {"kind": kind, "old": old.as_posix(), "new": new.as_posix(), "differences": rows}
        return write_document(document, diagnostics, exit_code)
    if display.machine:
        diagnostics.extend(_annotation(row, new) for row in (differences.rows if differences is not None else ()))
        show_diagnostics(diagnostics, display)
        return exit_code
    subject = f"{new.as_posix()}: not compared with {old.as_posix()}" if differences is None else "compared in part"
    show_diagnostics(
        diagnostics, display, after_verdict=write_verdict(subject, diagnostics, display, stream=sys.stderr)
    )
    if differences is not None and markdown:
        write_result(_markdown(differences))
    elif differences is not None and not display.quiet:
        write_result("\n".join(_lines(differences, display)))
    return exit_code


def _annotation(row: "Difference", new: Path) -> Diagnostic:
    """A difference as a finding about the new file."""
    code = _OF_STEPS.get(row.kind, _OF_ROBOTS)
    return Diagnostic(code, "warning", ": ".join(filter(None, _cells(row))), Span(new.as_posix()))


def _markdown(differences: "Differences") -> str:
    """A heading and a table of differences, with the old and the new value of those that have one."""
    rows, names = differences.rows, f"`{printable(differences.old)}` and `{printable(differences.new)}`"
    if not rows:
        return f"**No differences** between {names}."
    lines = [f"**{counted(len(rows), 'difference')}** between {names}", "", "| difference | what | old | new | how |"]
    lines.append("| --- | --- | ---: | ---: | --- |")
    for row in rows:
        kind, name, how = (printable(cell).replace("|", "\\|") for cell in _cells(row))
        old, new = (f"{value:.6g} {row.unit}".strip() if value is not None else "" for value in (row.old, row.new))
        lines.append(f"| {kind} | {name} | {old} | {new} | {how} |")
    return "\n".join(lines)


def _exit_code(differences: "Differences | None", diagnostics: Diagnostics) -> int:
    if differences is None or diagnostics.has_errors:
        return COULD_NOT_RUN
    if differences.rows:
        return DIFFERENT
    return SAME if differences.complete else COULD_NOT_RUN


def _kind(old: Path, new: Path) -> str:
    """The type of both: ``step``, ``sidecar`` or ``robot``. A missing path without a suffix has that of the other."""
    kinds = []
    for path in (old, new):
        suffix = path.suffix.lower()
        if not (suffix or exists(path)):
            continue
        is_step, is_sidecar = suffix in _STEP, suffix in _SIDECAR
        kinds.append("robot" if is_folder(path) else "step" if is_step else "sidecar" if is_sidecar else "robot")
    if len(set(kinds)) > 1:
        raise click.UsageError(f"cannot compare a {kinds[0]} with a {kinds[1]}: '{old}' and '{new}'")
    return kinds[0] if kinds else "robot"


def _compared(kind: str, old: Path, new: Path, options: "Options", diagnostics: Diagnostics) -> "Differences | None":
    from stepbot.pipeline.differences import differing_robots, differing_sidecars, differing_steps, robot_files

    if kind == "step":
        return differing_steps(old, new, options, diagnostics)
    if kind == "sidecar":
        return differing_sidecars(old, new, options, diagnostics)
    files = robot_files(old, new, diagnostics)
    return None if files is None else differing_robots(*files, options, diagnostics)


def _record(row: dict[str, Any]) -> dict[str, Any]:
    """A difference without empty fields."""
    return {key: value for key, value in row.items() if value not in (None, "")}


def _lines(differences: "Differences", display: Display) -> list[str]:
    rows = differences.rows
    if display.concise:
        return [printable(": ".join(filter(None, cells))) for cells in map(_cells, rows)]
    names = f"{printable(differences.old)} and {printable(differences.new)}"
    if not rows:
        where = "" if differences.complete else " in what was compared"
        return [f"no differences{where} between {names}"]
    color = wants_color(sys.stdout)
    of_links = set() if display.verbose else {row.name for row in rows}
    listed = [row for row in rows if _link_box(row.name) not in of_links]
    table: Sequence[Sequence[str]] = [_HEADINGS, *(tuple(map(printable, _cells(row))) for row in listed)]
    head, *body = wrapped_rows(table, screen_width(sys.stdout))
    lines = [paint("  ".join(cells).rstrip(), "1", color) for cells in head]
    lines += ["  ".join(cells).rstrip() for of_row in body for cells in of_row]
    single = len(rows) - len(listed)
    hidden = f", {single} of single shapes (-v lists them)" if single else ""
    return [*lines, f"{counted(len(rows), 'difference')} between {names}{hidden}"]


def _link_box(name: str) -> str:
    """Of a difference in the box of one visual or collision, the name of the same in its link; empty of others."""
    if not name.startswith(_SINGLE_SHAPE):
        return ""
    kind, _, link = name.removeprefix(_SINGLE_SHAPE).partition(" of link ")
    return f"{kind.partition(' ')[0]} box of link {link}"


def _cells(row: Any) -> tuple[str, str, str]:
    name = f"{row.name} -> {row.new_name}" if row.new_name else row.name
    return row.kind, name, row.detail
