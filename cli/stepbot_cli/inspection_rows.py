"""Selects the components that ``inspect`` lists: up to a depth, matching a glob, repeated parts once."""

from collections.abc import Iterator
from dataclasses import dataclass

import click

from stepbot.step.assembly import Assembly, Component
from stepbot.step.structure.paths import ComponentPaths, subtree_ends


@dataclass(frozen=True)
class Choice:
    """What to list."""

    depth: int | None = None
    """Levels below the root; None for all."""
    glob: str = ""
    """A path or glob as in a sidecar; empty for every component."""
    folded: bool = True
    """Whether occurrences of one part in one subassembly share a row."""


@dataclass(frozen=True)
class Row:
    """One row of the list."""

    component: Component
    """The first component of the row."""
    count: int = 1
    last: str = ""
    """Path of the last component of the row; empty if there is only one."""


@dataclass(frozen=True)
class Rows:
    """The rows, and the number of components left out."""

    rows: tuple[Row, ...]
    deeper: int = 0
    """Number of components below the depth limit."""
    unmatched: int = 0
    """Number of components that do not match the glob."""


def listed(assembly: Assembly, choice: Choice) -> Rows:
    """The components to list, in file order.

    Raises:
        click.BadParameter: The glob matches nothing.
    """
    components = assembly.components
    matching = _matching(assembly, choice.glob) if choice.glob else range(len(components))
    depths = _depths(components)
    reached = [index for index in matching if choice.depth is None or depths[index] <= choice.depth]
    rows = tuple(_folded(components, reached) if choice.folded else (Row(components[index]) for index in reached))
    return Rows(rows, len(matching) - len(reached), len(components) - len(matching))


def _matching(assembly: Assembly, glob: str) -> list[int]:
    paths = ComponentPaths(assembly.components)
    found = paths.find(glob)
    anywhere = found if found.indices else paths.find(f"**/{glob}")
    if not anywhere.indices:
        remedy = "; ".join(found.help)
        raise click.BadParameter(
            f"no component matches '{glob}'{'; ' + remedy if remedy else ''}", param_hint="--filter"
        )
    return sorted(anywhere.indices)


def _depths(components: tuple[Component, ...]) -> list[int]:
    depths: list[int] = []
    for component in components:
        depths.append(depths[component.parent] + 1 if component.parent >= 0 else 0)
    return depths


def _folded(components: tuple[Component, ...], indices: list[int]) -> Iterator[Row]:
    """A row for each component; siblings of one definition share that of the first, including everything below."""
    ends, chosen = subtree_ends(components), set(indices)
    groups: dict[tuple[object, ...], list[int]] = {}
    for index in indices:
        groups.setdefault(_row_key(components[index]), []).append(index)
    hidden: set[int] = set()
    for index in indices:
        if index in hidden:
            continue
        equal = groups[_row_key(components[index])]
        for other in equal[1:]:
            hidden.update(chosen.intersection(range(other, ends[other])))
        yield Row(components[index], len(equal), components[equal[-1]].path if len(equal) > 1 else "")


def _row_key(component: Component) -> tuple[object, ...]:
    """Equal for components that share a row."""
    if component.definition < 0:
        return (component.index,)
    return (component.parent, component.definition, component.product, component.material, component.density)
