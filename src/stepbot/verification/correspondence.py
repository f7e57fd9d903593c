"""Corresponding joints of two files that represent the same joints differently.

Configurations of the first file are drawn at random, and the other file's coordinates are solved for, so that all links
that both have are in the same poses, with the same velocities and accelerations. The observation of the other is then
converted to the coordinates of the first, in which it can be compared.
"""

from collections.abc import Mapping, Sequence
from math import pi

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.observation import Dynamics, Observation, ObservedJoint
from stepbot.geometry.spatial import Array, Pose, vector3
from stepbot.robot.dynamics import Rates

from .chains import Chain, Edge, Step, direction, pitch_of, twist_of
from .pairing import NotTheSame, Segment, segments

_CLEARANCE = 0.1
"""Minimum volume spanned by the three axes of a ball joint's angles for a comparison of dynamics: gimbal lock is at
0."""

Configuration = Mapping[str, float]
Carried = list[tuple[str, str, float]]
"""Coordinate of a file, coordinate of the comparison, and velocity of the former per unit velocity of the latter."""


class Match(Struct, frozen=True, eq=False):
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


class Correspondence(Struct, frozen=True, eq=False):
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


def normalized_joints(
    a: Observation, b: Observation, by: Correspondence, configurations: Sequence[Mapping[str, float]]
) -> tuple[Observation, Observation]:
    """Both observations in the common representation.

    Args:
        configurations: Configurations of the first file; dynamics are given at each.
    """
    ours, theirs = list[ObservedJoint](), list[ObservedJoint]()
    for match in by.matches:
        sides = _different(match) if match.different else _same(match)
        ours += sides[0]
        theirs += sides[1]
    a = a if a.initial is None else replace(a, initial=by.our_start(a.initial))
    b = b if b.initial is None else replace(b, initial=by.their_start(b.initial))
    at_rest = by.ours()
    a = _with_joints(a, [match.ours.edge for match in by.matches], ours)
    b = _with_joints(b, [match.theirs.edge for match in by.matches], theirs)
    a = _in_common(a, [at_rest for _ in a.dynamics])
    return a, _in_common(b, [by.theirs(q) for q in configurations[: len(b.dynamics)]])


def _with_joints(observation: Observation, edges: Sequence[Edge], joints: Sequence[ObservedJoint]) -> Observation:
    """The observation with other joints on some edges, and without the links in between."""
    between = {link for edge in edges for link in edge.between}
    below = between | {edge.child for edge in edges}
    return replace(
        observation,
        links=tuple(link for link in observation.links if link.name not in between),
        joints=(*(joint for joint in observation.joints if joint.child not in below), *joints),
        poses=tuple({name: X for name, X in poses.items() if name not in between} for poses in observation.poses),
    )


def _in_common(observation: Observation, carried: Sequence[Carried]) -> Observation:
    """The observation with its equations of motion in the coordinates of the comparison.

    An observation that lacks a coordinate is unchanged.
    """
    if not carried or not {name for name, _, _ in carried[0]} <= set(observation.coordinates):
        return observation
    replaced = {name for name, _, _ in carried[0]}
    rest = [name for name in observation.coordinates if name not in replaced]
    common = [*rest, *dict.fromkeys(name for _, name, _ in carried[0])]
    row = {name: i for i, name in enumerate(observation.coordinates)}
    column = {name: i for i, name in enumerate(common)}
    dynamics = []
    for one, parts in zip(observation.dynamics, carried, strict=True):
        E = np.zeros((len(row), len(column)))
        for name in rest:
            E[row[name], column[name]] = 1.0
        for name, into, factor in parts:
            E[row[name], column[into]] = factor
        dynamics.append(_carried_over(one, E))
    return replace(observation, coordinates=tuple(common), dynamics=tuple(dynamics))


def _carried_over(dynamics: Dynamics, E: Array) -> Dynamics:
    M, g, inverse = dynamics.mass_matrix, dynamics.gravity, dynamics.inverse
    return Dynamics(
        None if M is None else E.T @ M @ E, None if g is None else E.T @ g, None if inverse is None else E.T @ inverse
    )


def _same(match: Match) -> tuple[list[ObservedJoint], list[ObservedJoint]]:
    """An edge that both sides represent by the same joints."""
    ours, theirs = list[ObservedJoint](), list[ObservedJoint]()
    for segment in match.segments:
        for a, b in _steps(segment):
            name_a, name_b = _common_names(a, b, segment)
            ours.append(_joint(a, name_a, match.ours, ball=segment.balls is not None))
            theirs.append(_joint(b, name_b, match.theirs, ball=segment.balls is not None))
    if not ours:
        return [match.ours.edge.joints[-1]], [match.theirs.edge.joints[-1]]
    links = _links(match, len(ours))
    return _in_line(ours, links), _in_line(theirs, links)


def _steps(segment: Segment) -> list[tuple[Step, Step]]:
    """The steps of both sides in pairs; a ball joint is repeated for each joint of the other side."""
    most = max(len(segment.ours), len(segment.theirs))
    repeated = [steps * most if len(steps) < most else steps for steps in (segment.ours, segment.theirs)]
    return list(zip(*repeated, strict=True))


def _common_names(a: Step, b: Step, segment: Segment) -> tuple[str, str]:
    """The common name of a step: the same on both sides if only one file names it, or names it alone."""
    ours, theirs = (step.joint.name for step in (a, b))
    if len(segment.ours) != len(segment.theirs):
        return (ours, ours) if len(segment.ours) > 1 else (theirs, theirs)
    return ours if a.named else theirs, theirs if b.named else ours


def _joint(step: Step, name: str, chain: Chain, *, ball: bool) -> ObservedJoint:
    joint = replace(step.joint, name=name, steps=())
    if ball:
        return replace(joint, kind="ball", axis=None, mimic=None)
    axis = vector3(chain.X_PC.R.T @ direction(step.twists[0]))
    if step.kind == "screw":
        return replace(joint, kind="screw", axis=axis, pitch=pitch_of(step.twists[0]), mimic=None)
    return replace(joint, axis=axis)


def _links(match: Match, joints: int) -> list[str]:
    """The links along the joints of an edge."""
    edge = match.ours.edge
    between = [one.edge.between for one in (match.ours, match.theirs) if len(one.edge.between) == joints - 1]
    numbered = tuple(f"{edge.child}/{number}" for number in range(1, joints))
    return [edge.parent, *(between[0] if between else numbered), edge.child]


def _in_line(joints: Sequence[ObservedJoint], links: Sequence[str]) -> list[ObservedJoint]:
    ends = zip(joints, links[:-1], links[1:], strict=True)
    return [replace(joint, parent=parent, child=child) for joint, parent, child in ends]


def _different(match: Match) -> tuple[list[ObservedJoint], list[ObservedJoint]]:
    """An edge with different joints: one on each side, with a kind that describes the difference."""
    edges = match.ours.edge, match.theirs.edge
    single = [edge.joints[0].name for edge in edges if len(edge.joints) == 1]
    name = single[0] if single else edges[0].joints[-1].name
    kinds = (_words(edges[0]), f"{_words(edges[1])} ({match.different})")
    ours, theirs = (
        [ObservedJoint(name, kind, edge.parent, edge.child)] for edge, kind in zip(edges, kinds, strict=True)
    )
    return ours, theirs


def _words(edge: Edge) -> str:
    if len(edge.joints) == 1:
        return edge.joints[0].kind
    return ", ".join(f"{joint.kind} '{joint.name}'" for joint in edge.joints)
