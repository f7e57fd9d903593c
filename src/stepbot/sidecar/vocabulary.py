"""What other programs and formats call the words of the sidecar, and which of its keys may stand for an unknown one."""

from collections.abc import Iterable
from difflib import get_close_matches

ALSO_CALLED = {
    "hinge": "revolute",
    "rotary": "revolute",
    "rotational": "revolute",
    "slide": "prismatic",
    "slider": "prismatic",
    "linear": "prismatic",
    "spherical": "ball",
    "weld": "fixed",
    "rigid": "fixed",
    "free": "floating",
    "wheel": "continuous",
    "convex": "hull",
    "convexhull": "hull",
    "convex_hull": "hull",
    "torque": "motor",
    "effort": "motor",
    "ft": "force_torque",
    "motors": "actuators",
    "transmissions": "actuators",
    "loops": "closures",
    "constraints": "closures",
    "sites": "frames",
    "bodies": "links",
    "components": "parts",
    "geometry": "parts",
    "pose": "origin",
    "range": "limits",
    "limit": "limits",
    "min": "lower",
    "max": "upper",
    "minimum": "lower",
    "maximum": "upper",
    "max_velocity": "velocity",
    "max_effort": "effort",
    "max_torque": "effort",
    "parent_link": "parent",
    "child_link": "child",
    "joint_type": "type",
    "name": "robot",
    "robot_name": "robot",
    "cad": "step",
    "file": "step",
}
"""What other programs call the words of the sidecar."""

NOT_SAID_SO = {
    "units": "each value carries its unit: `12 mm`, `45 deg`; a plain number is SI",
    "unit": "each value carries its unit: `12 mm`, `45 deg`; a plain number is SI",
    "base_link": "the root link is `root: {link: base}`; without it, the link that no joint moves",
}
"""For keys of other programs that the sidecar has no key for: how it says the same."""


def meant_by(key: str, keys: Iterable[str]) -> str:
    """The key among ``keys`` that an unknown one stands for beyond doubt; empty where there is none.

    It is the word of another program, or the same word in other case or without its plural's `s`.
    """
    known = tuple(keys)
    if ALSO_CALLED.get(key.lower()) in known:
        return ALSO_CALLED[key.lower()]
    return next((name for name in known if _bare(name) == _bare(key)), "")


def likely_meant(key: str, keys: Iterable[str]) -> str:
    """The key among ``keys`` that an unknown one most likely stands for; empty where none is near."""
    known = tuple(keys)
    return meant_by(key, known) or next(iter(get_close_matches(key, known, n=1)), "")


def _bare(word: str) -> str:
    return word.casefold().removesuffix("s")
