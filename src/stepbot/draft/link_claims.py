"""Paths that claim the parts of each link: whole subassemblies where possible, since the nearest claim wins."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from functools import cached_property

from stepbot.draft.parts.names import Role, is_spoken, portable
from stepbot.draft.parts.parts import Part, largest
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import ComponentPaths, nearest_claim, segments_of, without_ordinal

_NAMELESS = frozenset({Role.ELECTRIC, Role.FASTENER, Role.SEAL})
"""Roles of parts that no link is named after."""
_BOUGHT = _NAMELESS | {Role.MOTOR, Role.BEARING, Role.HORN}
"""Roles of parts that a link is named after only if it has no others."""
_BASE_SHARE = 0.05
"""Share of the largest part's volume from which a part named a base gives the root its name."""
_GENERIC = re.compile(
    r"(?:part|body|solid|component|assembly|assem|asm|link|bauteil|teil|piece|peca|pe_a|default|d_?e?faut)?[ _.-]*\d*",
    re.IGNORECASE,
)
"""Names that CAD programs give."""


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
        self._matched: dict[str, set[int]] = {}
        """The links that have what a path matches; no link's number where it matches nothing."""
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
        if path not in self._matched:
            indices = self._lookup.find(path).indices
            owners = {self._owner[i] for i in indices if i in self._below}
            self._matched[path] = owners if indices else {-1}
        return self._matched[path] <= {link}

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

    def name(self, parts: Sequence[Part], *, is_root: bool = False) -> tuple[str, str]:
        """Name of a link, and the CAD's name that it is from, empty without one.

        That of the largest part that is no bought-in one, or of the subassembly that is all of the link. The root is
        the part named a base, and ``base`` where the name of its largest part states nothing.
        """
        inside = {part.index for part in parts}
        own = [part for part in parts if not _BOUGHT & set(part.roles)]
        own = own or [part for part in parts if not _NAMELESS & set(part.roles)]
        if not own:
            return ("base" if is_root else "link"), ""
        biggest = largest(own)
        bases = [part for part in own if Role.BASE in part.roles and part.volume > _BASE_SHARE * biggest.volume]
        node = (largest(bases) if is_root and bases else biggest).index
        components = self._assembly.components
        while components[node].parent > 0:
            above = components[node].parent
            if not all(i in inside for i in self._assembly.subtree(above) if i in self._link_of):
                break
            node = above
        component = components[node]
        # A body of the whole has only the name of the whole, which is no link's: its place among the bodies is its own.
        own_name = component.segment if component.parent == 0 and not component.product else biggest.name
        spoken = [n for n in (component.product, component.occurrence, own_name) if is_spoken(n)]
        name = portable(spoken[0]) if spoken else ""
        if is_root and (not name or _GENERIC.fullmatch(name)):
            name = "base"
        if name[:1].isdigit():  # no name of a topic, a macro or a variable
            name = f"link_{name}"
        return name or "link", spoken[0] if spoken else ""
