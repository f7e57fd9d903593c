"""Gravity settings of files: the acceleration, and gravity compensation of links.

The gravity forces of the comparison are computed with standard gravity in every engine, so they do not reveal these
settings.
"""

from math import dist

from stepbot.engines.observation import Observation

from .deviation import Deviations
from .links import link_pairs

EARTH = (9.76, 9.84)
"""Acceleration of gravity [m/s^2] on the ground anywhere on Earth: 9.764 on Huascaran, 9.834 on the Arctic Ocean.
https://doi.org/10.1002/grl.50838"""
_SIDEWAYS = 1e-9
"""Maximum horizontal gravity [m/s^2] if the other file leaves gravity to the simulator."""


def has_gravity_settings(observation: Observation) -> bool:
    """Whether a file changes gravity: its own acceleration, or links with gravity compensation."""
    return bool(observation.gravity) or any(link.gravity_compensation for link in observation.links)


def compare_gravity_settings(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Compare the acceleration of gravity, and its share that acts on each link.

    A file without an acceleration of gravity leaves it to the simulator; the other file must then have Earth's.
    """
    if reference.gravity is not None and observed.gravity is not None:
        _compare_acceleration(deviations, reference.gravity, observed.gravity)
    for a, b in link_pairs(reference, observed):
        if a.gravity_compensation is None or b.gravity_compensation is None or not (a.mass or b.mass):
            continue
        where = f"gravity compensation of link '{a.name}'"
        deviations.near(b.gravity_compensation, a.gravity_compensation, where, "of its weight")


def _compare_acceleration(deviations: Deviations, expected: tuple[float, ...], found: tuple[float, ...]) -> None:
    if expected and found:
        deviations.off(
            dist(expected, found), f"acceleration of gravity {_text(found)}, {_text(expected)} expected", "m/s^2"
        )
        return
    for given in filter(None, (expected, found)):
        there = "here" if given is found else "in the file that it is compared with"
        words = f"acceleration of gravity {_text(given)} {there}; the other file leaves it to the simulator: Earth's"
        deviations.equal(_is_earths(given), f"{words} is expected, {EARTH[0]:g} to {EARTH[1]:g} m/s^2 downwards")


def _is_earths(gravity: tuple[float, ...]) -> bool:
    x, y, z = gravity
    return max(abs(x), abs(y)) <= _SIDEWAYS and EARTH[0] <= -z <= EARTH[1]


def _text(gravity: tuple[float, ...]) -> str:
    return f"({', '.join(f'{one:.10g}' for one in gravity)})"
