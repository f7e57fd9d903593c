"""Synonyms of keys and values in other programs and formats, and suggestions for unknown keys."""

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
    "servos": "actuators",
    "transmissions": "actuators",
    "author": "maintainer",
    "licence": "license",
    "physics": "simulation",
    "option": "simulation",
    "time_step": "timestep",
    "dt": "timestep",
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
    "type": "kind",
    "kind": "type",
    "name": "robot",
    "robot_name": "robot",
    "expected": "expect",
    "expectations": "expect",
    "assert": "expect",
    "tolerance": "within",
    "cad": "step",
    "file": "step",
}
"""Names in other programs, and the corresponding names in the sidecar."""

_FLOATING, _FIXED = "write `base: floating`: the root link moves freely", "write `base: fixed`, the default"
NOT_SAID_SO = {
    **dict.fromkeys(("floating", "floating_base", "freejoint", "free_base"), _FLOATING),
    **dict.fromkeys(("fixed_base", "fix_base", "static"), _FIXED),
    "symmetry": "what the robot is expected to be is under `expect`: `expect: {symmetry: y}`",
    "units": "write the unit with each value: `12 mm`, `45 deg`; numbers without a unit are SI",
    "unit": "write the unit with each value: `12 mm`, `45 deg`; numbers without a unit are SI",
    "merge": "one shape for a whole link: `collision: {merge: hull}` in `links`",
    "base_link": "set the root link with `root: {link: base}`; the default is the link without a parent joint",
}
"""Remedies for keys of other programs without an equivalent key, and for keys in a section that does not have them."""

_OF_MOTORS = {
    "effort": "stall_torque",
    "torque": "stall_torque",
    "velocity": "no_load_speed",
    "speed": "no_load_speed",
    "gear": "gear_ratio",
    "friction": "coulomb_friction",
    "damping": "viscous_damping",
    "inertia": "rotor_inertia",
    "weight": "mass",
}
"""Names of a motor's figures by those that joints and actuators have for them."""


def meant_by(key: str, keys: Iterable[str]) -> str:
    """The key among ``keys`` that is a synonym of an unknown key; empty if there is none.

    Matches names of other programs, and the same name in another case or number.
    """
    known, word = tuple(keys), key.lower()
    for name in (ALSO_CALLED.get(word), _OF_MOTORS.get(word)):
        if name in known:
            return str(name)
    return next((name for name in known if _bare(name) == _bare(key)), "")


def likely_meant(key: str, keys: Iterable[str]) -> str:
    """The key among ``keys`` that is closest to an unknown key; empty if none is similar."""
    known = tuple(keys)
    return meant_by(key, known) or next(iter(get_close_matches(key, known, n=1)), "")


def _bare(word: str) -> str:
    return word.casefold().removesuffix("s")
