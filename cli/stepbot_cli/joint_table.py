"""The joint table: position of every joint, and the evidence for it."""

import textwrap
from collections.abc import Iterator, Sequence
from shutil import get_terminal_size

from stepbot.robot.joint_table import Basis, Evidence, JointRow, Rival, Side, Vector3

from .columns import cells
from .diagnostic_text import printable
from .terminal import write_result

_NARROWEST = 60
_ALONG = 1e-6
"""Largest component of a direction along another axis at which it still counts as axis-aligned."""
_INDENT = "    "


def show_joint_table(rows: Sequence[JointRow], *, verbose: bool = False) -> None:
    """Print the joint table to standard output, as wide as the terminal; nothing without joints."""
    if rows:
        width = get_terminal_size((120, 24)).columns
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


def direction_words(direction: Vector3) -> str:
    """A direction: ``+z``, ``-x``, or its components."""
    for index, letter in enumerate("xyz"):
        if all(abs(c) <= _ALONG for i, c in enumerate(direction) if i != index):
            return f"{'+' if direction[index] > 0.0 else '-'}{letter}"
    return f"[{', '.join(f'{round(c, 6) + 0.0:.4g}' for c in direction)}]"


def millimetres(length: float) -> str:
    """A length [m] as a number of millimetres, to the micrometre."""
    return f"{round(length * 1e3, 3) + 0.0:.10g}"


def point_words(point: Vector3) -> str:
    """A point [m]: ``[0, 12.5, 3] mm``."""
    return f"[{', '.join(map(millimetres, point))}] mm"


def evidence_words(evidence: Evidence) -> str:
    """The evidence for a joint's position, in one phrase; empty for a file's."""
    selected = ", selected by the sidecar" if evidence.selected else ""
    if evidence.basis is Basis.FILE:
        return ""
    if evidence.basis is Basis.GIVEN:
        return f"given: {evidence.text}"
    if evidence.basis is Basis.AXIS:
        return f"axis of {' and '.join(map(_face, evidence.sides))}{selected}"
    a, b = sorted(evidence.sides, key=lambda side: side.bore)
    if evidence.basis is Basis.FIT:
        return f"{_face(a)} in {_face(b)}, {millimetres(evidence.overlap or 0.0)} mm engaged{selected}"
    gap = -(evidence.overlap or 0.0)
    if evidence.basis is Basis.FLANGE:
        return f"equal bores of radius {millimetres(a.radius)} mm, {_gap(gap)}{selected}"
    return f"{_face(a)} and {_face(b)}, {_gap(gap)}{selected}"


def rival_words(rival: Rival) -> str:
    """Another line that matches the origin, in one phrase."""
    radii = ", ".join(map(millimetres, rival.radii[:4]))
    share = f"{100.0 * rival.share:.3g} % as wide"
    return (
        f"other line ({rival.basis}), {share}: {direction_words(rival.direction)} "
        f"through {point_words(rival.point)}, radius {radii} mm"
    )


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
        yield from (f"{_face(side)}: {side.component}" for side in row.evidence.sides)
        yield from map(rival_words, row.evidence.rivals)


def _face(side: Side) -> str:
    return f"{'bore' if side.bore else 'shaft'} of radius {millimetres(side.radius)} mm"


def _gap(gap: float) -> str:
    if round(abs(gap), 6) == 0.0:
        return "end to end"
    return f"{millimetres(gap)} mm apart" if gap > 0.0 else f"overlapping by {millimetres(-gap)} mm"


def _wrapped(text: str, width: int, indent: str = "") -> list[str]:
    return textwrap.wrap(
        text,
        width,
        initial_indent=indent,
        subsequent_indent=f"{indent}{_INDENT}",
        break_long_words=False,
        break_on_hyphens=False,
    )
