"""Single jaws, known by their names: one that closes on its own hand moves as any last joint of an arm does."""

import re
from collections.abc import Iterable

_JAW = re.compile(r"(?<![a-z])(?:jaw|gripper|finger|claw|pincer|thumb)s?(?![a-z])", re.IGNORECASE)
_WIDEST = 2.5
"""Largest range [rad] or [m] of a jaw; the wrist that turns a gripper has more."""


def is_jaw(names: Iterable[str], lower: float, upper: float) -> bool:
    """Whether the last joint of an arm is that of a single jaw.

    Args:
        names: Names of the joint and of the link below.
        lower: Lower limit [rad] or [m].
        upper: Upper limit [rad] or [m].
    """
    return upper - lower <= _WIDEST and any(_JAW.search(name) for name in names)
