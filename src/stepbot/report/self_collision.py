"""Which links can overlap, as JSON data."""

from typing import Any

from stepbot.robot.self_collision import PairContact, SelfCollision

Json = dict[str, Any]


def self_collision_document(found: SelfCollision) -> Json:
    """All pairs with their evidence: number of poses, depth [m] and joint positions [rad] or [m] of the first one."""
    return {
        "samples": found.samples,
        "exclude": [kind.value for kind in found.exclude],
        "pairs": [_pair(pair) for pair in found.pairs],
    }


def _pair(pair: PairContact) -> Json:
    return {
        "links": [pair.link_a, pair.link_b],
        "class": pair.kind.value,
        "contacts": pair.contacts,
        "first": pair.first,
        "depth": pair.depth,
        "pose": dict(pair.pose),
    }
