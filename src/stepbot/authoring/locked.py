"""Joints that are missing in loops which cannot move.

A loop of joints that is drawn as a mechanism moves. If its axes do not let it, two bodies that were united, by a face
on a face or a pair of holes for instance, turn on each other: the joint that lets the loop move is needed.
"""

from collections.abc import Collection, Mapping, Sequence

from .evidence import Evidence, Fate, Hinge, Rank
from .loops import Arc

REVIEW = "without it a loop of joints could not move"
"""What to review of a joint that was added for this."""
_SCORE = 0.6
_WEAKEST = 0.3
"""Score from which a refused joint may be needed."""
_MOST = 12
"""Maximum number of joints that are tried."""

JointKey = tuple[int, int, str]
"""Both parts and the type of a joint."""


def missing_joints(
    arcs: Sequence[Arc], offered: Sequence[Hinge], links: Sequence[Sequence[int]], locked: Collection[int]
) -> list[JointKey]:
    """Refused joints inside the links of locked arcs, the likeliest first."""
    stuck = {n for k in locked for n in (arcs[k].parent, arcs[k].child)}
    link_of = {i: n for n in stuck for i in links[n]}
    inside = [
        h
        for h in offered
        if h.score >= _WEAKEST
        and h.fate in (Fate.OFFERED, Fate.REFUSED)
        and h.relation is not None
        and link_of.get(h.a, -1) == link_of.get(h.b, -2)
    ]
    inside.sort(key=lambda h: (-round(h.score, 6), h.a, h.b))
    return list(dict.fromkeys((h.a, h.b, str(h.type)) for h in inside))[:_MOST]


def promote(evidence: Evidence, needed: Mapping[JointKey, str]) -> None:
    """Let needed joints come before the evidence against them; each with what to review."""
    for h in evidence.hinges:
        review = needed.get((h.a, h.b, str(h.type)))
        if review is not None:
            h.rank, h.score, h.review = Rank.NEEDED, max(h.score, _SCORE), review
