"""Axes shared by two components or links."""

from collections.abc import Mapping
from dataclasses import dataclass

import click

from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import AxisLine, NearMiss, axis_faces, choose, mates, near_misses, selectors
from stepbot.step.structure.paths import ComponentPaths, quoted


@dataclass(frozen=True)
class SharedAxes:
    """What ``inspect --between A B`` shows."""

    words: tuple[str, str]
    """What is compared, for people."""
    lines: tuple[AxisLine, ...]
    """The heaviest first."""
    chosen: AxisLine | None
    """The line that is taken where an origin says no more."""
    snippets: tuple[str, ...]
    """For each line the ``origin`` that means it."""
    misses: tuple[NearMiss, ...]
    """Lines that nearly coincide."""
    miss_places: tuple[tuple[str, str], ...]
    """For each miss the paths of the two components."""


def shared_axes(assembly: Assembly, links: Mapping[str, tuple[int, ...]], a: str, b: str) -> SharedAxes:
    """Compare two components or links.

    Args:
        assembly: What was read.
        links: Indices of the components of each link; empty where there is no sidecar.
        a: Name of a link, or path of a component.
        b: Name of a link, or path of a component.

    Raises:
        click.BadParameter: A name means nothing, or more than one component.
    """
    paths = ComponentPaths(assembly.components)
    faces_a, faces_b = (axis_faces(assembly, _components(paths, links, name)) for name in (a, b))
    found = mates(faces_a, faces_b)
    start = "{auto: true" if a in links and b in links else f"{{mate: [{quoted(a)}, {quoted(b)}]"
    misses = near_misses(faces_a, faces_b)
    return SharedAxes(
        words=(_words(links, a), _words(links, b)),
        lines=found,
        chosen=choose(found).line,
        snippets=tuple(f"{start}{selector}}}" for selector in selectors(found)) if found else (),
        misses=misses,
        miss_places=tuple((_place(assembly, miss.line_a), _place(assembly, miss.line_b)) for miss in misses),
    )


def _components(paths: ComponentPaths, links: Mapping[str, tuple[int, ...]], name: str) -> list[int]:
    if name in links:
        return list(links[name])
    binding = paths.find_one(name)
    if binding.problem:
        known = [*binding.candidates, *binding.help]
        raise click.BadParameter(f"'{name}' is {binding.problem}; {'; '.join(known)}", param_hint="--between")
    return paths.below(binding.topmost)


def _words(links: Mapping[str, tuple[int, ...]], name: str) -> str:
    return f"link '{name}'" if name in links else f"'{name}'"


def _place(assembly: Assembly, line: AxisLine) -> str:
    return assembly.components[line.components[0]].path
