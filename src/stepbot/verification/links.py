"""Pairs the links of two observations."""

from stepbot.engines.observation import Observation, ObservedLink


def link_pairs(reference: Observation, observed: Observation) -> list[tuple[ObservedLink, ObservedLink]]:
    """Links of the same name on both sides, in the order of the reference."""
    theirs = {link.name: link for link in observed.links}
    return [(link, theirs[link.name]) for link in reference.links if link.name in theirs]
