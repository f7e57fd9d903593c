"""An assembly as a tree: a branch per component, with its name and properties."""

from collections.abc import Sequence
from io import StringIO

from rich.console import Console
from rich.text import Text
from rich.tree import Tree

from stepbot.step.assembly import Component
from stepbot.step.structure.paths import quoted

from .diagnostic_text import printable
from .inspection_rows import Row

_UNLIMITED = 1 << 16
"""Columns where the output is no terminal: one line per component."""


def tree_lines(
    components: Sequence[Component], rows: Sequence[Row], facts: Sequence[str], width: int | None
) -> list[str]:
    """One branch per row, below those of the subassemblies that it is in.

    Args:
        components: All components; parents come before their children.
        rows: The components to show. Subassemblies that are not among them are shown by their name alone.
        facts: For each row its properties in words.
        width: Width of the screen; None for unlimited.
    """
    words_of = {row.component.index: words for row, words in zip(rows, facts, strict=True)}
    branches: dict[int, Tree] = {}

    def branch(index: int) -> Tree:
        if index not in branches:
            component = components[index]
            words = words_of.get(index, "")
            label = Text(printable(": ".join(filter(None, (quoted(component.segment), words)))))
            branches[index] = branch(component.parent).add(label) if component.parent >= 0 else Tree(label)
        return branches[index]

    for row in rows:
        branch(row.component.index)
    text = StringIO()
    console = Console(file=text, width=width or _UNLIMITED, color_system=None, highlight=False, soft_wrap=False)
    console.print(branch(0))
    return [line.rstrip() for line in text.getvalue().splitlines()]
