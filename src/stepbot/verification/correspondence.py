"""Corresponding joints of two files that represent the same joints differently.

Configurations of the first file are drawn at random, and the other file's coordinates are solved for, so that all links
that both have are in the same poses, with the same velocities and accelerations. The observation of the other is then
converted to the coordinates of the first, in which it can be compared.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.dynamics import Rates

from .chains import Chain, Step, twist_of
from .pairing import NotTheSame, Segment, segments

_CLEARANCE = 0.1
"""Minimum volume spanned by the three axes of a ball joint's angles for a comparison of dynamics: gimbal lock is at
0."""

Configuration = Mapping[str, float]
Carried = list[tuple[str, str, float]]
"""Coordinate of a file, coordinate of the comparison, and velocity of the former per unit velocity of the latter."""


@dataclass(frozen=True, eq=False)
class Match:
    """The same edge in two files."""

    ours: Chain
    theirs: Chain
    segments: tuple[Segment, ...] = ()
    different: str = ""
    """Why they are different joints; empty if they are the same."""


def match(ours: Chain, theirs: Chain, distance: float) -> Match:
    """Determine whether two chains are the same joint; the engines that saw them are accurate to ``distance`` [m]."""
    try:
        return Match(ours, theirs, segments(ours, theirs, distance))
    except NotTheSame as why:
        return Match(ours, theirs, different=str(why))


@dataclass(frozen=True, eq=False)
class Correspondence:
    """All edges that two files represent differently."""

    matches: tuple[Match, ...]

    @property
    def _segments(self) -> list[Segment]:
        return [segment for match in self.matches for segment in match.segments]

    def following(self, rates: Configuration) -> dict[str, float]:
        """Rates of the first file, with screws constrained to their pitch."""
        followed = dict(rates)
        for segment in self._segments:
            for step in segment.ours:
                followed |= _followers(step, rates.get(step.names[0], 0.0))
        return followed

    def is_clear(self, q: Configuration) -> bool:
        """Whether no ball joint of the other file is near gimbal lock at a configuration of the first."""
        solved = self.moved(q)
        balls = [(segment, segment.balls) for segment in self._segments if segment.balls is not None]
        return all(balls[1].clearance(_at(segment.theirs, solved)) > _CLEARANCE for segment, balls in balls)

    def turned_elsewhere(self, q: Configuration, random: np.random.Generator) -> dict[str, float]:
        """A configuration of the first file with other angles of all ball joints."""
        balls = [segment for segment in self._segments if segment.balls is not None]
        names = [name for segment in balls for name in _names(segment.ours)]
        return {**q, **dict(zip(names, random.uniform(-pi, pi, len(names)).tolist(), strict=True))}

    def moved(self, q: Configuration) -> dict[str, float]:
        """The other file's configuration for one of the first."""
        solved = dict(q)
        for segment in self._segments:
            if segment.balls is not None:
                ours, theirs = segment.balls
                R = ours.rotation(_at(segment.ours, q)) @ segment.R_zero
                solved |= dict(zip(_names(segment.theirs), theirs.angles(R), strict=True))
                continue
            for ours_, theirs_ in zip(segment.ours, segment.theirs, strict=True):
                position = q.get(ours_.names[0], 0.0)
                solved |= {theirs_.names[0]: position} | _followers(theirs_, position)
        return solved

    def moving(self, q: Configuration, rates: Rates) -> Rates:
        """The other file's velocities and accelerations for those of the first, at configuration ``q`` of the first."""
        solved, (v, a) = self.moved(q), (dict(rate) for rate in rates)
        for segment in self._segments:
            if segment.balls is not None:
                ours, theirs = segment.balls
                at, there = _at(segment.ours, q), _at(segment.theirs, solved)
                J, K = ours.rates(at), theirs.rates(there)
                speeds = _at(segment.ours, rates[0])
                names = _names(segment.theirs)
                turning = np.linalg.solve(K, J @ np.array(speeds)).tolist()
                change = J @ np.array(_at(segment.ours, rates[1])) + ours.bias(at, speeds)
                v |= dict(zip(names, turning, strict=True))
                a |= dict(zip(names, np.linalg.solve(K, change - theirs.bias(there, turning)).tolist(), strict=True))
                continue
            for ours_, theirs_ in zip(segment.ours, segment.theirs, strict=True):
                for mine, rate in ((v, rates[0]), (a, rates[1])):
                    speed = rate.get(ours_.names[0], 0.0)
                    mine |= {theirs_.names[0]: speed} | _followers(theirs_, speed)
        return v, a

    def ours(self) -> Carried:
        """Velocities of the first file's coordinates from those of the comparison, in which a screw has one."""
        steps = [step for segment in self._segments for step in segment.ours]
        carried = [(name, name, 1.0) for name in _names(steps)]
        return carried + [(name, step.names[0], m) for step in steps for name, m in step.followers.items()]

    def theirs(self, q: Configuration) -> Carried:
        """Velocities of the other file's coordinates from those of the comparison, at ``q`` of the first file."""
        solved, carried = self.moved(q), list[tuple[str, str, float]]()
        for segment in self._segments:
            if segment.balls is None:
                for a, b in zip(segment.ours, segment.theirs, strict=True):
                    carried.append((b.names[0], a.names[0], 1.0))
                    carried += [(name, a.names[0], factor) for name, factor in b.followers.items()]
                continue
            ours, theirs = segment.balls
            J, K = ours.rates(_at(segment.ours, q)), theirs.rates(_at(segment.theirs, solved))
            E = np.linalg.solve(K, J).tolist()
            for name, row in zip(_names(segment.theirs), E, strict=True):
                carried += [(name, into, factor) for into, factor in zip(_names(segment.ours), row, strict=True)]
        return carried

    def our_start(self, q: Configuration) -> dict[str, float]:
        """A pose of the first file: for a ball joint the rotation vector [rad]."""
        start = dict(q)
        for segment in self._segments:
            for name in [name for step in segment.ours for name in step.followers]:
                start.pop(name, None)
            if segment.balls is not None:
                R = segment.balls[0].rotation(_at(segment.ours, q))
                start |= dict(zip(_names(segment.ours), _turned(R), strict=True))
        return start

    def their_start(self, q: Configuration) -> dict[str, float]:
        """A pose of the other file, in the same coordinates."""
        start = dict(q)
        for segment in self._segments:
            names = [*_names(segment.theirs), *(name for step in segment.theirs for name in step.followers)]
            at = _at(segment.theirs, q)
            for name in names:
                start.pop(name, None)
            if segment.balls is not None:
                at = _turned(segment.balls[1].rotation(at) @ segment.R_zero.T)
            start |= dict(zip(_names(segment.ours), at, strict=True))
        return start


def _turned(R: Array) -> list[float]:
    """The rotation vector [rad] of a rotation (3, 3)."""
    return twist_of(Pose.of(R))[:3].tolist()  # type: ignore[no-any-return]


def _followers(step: Step, amount: float) -> dict[str, float]:
    return {name: factor * amount for name, factor in step.followers.items()}


def _names(steps: Sequence[Step]) -> list[str]:
    return [name for step in steps for name in step.names]


def _at(steps: Sequence[Step], values: Configuration) -> list[float]:
    return [values.get(name, 0.0) for name in _names(steps)]
