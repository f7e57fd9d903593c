"""Subassemblies as links: they move as one, unless a joint is inside or they are folders of unconnected parts."""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import combinations

from stepbot.draft.contacts.relations import Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Evidence, JointEvidence
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.wheels import TREAD, rolling
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.draft.parts.parts import largest
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import JointKind

_MOVING = 0.79
"""Score of a joint of a loop or a wheel, which bodies of one part may have."""
_TOGETHER, _APART = 0.75, 0.61
"""Scores of welds within a subassembly, and of pieces of one, or of one part, that do not touch: above guesses across a
gap, and below what a linkage or a motor turns.
"""
_EQUAL_PIECES = 3
"""Number of equal pieces that do not touch each other, from which a subassembly is a list; two may be plates."""
_IMPORT, _PIECE = 0.15, 0.05
"""Share of the assembly's volume from which a subassembly may be an import, and of its own that a second piece has."""


class Structure:
    """For each part, the subassembly above it that looks like a link."""

    def __init__(self, survey: Survey, mechanisms: set[tuple[int, int]]) -> None:
        self._survey, self._assembly = survey, survey.assembly
        self.link_of: dict[int, int] = {}
        """For each larger part, the highest component above it that looks like a link; empty without the tree."""
        self.groups: list[int] = []
        """Components with several larger parts that look like links."""
        if survey.sources.tree:
            moving: dict[int, set[int]] = defaultdict(set)
            for a, b in mechanisms | self._moving_pairs():
                moving[a].add(b)
            self._visit(survey.top, moving)

    def are_across(self, a: int, b: int) -> bool:
        """Whether the tree puts two parts in different links, at least one of which is a subassembly."""
        one, two = self.link_of.get(a), self.link_of.get(b)
        if one is None or two is None or one == two:
            return False
        return bool(self._assembly.children[one]) or bool(self._assembly.children[two])

    def are_together(self, a: int, b: int) -> bool:
        """Whether two parts are in one subassembly that looks like a link."""
        one = self.link_of.get(a)
        return one is not None and one == self.link_of.get(b) and bool(self._assembly.children[one])

    def names(self, part: int) -> set[Role]:
        """The roles in the name of a part's subassembly."""
        return self._survey.node_roles(self.link_of[part]) if part in self.link_of else set()

    def welds(self, evidence: Evidence) -> None:
        """Add evidence that the parts of each such subassembly are one, but for wheels that nothing else touches.

        Pieces that do not touch each other are held together by others, which may move: that is weaker evidence.
        """
        survey, axes = self._survey, dict(rolling(self._survey))
        for group in self.groups:
            members = [i for i in self._assembly.subtree(group) if i in survey.parts and i not in survey.small]
            free = {i for island in survey.islands(members) if _is_wheel(survey, island, axes) for i in island}
            first = largest(
                [survey.parts[i] for i in members if i not in free] or [survey.parts[i] for i in members]
            ).index
            own = [i for i in members if i not in free]
            why = f"in one subassembly '{self._assembly.components[group].path}'"
            for island in survey.islands(own):
                near = min(island, key=lambda i: (i != first, i))
                for i in island:
                    if i != near:
                        evidence.weld(_TOGETHER, near, i, why)
                if near != first:
                    evidence.weld(_APART, first, near, why)

    def _moving_pairs(self) -> set[tuple[int, int]]:
        """Parts that slide or swivel in each other, and those whose teeth mesh."""
        teeth = [(mesh.one.part, mesh.two.part) for mesh in self._survey.meshes if mesh.are_counted]
        return {
            *teeth,
            *((mesh.gear.part, mesh.part) for mesh in self._survey.rack_meshes),
            *(
                (i, j)
                for (i, j), r in self._survey.pairs()
                if r.via == Via.BALL
                or (r.via == Via.SLIDE and r.length > 0 and is_guide(self._survey, i, j))
                or (r.via == Via.PIN and self._is_unit(i, j))
            ),
        }

    def _is_unit(self, a: int, b: int) -> bool:
        """Whether two parts of one subassembly that turn in each other are each fastened to a part of its own outside.

        So are case and output of an actuator, or the rings of a bearing, that was bought as a whole.
        """
        home = self._assembly.components[a].parent
        if home in self._survey.tops or home != self._assembly.components[b].parent:
            return False
        inside = {i for i in self._assembly.subtree(home) if i in self._survey.parts}
        sides = Clusters(sorted(inside))
        for i in inside:
            for other, _ in self._survey.around(i):
                if other in inside and {i, other} != {a, b}:
                    sides.join(i, other)
        if sides.find(a) == sides.find(b):
            return False
        one, two = (
            {other for i in sides.members(part) for other in self._survey.holders(i)} - inside for part in (a, b)
        )
        return bool(one and two) and one.isdisjoint(two)

    def _visit(self, node: int, moving: Mapping[int, set[int]]) -> None:
        for child in self._assembly.children[node]:
            members = [
                i for i in self._assembly.subtree(child) if i in self._survey.parts and i not in self._survey.small
            ]
            if not members:
                continue
            inside = set(members)
            is_assembly = bool(self._assembly.children[child]) and self._assembly.components[child].body < 0
            moves = any(i in moving and not inside.isdisjoint(moving[i]) for i in members)
            if is_assembly and (moves or child in self._survey.tops or self._is_folder(members)):
                self._visit(child, moving)
                continue
            self.link_of.update(dict.fromkeys(members, child))
            if len(members) > 1:
                self.groups.append(child)

    def _is_folder(self, members: Sequence[int]) -> bool:
        """Whether a subassembly is only a list: disconnected pieces, two of them held from outside.

        In an import, which has a large part of all, among bodies of one part, and in a list of bearings and pins they
        may only touch what is outside.
        """
        survey, inside = self._survey, set(members)
        islands = survey.islands(members)
        volumes = sorted(map(survey.total_volume, islands))
        whole = exact_sum(volumes)
        is_import = len(islands) > 1 and whole > _IMPORT * survey.volume and volumes[-2] > _PIECE * whole
        is_list = all({Role.BEARING, Role.PIN}.intersection(survey.parts[i].roles) for i in members)
        # Equal feet or wheels are a list as well.
        is_list |= len(islands) >= _EQUAL_PIECES and len({survey.equal.kinds(island) for island in islands}) == 1
        if is_import or is_list or not any(self._assembly.components[i].product for i in members):
            held = sum(any(r.other(i) not in inside for i in island for _, r in survey.around(i)) for island in islands)
        else:
            held = sum(any(survey.holders(i) - inside for i in island) for island in islands)
        return len(islands) >= 2 and held >= 2


def _is_wheel(survey: Survey, island: Sequence[int], axes: Mapping[int, Axis]) -> bool:
    """Whether parts that touch nothing else are turned about the axis of one that the assembly rolls on."""
    axis = next((axes[i] for i in island if i in axes), None)
    return axis is not None and all(survey.parts[i].is_balanced(axis, TREAD) for i in island)


def is_guide(survey: Survey, a: int, b: int) -> bool:
    """Whether parts that could slide in each other do: by name, or because each is fastened to another part."""
    if {Role.JAW, Role.SLIDE}.intersection(survey.parts[a].roles + survey.parts[b].roles):
        return True
    holds_a, holds_b = survey.holders(a) - {b}, survey.holders(b) - {a}
    return bool(holds_a - holds_b) and bool(holds_b - holds_a)


@rule(50)
def body_welds(survey: Survey, motors: Sequence[Motor], evidence: Evidence) -> None:
    """Add evidence that the bodies of one product are one part, unless it is a motor drawn as case and horn.

    Where others are equal to it, as in limbs, the product is no list of what was drawn together: its bodies are one
    also if they do not touch.
    """
    in_motor = {i for motor in motors for i in motor.parts}
    moving = {(h.a, h.b) for h in evidence.joints if h.score >= _MOVING}
    assembly = survey.assembly
    products: dict[int, list[int]] = {}
    for c in assembly.components:
        bodies = [i for i in assembly.children[c.index] if i in survey.parts and not assembly.components[i].product]
        bodies = [i for i in bodies if i not in survey.small]
        if len(bodies) < 2 or c.index in survey.tops or not survey.sources.tree or in_motor.intersection(bodies):
            continue
        pairs = set(combinations(bodies, 2))
        if any(r is not None and r.holes > 1 for r in map(survey.relations.get, pairs)) or moving & pairs:
            continue  # what is bolted together, or moves in a loop, is an assembly that was drawn in one part
        products[c.index] = bodies
    kinds = {index: survey.equal.kinds(bodies) for index, bodies in products.items()}
    uses = Counter(kinds.values())
    for index, bodies in products.items():
        islands = survey.islands(bodies)
        for island in islands:
            for i in island[1:]:
                evidence.weld(0.97, island[0], i, f"bodies of one part '{assembly.components[index].path}'")
        for island in islands[1:] if uses[kinds[index]] > 1 else ():
            evidence.weld(_APART, islands[0][0], island[0], f"bodies of one of {uses[kinds[index]]} equal parts")


@rule(70)
def subassembly_evidence(structure: Structure, evidence: Evidence) -> None:
    """Add the welds of subassemblies that look like links."""
    structure.welds(evidence)


@rule(900)
def several_axes(structure: Structure, evidence: Evidence) -> None:
    """Two subassemblies that meet on several axes turn about none: four posts, two misaligned hinges."""
    between: dict[tuple[int, int], list[JointEvidence]] = {}
    for h in evidence.joints:
        one, two = structure.link_of.get(h.a), structure.link_of.get(h.b)
        plain = h.type == JointKind.REVOLUTE and h.relation is not None
        if one is None or two is None or one == two or not plain or h.by_role or h.score < 0.5:
            continue
        assert h.relation is not None
        if h.relation.via in (Via.FACE, Via.BOLT, Via.PIN):
            between.setdefault((min(one, two), max(one, two)), []).append(h)
    for hinges in between.values():
        apart = [h for h in hinges[1:] if not h.axis.same(hinges[0].axis, 1e-4)]
        if apart:
            for h in hinges:
                h.score = min(h.score, 0.45)
                evidence.weld(0.74, h.a, h.b, "several axes between two subassemblies")
