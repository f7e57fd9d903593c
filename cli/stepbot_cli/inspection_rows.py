"""Selects the components that ``inspect`` lists, and the axes that two of them share."""

from collections.abc import Collection, Iterator, Mapping

import click
from msgspec import Struct

from stepbot.diagnostics import did_you_mean
from stepbot.step.assembly import Assembly, Component
from stepbot.step.features.axes import AxisLine, NearMiss, axis_faces, choose, lines, mates, near_misses, selectors
from stepbot.step.structure.paths import ComponentPaths, quoted, subtree_ends

_SHOWN = 12
"""Maximum number of components in a remedy."""


class SharedAxes(Struct, frozen=True):
    """The result of ``inspect --between A B``."""

    words: tuple[str, str]
    """The compared elements, for messages."""
    lines: tuple[AxisLine, ...]
    chosen: AxisLine | None
    """The line used by an origin without selectors."""
    snippets: tuple[str, ...]
    """For each line the ``origin`` that selects it."""
    radii: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]
    """For each line the radii [m] of the faces of either element, the widest first."""
    misses: tuple[NearMiss, ...]
    """Lines that nearly coincide."""
    miss_places: tuple[tuple[str, str], ...]
    """For each near miss the paths of the two components."""


def shared_axes(assembly: Assembly, links: Mapping[str, tuple[int, ...]], a: str, b: str) -> SharedAxes:
    """Compare two links or components, ``a`` and ``b``, by their names or paths.

    Args:
        links: Indices of the components of each link; empty without a sidecar.

    Raises:
        click.BadParameter: A name matches nothing, or more than one component.
    """
    paths = ComponentPaths(assembly.components)
    parts_a, parts_b = (_components(assembly, paths, links, name) for name in (a, b))
    faces_a, faces_b = axis_faces(assembly, parts_a), axis_faces(assembly, parts_b)
    shared = mates(faces_a, faces_b)
    start = "{auto: true" if a in links and b in links else f"{{mate: [{quoted(a)}, {quoted(b)}]"
    misses = near_misses(faces_a, faces_b)
    return SharedAxes(
        words=(_words(links, a), _words(links, b)),
        lines=shared,
        chosen=choose(shared).line,
        snippets=tuple(f"{start}{selector}}}" for selector in selectors(shared)) if shared else (),
        radii=tuple((_radii(line, parts_a), _radii(line, parts_b)) for line in shared),
        misses=misses,
        miss_places=tuple((_place(assembly, miss.line_a), _place(assembly, miss.line_b)) for miss in misses),
    )


def component_axes(assembly: Assembly, component: Component) -> Iterator[tuple[AxisLine, str]]:
    """The axis lines of a component, each with the origin that selects it."""
    axes = lines(axis_faces(assembly, [component.index]))
    for line, selector in zip(axes, selectors(axes), strict=True):
        yield line, f"{{axis_of: {quoted(component.path)}{selector}}}"


def _radii(line: AxisLine, parts: Collection[int]) -> tuple[float, ...]:
    """The different radii [m], to a micrometre, of a line's faces that belong to some components."""
    return tuple(dict.fromkeys(round(face.radius, 6) for face in line.members if face.component in parts))


def _components(
    assembly: Assembly, paths: ComponentPaths, links: Mapping[str, tuple[int, ...]], name: str
) -> list[int]:
    if name in links:
        return list(links[name])
    binding = paths.find_one(name)
    if not binding.problem:
        return paths.below(binding.topmost)
    known = [*binding.candidates, *binding.help]
    if binding.problem == "unknown":
        known = list(dict.fromkeys((*did_you_mean(name, links), *known))) or _all_names(assembly, links)
    raise click.BadParameter(f"'{name}' is {binding.problem}; {'; '.join(known)}", param_hint="--between")


def _all_names(assembly: Assembly, links: Mapping[str, tuple[int, ...]]) -> list[str]:
    """The links and the components below the root, where no name is similar."""
    top = [quoted(component.path) for component in assembly.components if component.parent == 0]
    more = f" and {len(top) - _SHOWN} more (`stepbot inspect`)" if len(top) > _SHOWN else ""
    listed = [f"components below the root: {', '.join(top[:_SHOWN])}{more}"] if top else []
    return [*([f"links: {', '.join(links)}"] if links else []), *listed]


def _words(links: Mapping[str, tuple[int, ...]], name: str) -> str:
    return f"link '{name}'" if name in links else f"'{name}'"


def _place(assembly: Assembly, line: AxisLine) -> str:
    return assembly.components[line.components[0]].path


class Choice(Struct, frozen=True):
    """What to list."""

    depth: int | None = None
    """Levels below the root; None for all."""
    glob: str = ""
    """A path or glob as in a sidecar; empty for every component."""
    folded: bool = True
    """Whether occurrences of one part in one subassembly share a row."""


class Row(Struct, frozen=True):
    """One row of the list."""

    component: Component
    """The first component of the row."""
    count: int = 1
    last: str = ""
    """Path of the last component of the row; empty if there is only one."""


class Rows(Struct, frozen=True):
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
    components = paths.find(glob)
    anywhere = components if components.indices else paths.find(f"**/{glob}")
    if not anywhere.indices:
        remedy = "; ".join(components.help)
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
