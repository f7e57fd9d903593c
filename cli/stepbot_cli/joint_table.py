"""The joint table: position of every joint, and the evidence for it."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .columns import cells
from .diagnostic_text import FRAME_WIDTH, printable
from .terminal import screen_width, write_result

if TYPE_CHECKING:
    from stepbot.report.summary import JointTable
    from stepbot.robot.joint_table import JointRow

_NARROWEST = 60
_INDENT = "    "


def show_joint_rows(rows: Sequence["JointRow"], *, verbose: bool = False) -> None:
    """Print the joint table of these joints; nothing without joints."""
    if rows:
        from stepbot.report.summarizing import joint_table_of

        show_joint_table(joint_table_of(rows, verbose=verbose))


def show_joint_table(table: "JointTable") -> None:
    """Print a joint table to standard output, as wide as the terminal."""
    write_result("\n".join(joint_lines(table, screen_width(sys.stdout) or FRAME_WIDTH)))


def joint_lines(table: "JointTable", width: int) -> list[str]:
    """The joint table as lines.

    Args:
        width: Width of the screen, at least 60; only a word longer than a line exceeds it.
    """
    width = max(width, _NARROWEST)
    lines = [table.title]
    for joint in table.joints:
        head, place, details = printable(joint.head), printable(joint.place), joint.details
        if place and cells(f"{head}, {place}") <= width:
            head = f"{head}, {place}"
        elif place:
            details = (place, *details)
        lines += _wrapped(head, width)
        for text in details:
            lines += _wrapped(printable(text), width, _INDENT)
    return lines + (_wrapped(printable(table.weak), width) if table.weak else [])


def _wrapped(text: str, width: int, indent: str = "") -> list[str]:
    line = f"{indent}{text}".rstrip()
    if len(line) <= width and "\n" not in line:
        return [line]
    import textwrap

    return textwrap.wrap(
        text,
        width,
        initial_indent=indent,
        subsequent_indent=f"{indent}{_INDENT}",
        break_long_words=False,
        break_on_hyphens=False,
    )
