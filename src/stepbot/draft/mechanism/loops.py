"""Tree and closures of a mechanism, and the mobility that its loops leave to cylindrical joints."""

from collections import defaultdict, deque
from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.mechanism.joints import Joint
from stepbot.draft.parts.clusters import Clusters
from stepbot.geometry.spatial import Array
from stepbot.robot.model import JointKind

_METRES = 10.0
"""Twists are in decimetres, so that rotations and translations have similar magnitudes."""
_NULL = 1e-6
_INACCURATE = 1e-3
"""Tolerance of singular values for axes that are drawn inaccurately: 0.1 mm."""


class TreeJoint(Struct, frozen=True, eq=False):
    """A joint of the tree or a closure, between links by number."""

    evidence: JointEvidence
    parent: int
    child: int
    is_closure: bool

    @property
    def could_slide(self) -> bool:
        """Whether its faces allow both rotation and translation; sides on one pin need not touch."""
        h = self.evidence
        is_free = h.of_linkage if h.relation is None else h.relation.freedom.kind == FreedomKind.CYLINDRICAL
        return h.type == JointKind.REVOLUTE and is_free


def spanning_tree(joints: Sequence[Joint], number: dict[int, int], root: int) -> list[TreeJoint]:
    """A tree of the strongest joints, each directed away from the root, then the closures.

    Driven ones come first, since closures have no actuators, then those of gears, which no closure can follow, then
    prismatic and universal ones, since few formats support them as closures; balls come last.
    """
    tied = Clusters(number.values())
    tree: list[Joint] = []
    closures: list[Joint] = []
    for j in sorted(joints, key=_priority):
        if tied.find(number[j.a]) == tied.find(number[j.b]):
            closures.append(j)
        else:
            tied.join(number[j.a], number[j.b])
            tree.append(j)
    near: dict[int, list[Joint]] = defaultdict(list)
    for j in tree:
        near[number[j.a]].append(j)
        near[number[j.b]].append(j)
    arcs, seen, waiting = [], {root}, deque([root])
    while waiting:
        here = waiting.popleft()
        for j in near[here]:
            other = number[j.b] if number[j.a] == here else number[j.a]
            if other not in seen:
                seen.add(other)
                waiting.append(other)
                arcs.append(TreeJoint(j.evidence, here, other, is_closure=False))
    return arcs + [
        TreeJoint(j.evidence, number[j.a], number[j.b], is_closure=True)
        for j in closures
        if j.evidence.type != JointKind.FIXED
    ]


def _priority(j: Joint) -> tuple[bool, bool, bool, bool, bool, float, int, int]:
    h = j.evidence
    first = h.type in (JointKind.PRISMATIC, JointKind.UNIVERSAL)
    is_last = h.type == JointKind.BALL and not h.drives
    is_led = h.drives or h.is_geared
    return h.type == JointKind.FIXED, is_last, not h.drives, not is_led, not first, -round(h.score, 6), h.a, h.b


class Motion(Struct, frozen=True):
    """The mobility that the loops leave to a cylindrical joint."""

    turns: bool
    slides: bool


def loop_motions(arcs: Sequence[TreeJoint]) -> dict[int, Motion]:
    """For each cylindrical arc in a loop, by its index: its mobility, at the drawn configuration.

    The others only turn: otherwise a rod on two parallel pins could slide along both, which moves nothing else.
    """
    motions = {}
    for k in sorted({k for cycle in _cycles(arcs) for k in cycle if arcs[k].could_slide}):
        mobile = _mobility(arcs, _NULL, sliding=k)
        motions[k] = Motion((k, "turn") in mobile, (k, "slide") in mobile)
    return motions


def locked_arcs(arcs: Sequence[TreeJoint]) -> set[int]:
    """Indices of the arcs that their loops do not let move, by more than inaccurate axes allow."""
    return looped_arcs(arcs) - {k for k, _ in _mobility(arcs, _INACCURATE)}


def looped_arcs(arcs: Sequence[TreeJoint]) -> set[int]:
    """Indices of the arcs in loops."""
    return {k for cycle in _cycles(arcs) for k in cycle}


def _mobility(arcs: Sequence[TreeJoint], tolerance: float, sliding: int = -1) -> set[tuple[int, str]]:
    """The possible motions of arcs in loops, each by the arc's index and its kind; only one cylindrical arc slides.

    Computed from the null space of all loop equations.
    """
    motions: set[tuple[int, str]] = set()
    for cycles in _independent(_cycles(arcs)):
        owners, columns = [], []
        for k in sorted({k for signs in cycles for k in signs}):
            for what, twist in _twists(arcs[k], slides=k == sliding):
                owners.append((k, what))
                columns.append(twist)
        if not columns:
            continue
        twists = np.array(columns).T
        rows = [twists * np.array([signs.get(k, 0.0) for k, _ in owners]) for signs in cycles]
        _, values, basis = np.linalg.svd(np.concatenate(rows), full_matrices=True)
        free = basis[int((values > tolerance * max(1.0, float(values[0]))).sum()) :]
        moves = np.linalg.norm(free, axis=0) > tolerance if len(free) else np.zeros(len(owners), dtype=bool)
        motions |= {owner for owner, mobile in zip(owners, moves, strict=True) if mobile}
    return motions


def _independent(cycles: Sequence[dict[int, float]]) -> list[list[dict[int, float]]]:
    """Loops in groups that share no arc: the mobility of one does not depend on the others."""
    tied = Clusters({k for signs in cycles for k in signs})
    for signs in cycles:
        first = next(iter(signs))
        for k in signs:
            tied.join(first, k)
    groups: dict[int, list[dict[int, float]]] = defaultdict(list)
    for signs in cycles:
        groups[tied.find(next(iter(signs)))].append(signs)
    return list(groups.values())


def _cycles(arcs: Sequence[TreeJoint]) -> list[dict[int, float]]:
    """The loop of each closure."""
    above = {arc.child: (arc.parent, k) for k, arc in enumerate(arcs) if not arc.is_closure}
    return [_cycle(arc, k, above) for k, arc in enumerate(arcs) if arc.is_closure]


def _cycle(closure: TreeJoint, index: int, above: dict[int, tuple[int, int]]) -> dict[int, float]:
    """The arcs of the loop that a closure closes, with the direction in which each is traversed."""

    def path(link: int) -> list[int]:
        arcs = []
        while link in above:
            link, k = above[link]
            arcs.append(k)
        return arcs

    up, down = path(closure.parent), path(closure.child)
    common = set(up) & set(down)
    signs = {k: 1.0 for k in up if k not in common}
    signs.update({k: -1.0 for k in down if k not in common})
    signs[index] = 1.0
    return signs


def _twists(arc: TreeJoint, *, slides: bool) -> list[tuple[str, Array]]:
    h = arc.evidence
    p = h.axis.point * _METRES
    if h.axis.direction is None:
        return [("ball", np.concatenate([e, np.cross(p, e)])) for e in np.eye(3)] if h.type == JointKind.BALL else []
    turn = np.concatenate([h.axis.d, np.cross(p, h.axis.d)])
    slide = np.concatenate([np.zeros(3), h.axis.d])
    if h.type == JointKind.PRISMATIC:
        return [("slide", slide)]
    if h.type == JointKind.UNIVERSAL and h.axis2 is not None:
        return [("turn", turn), ("turn", np.concatenate([h.axis2.d, np.cross(p, h.axis2.d)]))]
    return [("turn", turn), ("slide", slide)] if slides else [("turn", turn)]
