"""Recall and precision of inferred joints."""

from collections import defaultdict

import numpy as np
from msgspec import Struct, field

from stepbot.draft.draft import SURE
from stepbot.draft.inference import InferredMechanism
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind

from .axis_accuracy import AxisAccuracy
from .truth import TrueJoint, Truth, unit_distance

DISTANCE, ANGLE = 2e-5, 1e-3
"""[m] and [rad] up to which an axis is that of a true joint: coaxial faces of a STEP agree to within these."""
_SAME = {JointKind.CONTINUOUS: JointKind.REVOLUTE}


class Score(Struct):
    """Counts of joints; volumes are shares."""

    true: int = 0
    drafted: int = 0
    """Without placeholders, which are fixed joints to unconnected links."""
    found: int = 0
    """With the right axis, type and links."""
    exact: int = 0
    """Found ones whose axis is within 1e-6 m and 1e-6 rad of the true one."""
    undrawn: int = 0
    """Found ones, not exact, whose true axis the faces of one link or both do not have within these tolerances."""
    seen: int = 0
    """With the right axis, drafted or offered."""
    wrong: list[str] = field(default_factory=list)
    unmarked: int = 0
    """Wrong ones without a REVIEW mark."""
    missed: list[str] = field(default_factory=list)
    volume: float = 0.0
    """Share of the volume of all claimed parts in the right link."""
    root: bool = False


def score(inferred: InferredMechanism, truth: Truth) -> Score:
    """Compare the inferred mechanism with the true one."""
    result = Score(true=len(truth.joints))
    link_of = _assigned(inferred, truth)
    arcs = [arc for arc in inferred.arcs if arc.evidence.type != JointKind.FIXED]
    result.drafted = len(arcs)
    used: set[int] = set()
    accuracy = AxisAccuracy(inferred, truth)
    for joint in truth.joints:
        best = max((_match(arc, joint, link_of, n) for n, arc in enumerate(arcs) if n not in used), default=(0, 0))
        if best[0] >= 2:
            used.add(-best[1])
        result.found += best[0] == 3
        if best[0] == 3:
            is_exact = accuracy.is_exact(arcs[-best[1]], joint)
            result.exact += is_exact
            result.undrawn += not is_exact and not accuracy.is_drawn(joint)
        seen = best[0] >= 1 or any(_is_on(hinge.axis, hinge.type, joint) for hinge in inferred.offered)
        result.seen += seen
        if best[0] < 3:
            reason = {2: "other type", 1: "other sides", 0: "offered" if seen else "not seen"}[best[0]]
            result.missed.append(f"{joint.name} ({joint.kind}): {reason}")
    for n, arc in enumerate(arcs):
        matched = n in used
        right_type = matched and any(_match(arc, joint, link_of, n)[0] == 3 for joint in truth.joints)
        if not right_type:
            sides = f"{link_of.get(arc.parent)} - {link_of.get(arc.child)}"
            result.wrong.append(f"{arc.evidence.type} {sides} [{arc.evidence.score:.2f} {arc.evidence.why}]")
            result.unmarked += is_unmarked(arc)
    result.volume = _placed(inferred, truth, link_of)
    result.root = link_of.get(inferred.root) == truth.root
    return result


def is_unmarked(arc: TreeJoint) -> bool:
    """Whether a joint is drafted without a REVIEW mark."""
    return arc.evidence.score >= SURE and not arc.evidence.review


def _match(arc: TreeJoint, joint: TrueJoint, link_of: dict[int, str], n: int) -> tuple[int, int]:
    """3 for axis, links and type, 2 without the type, 1 for the axis alone; then the first of equal ones."""
    if not _is_on(arc.evidence.axis, arc.evidence.type, joint):
        return 0, -n
    if {link_of.get(arc.parent), link_of.get(arc.child)} != {joint.a, joint.b}:
        return 1, -n
    return 2 + (_SAME.get(arc.evidence.type, arc.evidence.type) == _SAME.get(joint.kind, joint.kind)), -n


def _is_on(axis: Axis, kind: JointKind, joint: TrueJoint) -> bool:
    """Whether an inferred axis is that of a true joint."""
    both_universal = kind == joint.kind == JointKind.UNIVERSAL
    if axis.direction is None or joint.kind == JointKind.BALL or both_universal:
        return float(np.linalg.norm(axis.point - joint.point)) < DISTANCE
    directions = [joint.axis] + ([joint.axis2] if joint.axis2 is not None else [])
    if not any(axis.is_along(direction, ANGLE) for direction in directions):
        return False
    if kind == joint.kind == JointKind.PRISMATIC:
        return True
    return unit_distance(joint.point, axis.point, axis.d) < DISTANCE


def _assigned(inferred: InferredMechanism, truth: Truth) -> dict[int, str]:
    """The true link of each inferred one: the largest common volume first, each true one once.

    Inferred links with a fixed joint between them are one, as true ones are: a placeholder moves nothing.
    """
    one = list(range(len(inferred.links)))
    for arc in inferred.arcs:
        if arc.evidence.type == JointKind.FIXED:
            gone, kept = one[arc.child], one[arc.parent]
            one = [kept if n == gone else n for n in one]
    common: dict[tuple[int, str], float] = defaultdict(float)
    for n, members in enumerate(inferred.links):
        for i in members:
            if i in truth.link_of:
                common[one[n], truth.link_of[i]] += inferred.survey.parts[i].volume + 1e-15
    found: dict[int, str] = {}
    for n, link in sorted(common, key=lambda key: (-common[key], key)):
        if n not in found and link not in found.values():
            found[n] = link
    return {n: found[group] for n, group in enumerate(one) if group in found}


def _placed(inferred: InferredMechanism, truth: Truth, link_of: dict[int, str]) -> float:
    total = right = 0.0
    for n, members in enumerate(inferred.links):
        for i in members:
            if i in truth.link_of:
                volume = inferred.survey.parts[i].volume
                total += volume
                right += volume * (truth.link_of[i] == link_of.get(n))
    return right / total if total else 0.0
