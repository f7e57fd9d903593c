"""Paths that claim the parts of each link: whole subassemblies where possible, since the nearest claim wins."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from functools import cached_property

from stepbot.draft.parts.names import Role, is_spoken, plain
from stepbot.draft.parts.parts import Part, largest
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import ComponentPaths, nearest_claim, segments_of, without_ordinal


class LinkClaims:
    """Claims and names of links given as lists of parts."""

    def __init__(self, assembly: Assembly, links: Sequence[Sequence[int]], root: int) -> None:
        self._assembly, self._root = assembly, root
        self._link_of = {i: n for n, members in enumerate(links) for i in members}
        self._below: dict[int, Counter[int]] = defaultdict(Counter)
        for part, link in self._link_of.items():
            node = part
            while node >= 0:
                self._below[node][link] += 1
                node = assembly.components[node].parent
        self._claims: dict[int, list[int]] = defaultdict(list)
        self._visit(0, root)
        claimed = [(nodes, link) for link, nodes in self._claims.items()]
        self._owner = nearest_claim(assembly.components, claimed, root)

    def paths(self, link: int) -> tuple[str, ...]:
        """Paths that claim a link; the root claims the rest, and needs a path only below components of other links.

        Siblings of one name that are all of the link have one path, without ``#n``, which counts them in the file.
        """
        paths: dict[str, None] = {}
        covered: set[int] = set()
        for node in self._claims[link]:
            if node in covered:
                continue
            canonical = self._assembly.components[node].path
            path = self._without_needless_ordinals(canonical, link)
            paths[path] = None
            if path != canonical:
                covered.update(self._lookup.find(path).indices)
        return tuple(paths)

    def _without_needless_ordinals(self, path: str, link: int) -> str:
        """A path of a link without each ``#n`` that need not keep components of other links out."""
        segments = segments_of(path)
        for position in reversed(range(len(segments))):
            shorter = [*segments]
            shorter[position] = without_ordinal(segments[position])
            if shorter != segments and self._is_all_of("/".join(shorter), link):
                segments = shorter
        return "/".join(segments)

    def _is_all_of(self, path: str, link: int) -> bool:
        """Whether a path matches nothing that another link has."""
        indices = self._lookup.find(path).indices
        return bool(indices) and all(self._owner[i] == link or i not in self._below for i in indices)

    @cached_property
    def _lookup(self) -> ComponentPaths:
        return ComponentPaths(self._assembly.components)

    def _visit(self, node: int, above: int) -> None:
        """Claim the parts at and below a component; ``above`` is the link that claims it so far."""
        here = self._below.get(node)
        if not here or set(here) == {above}:
            return
        if node:
            most = next(iter(here)) if len(here) == 1 else max(sorted(here), key=lambda n: (here[n], n == above))
            own = self._link_of.get(node, most)
            if own != above:
                self._claims[own].append(node)
                above = own
        for child in self._assembly.children[node]:
            self._visit(child, above)

    def name(self, parts: Sequence[Part]) -> str:
        """Name of a link: that of its largest part but motors, or of the subassembly that is all of it."""
        inside = {part.index for part in parts}
        large = [part for part in parts if not part.is_small] or list(parts)
        own = [part for part in large if Role.MOTOR not in part.roles] or large
        node = largest(own).index
        components = self._assembly.components
        while components[node].parent > 0:
            above = components[node].parent
            if not all(i in inside for i in self._assembly.subtree(above) if i in self._link_of):
                break
            node = above
        component = components[node]
        spoken = [n for n in (component.product, component.occurrence) if is_spoken(n)]
        return plain(spoken[0]).strip() if spoken else largest(own).name or "link"
