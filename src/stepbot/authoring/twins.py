"""Equal bodies that nothing holds: wheels, if they are round, else two fingers that slide towards each other.

Some grippers and wheels are drawn without what guides them. Equal bodies beside one larger body are made to move on it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stepbot.robot.model import JointKind

from .axis import Axis
from .fingers import centroid, direction_between
from .part import largest
from .survey import Survey

_EQUAL = 1e-3
"""Relative difference of volume up to which two bodies are equal."""
_LARGER = 2.0
"""Ratio of volumes from which a body may carry another one."""


@dataclass(frozen=True, eq=False)
class Guess:
    """A joint by the shape of a body that nothing holds."""

    kind: JointKind
    axis: Axis
    why: str


def guesses(
    survey: Survey, free: Mapping[int, Sequence[int]], carrier: Mapping[int, Sequence[int]]
) -> dict[int, Guess]:
    """The joints of unconnected bodies that are equal to others, by their keys.

    Args:
        survey: The facts about the assembly.
        free: Parts of each body that is not connected.
        carrier: For each of them the parts of the nearest other body.
    """
    volumes = {key: survey.total_volume(members) for key, members in free.items()}
    found = {}
    for key, members in free.items():
        beside = [other for other in free if other != key and set(carrier[other]) == set(carrier[key])]
        equal = [other for other in beside if _are_equal(free, volumes, key, other)]
        if equal and survey.total_volume(carrier[key]) > _LARGER * volumes[key] > 0.0:
            guess = _guess(survey, members, [free[other] for other in equal])
            if guess is not None:
                found[key] = guess
    return found


def _are_equal(free: Mapping[int, Sequence[int]], volumes: Mapping[int, float], one: int, two: int) -> bool:
    return len(free[one]) == len(free[two]) and abs(volumes[one] - volumes[two]) <= _EQUAL * volumes[one]


def _guess(survey: Survey, members: Sequence[int], others: Sequence[Sequence[int]]) -> Guess | None:
    part = largest([survey.parts[i] for i in members])
    for axis in survey.turned.get(part.index, [])[:3]:
        if part.is_balanced(axis):
            return Guess(JointKind.REVOLUTE, axis, "one of several equal round bodies that nothing holds")
    along = direction_between(survey, members, others[0]) if len(others) == 1 else None
    if along is None:
        return None
    return Guess(
        JointKind.PRISMATIC, Axis(centroid(survey, members), along), "one of two equal bodies that nothing holds"
    )
