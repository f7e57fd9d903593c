"""What loops decide: missing joints, revolute or prismatic, and what to review.

A loop of joints that is drawn as a mechanism moves. If its axes do not let it, two bodies that were united, by a face
on a face or a pair of holes for instance, turn on each other: the joint that lets the loop move is needed.

Some joints of the last links are none. An assembly that is drawn with its screws shows what keeps a pin in its bore;
where nothing does, it is screwed, pressed or glued in. A short plug in a tube is no piston, what is tiny in a slot is a
key, and what is in a row on a rail is clipped to it. A bracket on one screw is clamped if its loops move without
turning it.

A rod with a ball joint at each end can spin about its own axis, which moves nothing else: the end nearer to the root is
drafted as a universal joint. A shaft in a bore with one swivel on each side is a strut: prismatic.
"""

from collections import Counter, defaultdict, deque
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.freedom import FreedomKind
from stepbot.draft.contacts.relations import Relation, Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence.evidence import Evidence, JointEvidence, Priority, Verdict, Weld, same_joint
from stepbot.draft.evidence.linkages import IN_LOOP
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.evidence.wheels import wheels
from stepbot.draft.mechanism.joints import Joint, by_cluster
from stepbot.draft.mechanism.loops import TreeJoint, locked_arcs, loop_motions, looped_arcs
from stepbot.draft.parts.axis import SAME_LINE, Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role
from stepbot.geometry.spatial import Array, perpendicular_frame, unit
from stepbot.robot.model import JointKind

REVIEW = "without it a loop of joints could not move"
_SCORE = 0.6
_WEAKEST = 0.3
"""Score from which a refused joint may be needed."""
_MOST = 12
"""Maximum number of joints that are tried."""

_HELD, _SCREWED, _KEY, _STAR = 0.9, 6, 1e-3, 3
"""Score of the weld of sides that something holds; number of screws from which an assembly is drawn with them; share of
the assembly's volume up to which what is captured in a slot is a key; number of equal bodies that nuts hold, and of
bodies in a row on a rail, at least.
"""
_BESIDE = 1e-3
"""Distance [m] of boxes up to which a nut or a clip may hold a part."""
_STEPPED = 1.5
"""Guided length of a shaft, in lengths of its longest fit, from which several faces of it are guided, as of a rod."""
_LINE, _LINES = 0.4, 3
"""Score of a further line between two links, at least, and the number of these from which they are of bolts."""
_STUCK = "nothing keeps one in the other: screwed, pressed or glued in"
_PLUG = "a round plug or insert in its bore"
_KEYED = "a key in its slot"
_BOLTED = "bolts on several parallel lines"
_ON_RAIL = "one of several on a rail, none of which could pass the others"
_NUTS = "a nut or screw on their line; nothing else moves"
_CLAMPED = "one screw clamps both: their loops move without turning them"

_SWIVELS = (JointKind.BALL, JointKind.UNIVERSAL)

JointKey = tuple[int, int, str]
"""Both parts and the type of a joint."""


def missing_joints(
    arcs: Sequence[TreeJoint], offered: Sequence[JointEvidence], links: Sequence[Sequence[int]], locked: Collection[int]
) -> list[JointKey]:
    """Refused joints inside the links of locked arcs, the likeliest first."""
    stuck = {n for k in locked for n in (arcs[k].parent, arcs[k].child)}
    link_of = {i: n for n in stuck for i in links[n]}
    inside = [
        h
        for h in offered
        if h.score >= _WEAKEST
        and h.verdict in (Verdict.OFFERED, Verdict.REFUSED)
        and h.relation is not None
        and link_of.get(h.a, -1) == link_of.get(h.b, -2)
    ]
    inside.sort(key=lambda h: (-round(h.score, 6), h.a, h.b))
    return list(dict.fromkeys(_key(h) for h in inside))[:_MOST]


def promote(evidence: Evidence, needed: Mapping[JointKey, str]) -> None:
    """Let needed joints come before the evidence against them; each with what to review."""
    for h in evidence.joints:
        review = needed.get(_key(h))
        if review is not None:
            h.priority, h.score, h.review = Priority.NEEDED, max(h.score, _SCORE), review


def hold(evidence: Evidence, held: Mapping[JointKey, str]) -> None:
    """Weld the sides of joints that are none."""
    for (a, b, _), why in sorted(held.items()):
        evidence.welds.append(Weld(_HELD, a, b, why, priority=Priority.NEEDED))


def held_joints(
    survey: Survey, arcs: Sequence[TreeJoint], links: Sequence[Sequence[int]], offered: Sequence[JointEvidence] = ()
) -> dict[JointKey, str]:
    """The joints whose sides something holds together, and what; ``offered`` has those that are not drafted."""
    ends = Counter(link for arc in arcs for link in (arc.parent, arc.child))
    doubted = [arc for arc in arcs if _is_doubtful(arc.evidence) and 1 in (ends[arc.parent], ends[arc.child])]
    moved = {*wheels(survey), *survey.belted} if doubted else set()
    moved |= {i for mesh in survey.meshes for i in (mesh.one.part, mesh.two.part)} if doubted else set()
    held: dict[JointKey, str] = {}
    for arc in arcs:
        h = arc.evidence
        if _is_doubtful(h) and not h.of_linkage and _are_bolted(h, links[arc.parent], links[arc.child], offered):
            held[_key(h)] = _BOLTED
    slides: list[tuple[JointEvidence, Sequence[int]]] = []
    for arc in doubted:
        h, sides = arc.evidence, [links[n] for n in (arc.parent, arc.child)]
        last = [links[n] for n in (arc.parent, arc.child) if ends[n] == 1 and moved.isdisjoint(links[n])]
        if last and not h.of_linkage and (why := _holder(survey, h, sides, last)):
            held[_key(h)] = why
        if last and h.type == JointKind.PRISMATIC and (h.a, h.b) in survey.captured:
            slides.append((h, last[0]))
    held |= {_key(h): _ON_RAIL for h in _on_rails(survey, slides)}
    if not held and _is_star(survey, arcs, links, ends):
        return {_key(arc.evidence): _NUTS for arc in arcs}
    return held or {_key(h): _CLAMPED for h in _clamped(survey, arcs, ends)}


def _key(h: JointEvidence) -> JointKey:
    return h.a, h.b, str(h.type)


def _is_doubtful(h: JointEvidence) -> bool:
    """Whether a drafted joint has neither a motor, a bearing, a gear or rollers, nor a fact or an answer."""
    is_stronger = h.drives or h.by_role or h.is_geared or h.of_roller or h.priority == Priority.STATED
    return h.score >= CHOSEN and not is_stronger


def _are_bolted(h: JointEvidence, one: Sequence[int], two: Sequence[int], offered: Sequence[JointEvidence]) -> bool:
    """Whether two links could turn on each other about several parallel lines: those are of bolts."""
    lines, side = list[Axis](), dict.fromkeys(one, 1) | dict.fromkeys(two, 2)
    for k in offered if h.type is JointKind.REVOLUTE else ():
        is_between = {side.get(k.a), side.get(k.b)} == {1, 2} and k.type is h.type and k.score >= _LINE
        if is_between and k.axis.is_along(h.axis.d) and not any(k.axis.same(line) for line in (h.axis, *lines)):
            lines.append(k.axis)
    return len(lines) >= _LINES


def _holder(survey: Survey, h: JointEvidence, sides: Sequence[Sequence[int]], last: Sequence[Sequence[int]]) -> str:
    """What holds a link that has no further joint in the other one; nothing if it may move."""
    r = h.relation
    if (h.a, h.b) in survey.captured:
        return _KEYED if min(map(survey.total_volume, last)) < _KEY * survey.volume else ""
    if r is None or r.via != Via.PIN:
        return ""
    if h.type == JointKind.PRISMATIC:
        return _PLUG if any(_is_plug(survey, r, h.axis, members) for members in last) else ""
    is_drawn = len(survey.small) >= _SCREWED
    return _STUCK if is_drawn and not _is_kept_in(survey, h.axis, sides, min(last, key=survey.total_volume)) else ""


def _is_plug(survey: Survey, r: Relation, axis: Axis, members: Sequence[int]) -> bool:
    """Whether a link is a turned shaft that ends in its bore, or hardly out of it: no rod moves it, nor does it one."""
    shaft = max(r.shafts, key=lambda fit: fit.length)
    larger = [i for i in members if i not in survey.small]
    if (
        larger != [shaft.shaft]
        or not survey.parts[shaft.shaft].is_balanced(axis)
        or shaft.guided > _STEPPED * shaft.length
    ):
        return False
    (start, end), (low, high) = (survey.scene.span(i, axis.d) for i in (shaft.shaft, r.other(shaft.shaft)))
    return max(low - start, end - high) < shaft.length


def _is_kept_in(survey: Survey, axis: Axis, sides: Sequence[Sequence[int]], last: Sequence[int]) -> bool:
    """Whether faces across a line, both ways, or a screw, a nut or a clip on it keep a last link with the other."""
    one, two = map(set, sides)
    between = [r for i in sorted(one) for r in survey.near.get(i, ()) if r.other(i) in two]
    faces = [(p.normal @ axis.d, p.a in one) for r in between for p in r.patches if axis.is_along(p.normal)]
    return len({(along > 0.0) == is_first for along, is_first in faces}) > 1 or _is_fastened(
        survey, axis, one | two, last
    )


def _is_fastened(survey: Survey, axis: Axis, members: Collection[int], last: Sequence[int]) -> bool:
    """Whether a screw, a nut or a clip is on a line of some parts, beside a link."""
    beside = survey.small.intersection(survey.parts_near(survey.box_of(last), _BESIDE))
    return any(
        r.other(i) in beside
        and survey.parts[r.other(i)].role is not Role.SEAL
        and any(fit.axis.same(axis) for fit in r.fits)
        for i in sorted(members)
        for r in survey.near.get(i, ())
    )


def _on_rails(survey: Survey, slides: Sequence[tuple[JointEvidence, Sequence[int]]]) -> list[JointEvidence]:
    """Slides of last links that one part guides in a row, where none could pass the others: clipped to a rail."""
    rows: dict[int, list[tuple[JointEvidence, Array]]] = defaultdict(list)
    for h, last in slides:
        body, rail = (h.a, h.b) if h.a in last else (h.b, h.a)
        across = perpendicular_frame(h.axis.d)[:, :2].T
        rows[rail].append((h, np.array([survey.scene.span(body, d) for d in across]).T))
    return [
        h
        for row in rows.values()
        for h, (low, high) in row
        if sum(
            h.axis.is_along(k.axis.d) and bool((np.minimum(high, end) > np.maximum(low, start)).all())
            for k, (start, end) in row
        )
        >= _STAR
    ]


def _is_star(
    survey: Survey, arcs: Sequence[TreeJoint], links: Sequence[Sequence[int]], ends: Mapping[int, int]
) -> bool:
    """Whether all that moves is equal bodies, each on one line with a nut: coils of valves, no robot."""
    leaves = [next((n for n in (arc.parent, arc.child) if ends[n] == 1), -1) for arc in arcs]
    if len(arcs) < _STAR or len(survey.small) < _SCREWED or -1 in leaves:
        return False
    kinds = {survey.equal.kinds(sorted(i for i in links[n] if i not in survey.small)) for n in leaves}
    return len(kinds) == 1 and all(
        arc.evidence.of_linkage
        and _is_doubtful(arc.evidence)
        and _is_fastened(survey, arc.evidence.axis, links[n], links[n])
        for arc, n in zip(arcs, leaves, strict=True)
    )


def _clamped(survey: Survey, arcs: Sequence[TreeJoint], ends: Mapping[int, int]) -> list[JointEvidence]:
    """Joints of parts that lie on each other, on one screw, if all loops that they are in move as much without them."""
    looped = looped_arcs(arcs)
    some = {
        k
        for k in sorted(looped)
        if (h := arcs[k].evidence).of_linkage and h.score < IN_LOOP and _is_doubtful(h) and not arcs[k].is_closure
        if h.relation is not None and h.relation.via == Via.BOLT and h.relation.patches and survey.has_screw_at(h.axis)
    }
    if not some:
        return []
    fixed = Clusters(ends)
    for k in sorted(some):
        fixed.join(arcs[k].parent, arcs[k].child)
    rest = [k for k in range(len(arcs)) if k not in some]
    tree = [replace(arcs[k], parent=fixed.find(arcs[k].parent), child=fixed.find(arcs[k].child)) for k in rest]
    stuck = {rest[k] for k in locked_arcs(tree)}
    return [] if stuck - locked_arcs(arcs) else [arcs[k].evidence for k in sorted(some)]


_HANGING = "the motor hangs on its own output and carries no other joint: it may be fastened elsewhere"
_TWICE = "what is between this joint and one about the same line has no other: one of both may be fixed"


def stop_spinning_rods(joints: Sequence[Joint], root: int) -> None:
    """Make one end of each rod of a loop between two ball joints a universal joint; each is to be reviewed."""
    joints_of = by_cluster(joints)
    depth = depths(joints_of, root)
    for rod in sorted(joints_of):
        ends = joints_of[rod]
        if rod == root or len(ends) != 2 or any(j.evidence.type != JointKind.BALL for j in ends):
            continue
        if any(j.evidence.priority == Priority.STATED for j in ends) or not _is_in_loop(joints_of, rod, ends):
            continue
        near, far = sorted(ends, key=lambda j: (depth.get(j.other(rod), len(joints_of)), j.evidence.a, j.evidence.b))
        along = far.evidence.axis.point - near.evidence.axis.point
        if float(np.linalg.norm(along)) < 1e-6:
            continue
        across = perpendicular_frame(unit(along))
        h = near.evidence
        h.type, h.axis2 = JointKind.UNIVERSAL, Axis(h.axis.point, across[:, 1])
        h.axis = Axis(h.axis.point, across[:, 0])
        h.review = "universal instead of ball, to keep the rod from spinning; could also be the other end"


def _is_in_loop(joints_of: dict[int, list[Joint]], rod: int, ends: Sequence[Joint]) -> bool:
    """Whether both ends of a rod are connected without it: a ball in a chain, as in a neck, is a ball."""
    rest = {root: [j for j in joints if j not in ends] for root, joints in joints_of.items() if root != rod}
    return ends[1].other(rod) in depths(rest, ends[0].other(rod))


def slide_in_struts(joints: Sequence[Joint]) -> None:
    """Make a shaft in a bore between two swivels prismatic."""
    joints_of = by_cluster(joints)
    for j in joints:
        r = j.evidence.relation
        if j.evidence.type != JointKind.REVOLUTE or r is None or r.freedom.kind != FreedomKind.CYLINDRICAL:
            continue
        others = [[k for k in joints_of[side] if k is not j] for side in (j.a, j.b)]
        if all(len(rest) == 1 and rest[0].evidence.type in _SWIVELS for rest in others):
            j.evidence.type, j.evidence.review = (
                JointKind.PRISMATIC,
                "a strut between two swivels; could also be revolute",
            )


def choose_slides(arcs: Sequence[TreeJoint]) -> None:
    """Make joints prismatic if only that motion is possible."""
    for k, motion in loop_motions(arcs).items():
        if motion.slides and not motion.turns:
            arcs[k].evidence.type = JointKind.PRISMATIC
            arcs[k].evidence.review = "the loop can move only if it is prismatic"


def note_doubts(
    arcs: Sequence[TreeJoint], structure: Structure, link_of: Callable[[int], int], *, has_drives: bool
) -> None:
    """Add review notes to each joint without a motor or a bearing, and to those of motors that carry only themselves.

    Args:
        arcs: Joints and closures.
        structure: Subassemblies that look like links.
        link_of: The number of the link of a part.
        has_drives: Whether there is any motor: without one, the assembly may not be a mechanism.
    """
    motions, locked = loop_motions(arcs), locked_arcs(arcs)
    ends = Counter(link for arc in arcs for link in (arc.parent, arc.child))
    turning: dict[int, list[JointEvidence]] = defaultdict(list)
    for arc in arcs:
        if arc.evidence.type == JointKind.REVOLUTE:
            turning[arc.parent].append(arc.evidence)
            turning[arc.child].append(arc.evidence)
    for link, pair in turning.items():
        if len(pair) == ends[link] == 2 and pair[0].axis.same(pair[1].axis, SAME_LINE):
            for h in () if any(h.drives for h in pair) else pair:
                h.review = h.review or _TWICE
    for k, arc in enumerate(arcs):
        h, motion = arc.evidence, motions.get(k)
        if h.drives and link_of(h.a) == arc.child and ends[arc.child] == 1:
            h.review = h.review or _HANGING
        if h.review or h.drives or h.by_role or h.priority == Priority.STATED or h.type == JointKind.FIXED:
            continue
        if not structure.are_across(h.a, h.b):
            h.review = "inferred from shapes alone; the parts may be fixed"
        elif arc.could_slide and (motion is None or motion.slides):
            h.review = "nothing blocks it along its axis: could also be prismatic"
        elif k in locked:
            h.review = "its loop of joints cannot move as drafted"
        elif not has_drives and not any(arc.is_closure for arc in arcs):
            h.review = "no motor found: the assembly may not be a mechanism"


def one_per_pair(joints: Sequence[Joint]) -> list[Joint]:
    """One joint between two links that parts were added to since; one on another axis is to be reviewed with it."""
    first: dict[tuple[int, int], Joint] = {}
    for j in sorted(joints, key=lambda j: (-round(j.evidence.score, 6), j.evidence.a, j.evidence.b)):
        of_pair = first.setdefault((min(j.a, j.b), max(j.a, j.b)), j)
        if of_pair is not j and same_joint(j.evidence, of_pair.evidence):
            j.evidence.verdict = Verdict.REPEATED
        elif of_pair is not j:
            for h in (j.evidence, of_pair.evidence):
                h.review = h.review or "two axes between two links: they slide, or are one link"
    return [j for j in joints if j.evidence.verdict != Verdict.REPEATED]


def depths(joints_of: dict[int, list[Joint]], root: int) -> dict[int, int]:
    """The number of joints between each cluster and the root."""
    depth, waiting = {root: 0}, deque([root])
    while waiting:
        here = waiting.popleft()
        for j in joints_of.get(here, ()):
            other = j.other(here)
            if other not in depth:
                depth[other] = depth[here] + 1
                waiting.append(other)
    return depth
