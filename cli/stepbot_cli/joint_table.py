"""The joint table: position of every joint, and the evidence for it."""

import sys
from collections.abc import Iterator, Sequence

from stepbot.report.joint_words import direction_words, evidence_words, face_words, point_words, rival_words
from stepbot.robot.joint_table import Basis, JointRow

from .columns import cells
from .diagnostic_text import FRAME_WIDTH, printable
from .terminal import screen_width, write_result

_NARROWEST = 60
_INDENT = "    "


def show_joint_table(rows: Sequence[JointRow], *, verbose: bool = False) -> None:
    """Print the joint table to standard output, as wide as the terminal; nothing without joints."""
    if rows:
        width = screen_width(sys.stdout) or FRAME_WIDTH
        write_result("\n".join(joint_lines(rows, width, verbose=verbose)))


def joint_lines(rows: Sequence[JointRow], width: int, *, verbose: bool = False) -> list[str]:
    """The joint table as lines.

    Args:
        rows: The joints.
        width: Width of the screen, at least 60; only a word longer than a line exceeds it.
        verbose: Whether to name the components whose faces were found, and the other lines.
    """
    width = max(width, _NARROWEST)
    from_file = all(row.evidence.basis is Basis.FILE for row in rows)
    title = "Joints, in the base frame at q = 0:" if from_file else "Joints, as modelled in CAD, in the STEP frame:"
    lines = [title]
    for row in rows:
        mark = "?" if row.evidence.doubt else " "
        name = printable(row.name) or "(unnamed)"
        kind = f"{row.kind} closure" if row.is_closure else row.kind
        head = f"{mark} {name}: {kind}, {printable(row.parent)} -> {printable(row.child)}"
        place, *details = _details(row, verbose=verbose)
        if not verbose and cells(f"{head}, {printable(place)}") <= width:
            head = f"{head}, {printable(place)}"
        else:
            details.insert(0, place)
        lines += _wrapped(head, width)
        for text in details:
            lines += _wrapped(printable(text), width, _INDENT)
    weak = [printable(row.name) for row in rows if row.evidence.doubt]
    if weak:
        lines += _wrapped(f"? {len(weak)} of {len(rows)} on weak evidence: {', '.join(weak)}", width)
    return lines


def _details(row: JointRow, *, verbose: bool) -> Iterator[str]:
    through = "position not reported by any engine" if row.origin is None else point_words(row.origin)
    if row.axis is None:
        yield f"at {through}"
    else:
        second = "" if row.axis2 is None else f" and {direction_words(row.axis2)}"
        yield f"axis {direction_words(row.axis)}{second} through {through}"
    found = evidence_words(row.evidence)
    if found:
        yield found
    if row.evidence.doubt:
        yield f"weak: {row.evidence.doubt}"
    if verbose:
        yield from (f"{face_words(side)}: {side.component}" for side in row.evidence.sides)
        yield from map(rival_words, row.evidence.rivals)


def _wrapped(text: str, width: int, indent: str = "") -> list[str]:
    import textwrap

    return textwrap.wrap(
        text,
        width,
        initial_indent=indent,
        subsequent_indent=f"{indent}{_INDENT}",
        break_long_words=False,
        break_on_hyphens=False,
    )
