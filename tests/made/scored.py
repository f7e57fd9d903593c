"""What ``init`` finds of a drawn mechanism, counted as ``python -m benchmarks drafts`` counts it."""

from collections import defaultdict
from collections.abc import Mapping
from random import Random

import numpy as np
from msgspec import Struct, field
from msgspec.structs import asdict

from stepbot.draft.draft import SURE
from stepbot.draft.inference import InferredMechanism, infer_mechanism
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind

from .kinds import KINDS, MESSY, VARIED
from .kit import SCREWS, Kit, Truth

_DISTANCE, _ANGLE = 4e-4, 0.02
"""Accuracy [m], [rad] of axes: parts may be placed 0.36 mm off."""


class Result(Struct):
    """Counts of joints of some drawn mechanisms."""

    drawn: int = 0
    true: int = 0
    found: int = 0
    merged: int = 0
    """Right axis and sides, where a link holds another one, too."""
    unmarked: int = 0
    """Wrong ones without a mark."""
    reviewed: int = 0
    """Wrong ones with one."""
    volume: float = 0.0
    """Sum of the shares of the volume in the right link."""
    roots: int = 0
    notes: list[str] = field(default_factory=list)

    def add(self, other: "Result") -> None:
        """Add the counts of another one."""
        for name, value in asdict(other).items():
            setattr(self, name, getattr(self, name) + value)

    def row(self) -> str:
        """Cells of a Markdown row."""
        share = self.volume / max(1, self.drawn)
        cells = f"{self.found} of {self.true}", self.merged, self.unmarked, self.reviewed, f"{share:.0%}"
        return " | ".join(map(str, (*cells, f"{self.roots} of {self.drawn}")))


def drawn(kind: str, seed: int) -> Kit:
    """A mechanism of a kind."""
    kit = Kit(Random(f"{kind} {seed}"), is_varied=kind in VARIED, is_messy=kind in MESSY)
    KINDS[kind](kit)
    return kit


def scored(kit: Kit) -> Result:
    """Infer a drawn mechanism and compare it with its truth."""
    assembly, by_path = kit.assembly()
    return compared(kit, infer_mechanism(assembly), by_path)


def compared(kit: Kit, inferred: InferredMechanism, by_path: Mapping[str, str]) -> Result:
    """Compare what was inferred of a drawn mechanism with its truth: the link of each part, by its path."""
    assert {inferred.root, *(arc.child for arc in inferred.arcs)} == set(range(len(inferred.links))), (
        "a link is not connected"
    )
    link_of = {i: by_path[part.path] for i, part in inferred.survey.parts.items() if by_path[part.path] != SCREWS}
    one = list(range(len(inferred.links)))
    for arc in inferred.arcs:
        if arc.evidence.type == JointKind.FIXED:
            one = [one[arc.parent] if n == one[arc.child] else n for n in one]
    drafted = {i: one[n] for n, members in enumerate(inferred.links) for i in members}
    shared: dict[tuple[int, str], float] = defaultdict(float)
    for i, link in link_of.items():
        shared[drafted[i], link] += inferred.survey.parts[i].volume
    means: dict[int, str] = {}
    home: dict[str, int] = {}
    for n, link in sorted(shared, key=lambda key: (-shared[key], key)):
        if n not in means and link not in means.values():
            means[n] = link
        home.setdefault(link, n)
    total = sum(shared.values())
    right = sum(volume for (n, link), volume in shared.items() if means.get(n) == link)
    result = Result(1, len(kit.joints), volume=right / total, roots=means.get(one[inferred.root]) == kit.root)
    _match(kit, inferred, one, means, home, result)
    return result


def _match(
    kit: Kit, inferred: InferredMechanism, one: list[int], means: dict[int, str], home: dict[str, int], result: Result
) -> None:
    moving = [arc for arc in inferred.arcs if arc.evidence.type != JointKind.FIXED]
    right: set[int] = set()
    for joint in kit.joints:
        wanted = {joint.a, joint.b}
        on_pin = wanted.union(*({k.a, k.b} for k in kit.joints if _on(Axis(k.point, k.direction), k.kind, joint)))
        best = 0
        for n, arc in enumerate(moving):
            ends = {one[arc.parent], one[arc.child]}
            if n in right or not _on(arc.evidence.axis, arc.evidence.type, joint):
                continue
            sides = {means.get(end, "") for end in ends}
            same = str(arc.evidence.type).replace("continuous", "revolute") == joint.kind
            if same and (sides == wanted or (len(on_pin) > 2 and len(ends) == 2 and sides <= on_pin)):
                best, at = 2, n
                break
            if same and ends == {home.get(joint.a), home.get(joint.b)} and len(ends) == 2:
                best, at = 1, n
        if best:
            right.add(at)
        else:
            result.notes.append(f"missed {joint.kind} {joint.a} - {joint.b}")
        result.found += best == 2
        result.merged += best == 1
    for n, arc in enumerate(moving):
        if n not in right:
            h = arc.evidence
            is_marked = bool(h.review) or h.score < SURE
            result.reviewed += is_marked
            result.unmarked += not is_marked
            ends = " - ".join(str(means.get(one[end])) for end in (arc.parent, arc.child))
            result.notes.append(f"wrong {h.type} {ends} [{h.score:.2f} {h.why}{'' if is_marked else ', UNMARKED'}]")


def _on(axis: Axis, kind: str, joint: Truth) -> bool:
    if axis.direction is None:
        return kind == joint.kind == "ball" and float(np.linalg.norm(axis.point - joint.point)) < _DISTANCE
    if not Axis(joint.point, joint.direction).is_along(axis.d, _ANGLE):
        return False
    slides = kind == joint.kind == "prismatic"
    return slides or float(np.linalg.norm(np.cross(axis.point - joint.point, joint.direction))) < _DISTANCE
