"""Assigns each component to a link.

A path to a subassembly claims everything below it; the nearest claim wins, so that a motor can be in one link and its
horn in the next. Unclaimed components go to the link with ``rest``, or are an error. Only components with a visible
body count: the others contribute nothing.
"""

from collections.abc import Mapping, Sequence
from functools import cached_property

from msgspec import Struct

from stepbot.step.assembly import BodyKind
from stepbot.step.structure.paths import nearest_claim, quoted

from .binder import Binder, listed
from .material_assignment import MaterialAssignment


class Claims(Struct, frozen=True, dict=True):
    """The link of each component."""

    link_of: tuple[str, ...]
    """Link that owns the component's body; empty if the component has no body or is ignored."""
    incomplete: frozenset[str]
    """Links whose parts are unknown: a path matches no component, or too many; then also the link with ``rest``."""
    claimed: Mapping[int, tuple[str, int]]
    """For each component that a path of a link names itself the link, and the position of the path in its parts."""
    unclaimed: tuple[int, ...] = ()
    """Components with a body that no link claims."""

    def parts_of(self, link: str) -> tuple[int, ...]:
        """Indices of the link's components with bodies, in file order."""
        return self._parts.get(link, ())

    @cached_property
    def _parts(self) -> dict[str, tuple[int, ...]]:
        """For each link that has any, the indices of its components."""
        parts: dict[str, list[int]] = {}
        for index, name in enumerate(self.link_of):
            parts.setdefault(name, []).append(index)
        return {name: tuple(indices) for name, indices in parts.items()}


def claim(binder: Binder, assignments: Sequence[MaterialAssignment]) -> Claims:
    """Assign every component with a body to a link, and report components that are in no link or in two."""
    components, document = binder.assembly.components, binder.document
    claims, incomplete = _claims(binder)
    rest = next((name for name, link in document.links.items() if link.rest), "")
    nearest = nearest_claim(components, ((one.indices, one.link) for one in claims), rest)
    takeable = [_can_be_taken(binder, index) for index in range(len(components))]
    link_of = tuple(
        name if takes and not assignment.ignored else ""
        for name, takes, assignment in zip(nearest, takeable, assignments, strict=True)
    )
    for one in claims:
        below = binder.paths.below(one.indices)
        if not (one.is_taken or any(link_of[index] == one.link for index in below)):
            _report_empty_claim(binder, one.link, one.position, below, assignments)
    left = [i for i, takes in enumerate(takeable) if takes and not assignments[i].ignored and not link_of[i]]
    unknown = [index for index in left if index not in binder.revised.new]
    if unknown:
        _report_unclaimed(binder, unknown, incomplete)
    places = {index: (one.link, one.position) for one in reversed(claims) for index in one.indices}
    with_rest = {rest} if rest and incomplete else set()  # it got the parts that the paths were to match
    return Claims(link_of, frozenset(incomplete) | with_rest, places, tuple(left))


class _Claim(Struct, frozen=True):
    """The components that one path of a link matches."""

    link: str
    position: int
    """Index of the path in the link's ``parts``."""
    indices: tuple[int, ...]
    is_taken: bool
    """Whether another link has claimed one of them before."""


def _claims(binder: Binder) -> tuple[list[_Claim], list[str]]:
    """The claims of all links in order, and the links with unresolved paths."""
    claims: list[_Claim] = []
    incomplete: list[str] = []
    first: dict[int, str] = {}
    for link, section in binder.document.links.items():
        for position, pattern in enumerate(section.parts):
            indices = binder.all(pattern, ("links", link, "parts", position))
            if not indices:
                incomplete.append(link)
                continue
            taken = [index for index in indices if first.setdefault(index, link) != link]
            if taken:
                _report_taken(binder, link, position, taken, first)
            claims.append(_Claim(link, position, indices, bool(taken)))
    return claims, incomplete


def _report_taken(binder: Binder, link: str, position: int, taken: list[int], claimed: dict[int, str]) -> None:
    others = " and ".join(dict.fromkeys(f"link '{claimed[index]}'" for index in taken))
    what = quoted(binder.path(taken[0])) if len(taken) == 1 else f"{len(taken)} components"
    binder.report(
        "SB303",
        ("links", link, "parts", position),
        f"{what} is already in {others}" if len(taken) == 1 else f"{what} are already in {others}",
        help=("a component can be in one link only: remove it from one of them",),
        notes=listed(tuple(f"{quoted(binder.path(index))} is in link '{claimed[index]}'" for index in taken)),
    )


def _can_be_taken(binder: Binder, index: int) -> bool:
    body = binder.assembly.components[index].body
    return body >= 0 and binder.assembly.bodies[body].kind is not BodyKind.WIRE


def _report_empty_claim(
    binder: Binder, link: str, position: int, below: list[int], assignments: Sequence[MaterialAssignment]
) -> None:
    bodies = [index for index in below if _can_be_taken(binder, index)]
    if not bodies:
        why, help = "it contains no body", "remove the path, or name a component with bodies (`stepbot inspect`)"
    elif all(assignments[index].ignored for index in bodies):
        why, help = "`parts` ignores it", "remove the path, or the rule with `ignore: true` under `parts`"
    else:
        why, help = "more specific claims take all of it", "remove the path, or the more specific paths"
    pattern = binder.document.links[link].parts[position]
    binder.report("SB306", ("links", link, "parts", position), f"'{pattern}' adds no part to the link: {why}", (help,))


def _report_unclaimed(binder: Binder, left: list[int], incomplete: list[str]) -> None:
    """Report one error for all unassigned components; a subassembly is listed once if all of it is unassigned."""
    whole = _whole_subassemblies(binder, set(left))
    count = f"{len(left)} components are" if len(left) > 1 else "one component is"
    misspelt = (f"a path of link '{incomplete[0]}' matches nothing; one of these may be meant",) if incomplete else ()
    binder.diagnostics.add(
        "SB304",
        f"{binder.assembly.source}: {count} not assigned to any link",
        binder.span(("links",)),
        help=(
            *misspelt,
            "add them to the `parts` of a link, or set `rest: true` on the link that takes all remaining components",
            f"or ignore them: `parts: {{{quoted(binder.path(whole[0]))}: {{ignore: true}}}}`",
        ),
        notes=listed(tuple(quoted(binder.path(index)) for index in whole)),
    )


def _whole_subassemblies(binder: Binder, left: set[int]) -> list[int]:
    """The fewest components that represent ``left``: a subassembly if nothing below it is assigned."""
    components = binder.assembly.components
    others = [False] * len(components)
    for component in reversed(components):
        other = _can_be_taken(binder, component.index) and component.index not in left
        if (other or others[component.index]) and component.parent >= 0:
            others[component.parent] = True
        others[component.index] |= other
    whole: list[int] = []
    covered: set[int] = set()
    for index in sorted(left):
        if index in covered:
            continue
        top = index
        while components[top].parent > 0 and not others[components[top].parent]:
            top = components[top].parent
        whole.append(top)
        covered.update(binder.paths.below([top]))
    return whole
