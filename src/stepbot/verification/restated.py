"""Converts observations of two files that represent the same joints differently to a common representation.

Both sides get as many joints as the side with more of them, in series; a ball joint is repeated for each of the joints
that represent it on the other side, so that limits and passive forces are compared one by one. Links that exist only
because of the joints are removed, and the equations of motion are converted to common coordinates.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from stepbot.engines.observation import Dynamics, Observation, ObservedJoint
from stepbot.geometry.spatial import Array, vector3

from .chains import Chain, Edge, Step, direction, pitch_of
from .correspondence import Carried, Correspondence, Match
from .pairing import Segment


def normalized_joints(
    a: Observation, b: Observation, by: Correspondence, configurations: Sequence[Mapping[str, float]]
) -> tuple[Observation, Observation]:
    """Both observations in the common representation.

    Args:
        a: Observation of the first file.
        b: Observation of the other file.
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
            name_a, name_b = _names(a, b, segment)
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


def _names(a: Step, b: Step, segment: Segment) -> tuple[str, str]:
    """The common name of a step: the same on both sides if only one file names it, or names it alone."""
    ours, theirs = (step.joint.name for step in (a, b))
    if not segment.same_words:
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
