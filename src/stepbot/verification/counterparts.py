"""Pairs links and joints of two files by structure and geometry where their names differ."""

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import TypeVar

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, Request, sorted_pairs
from stepbot.geometry.spatial import Pose
from stepbot.robot.renaming import NewNames, Rename

from .chains import is_bare

Value = TypeVar("Value")


def with_old_names(request: Request, names: NewNames) -> Request:
    """A request with new names, in those of the file."""
    to = NewNames(joints={new: name for name, new in names.joints.items()}).joint
    return replace(
        request,
        configurations=tuple(_keys(q, to) for q in request.configurations),
        rates=tuple((_keys(v, to), _keys(a, to)) for v, a in request.rates),
        initial=_keys(request.initial, to),
        balls={to(name): (to(yaw), to(pitch), to(roll)) for name, (yaw, pitch, roll) in request.balls.items()},
        universals={to(name): (to(first), to(second)) for name, (first, second) in request.universals.items()},
    )


def with_new_names(observation: Observation, names: NewNames) -> Observation:
    """An observation of the file, with new names."""
    link, joint, frames = names.link, names.joint, observation.frames
    return replace(
        observation,
        links=tuple(replace(one, name=link(one.name)) for one in observation.links),
        joints=tuple(_renamed_joint(one, names) for one in observation.joints),
        coordinates=tuple(map(joint, observation.coordinates)),
        poses=tuple(_keys(pose, link) for pose in observation.poses),
        closures=observation.closures
        and tuple(
            replace(closure, link_a=link(closure.link_a), link_b=link(closure.link_b))
            for closure in observation.closures
        ),
        frames=frames and {names.frame(name): (link(on), X) for name, (on, X) in frames.items()},
        actuators=observation.actuators
        and tuple(replace(actuator, joint=joint(actuator.joint)) for actuator in observation.actuators),
        sensors=observation.sensors
        and tuple(
            replace(sensor, link=sensor.link and link(sensor.link), joint=sensor.joint and joint(sensor.joint))
            for sensor in observation.sensors
        ),
        initial=None if observation.initial is None else _keys(observation.initial, joint),
        excluded_pairs=observation.excluded_pairs
        and sorted_pairs((link(a), link(b)) for a, b in observation.excluded_pairs),
    )


def _renamed_joint(joint: ObservedJoint, names: NewNames) -> ObservedJoint:
    return replace(
        joint,
        name=names.joint(joint.name),
        parent=names.link(joint.parent),
        child=names.link(joint.child),
        mimic=joint.mimic and replace(joint.mimic, joint=names.joint(joint.mimic.joint)),
        steps=tuple(_renamed_joint(step, names) for step in joint.steps),
    )


def _keys(values: Mapping[str, Value], to: Rename) -> dict[str, Value]:
    return {to(name): value for name, value in values.items()}


_FAR = 1e-3
"""Distance [m] of two axes in the poses at zero above which they are hardly the same one."""
_SINGLE = {"revolute": "turn", "continuous": "turn", "prismatic": "slide", "fixed": "fixed"}
"""Types of joints that all formats represent by one joint."""


class _Side(Struct, frozen=True, dict=True):
    """One file as a tree."""

    links: Mapping[str, ObservedLink]
    above: Mapping[str, ObservedJoint]
    poses: Mapping[str, Pose]
    known: dict[tuple[str, tuple[int, ...]], int]
    """Numbers of the shapes of trees, shared by both files."""

    @cached_property
    def _below(self) -> dict[str, list[str]]:
        below = dict[str, list[str]]()
        for joint in self.above.values():
            below.setdefault(joint.parent, []).append(joint.child)
        return below

    def children(self, parent: str) -> list[str]:
        return self._below.get(parent, [])

    @property
    def root(self) -> str:
        return next((name for name in self.links if name not in self.above), "")

    @cached_property
    def shapes(self) -> dict[str, int]:
        """For each link but the root a number for the types of the joints above and below it, whatever their order."""
        order = [self.root]
        for link in order:
            order += self.children(link)
        numbers = dict[str, int]()
        for link in reversed(order[1:]):
            kind = self.above[link].kind
            shape = _SINGLE.get(kind, kind), tuple(sorted(numbers[child] for child in self.children(link)))
            numbers[link] = self.known.setdefault(shape, len(self.known))
        return numbers


def counterparts(first: Observation, other: Observation) -> NewNames:
    """The names that the first file has for links and joints of the other; empty if all have the same names.

    Roots are one another's counterparts. Below counterparts, links of one name are; of the rest those that are alone
    in the types of the joints above and below them, and else those whose joints are nearest to each other at zero.
    """
    known = dict[tuple[str, tuple[int, ...]], int]()
    ours, theirs = _side(first, known), _side(other, known)
    links = dict[str, str]()
    waiting = [(ours.root, theirs.root)]
    while waiting:
        a, b = waiting.pop()
        links[b] = a
        waiting += _children(ours, theirs, a, b)
    links = {b: a for b, a in links.items() if b and a}
    joints = {
        joint.name: one.name
        for b, a in links.items()
        if (joint := theirs.above.get(b)) and (one := ours.above.get(a)) and _is_same_place(one, joint, links)
    }
    return NewNames(_others(links, ours.links, theirs.links), _others(joints, _names(ours), _names(theirs)))


def _is_same_place(one: ObservedJoint, other: ObservedJoint, links: Mapping[str, str]) -> bool:
    """Whether two named joints are single ones of one type between counterparts."""
    named = one.name and other.name and links.get(other.parent) == one.parent
    return bool(named) and _SINGLE.get(one.kind, "") == _SINGLE.get(other.kind)


def _others(names: Mapping[str, str], ours: Collection[str], theirs: Collection[str]) -> dict[str, str]:
    """New names of what has another one; those that the other file has for something else stay."""
    return {b: a for b, a in names.items() if a != b and b not in ours and a not in theirs}


def _names(side: _Side) -> list[str]:
    return [joint.name for joint in side.above.values()]


def _side(observation: Observation, known: dict[tuple[str, tuple[int, ...]], int]) -> _Side:
    links = {link.name: link for link in observation.links}
    above = {
        joint.child: joint for joint in observation.joints if joint.child in links
    }  # some engines read others, too
    return _Side(links, above, observation.poses[0] if observation.poses else {}, known)


def _children(ours: _Side, theirs: _Side, a: str, b: str) -> list[tuple[str, str]]:
    """Pairs of the links below two counterparts."""
    mine, others = ours.children(a), theirs.children(b)
    pairs = [(name, name) for name in mine if name in others]
    left = [name for name in mine if name not in theirs.links]
    right = [name for name in others if name not in ours.links]
    left, right = _solid(ours, left, right), _solid(theirs, right, left)
    for name in left:
        like = [one for one in right if theirs.shapes[one] == ours.shapes[name]]
        rivals = [one for one in left if ours.shapes[one] == ours.shapes[name]]
        best = like[0] if len(like) == len(rivals) == 1 else _nearest(ours, theirs, name, like)
        if best:
            pairs.append((name, best))
            right.remove(best)
    return pairs


def _solid(side: _Side, names: Sequence[str], others: Sequence[str]) -> list[str]:
    """Links that are more than frames, if the other side has fewer."""
    solid = [name for name in names if not is_bare(side.links[name]) or side.children(name)]
    return solid if len(names) > len(others) else list(names)


def _nearest(ours: _Side, theirs: _Side, name: str, candidates: Sequence[str]) -> str:
    """The candidate whose joint is nearest at zero; empty if none is near."""
    near = [(_distance(ours, name, theirs, candidate), candidate) for candidate in candidates]
    distance, best = min(near, default=(np.inf, ""))
    return best if distance < _FAR else ""


def _distance(ours: _Side, a: str, theirs: _Side, b: str) -> float:
    """Distance [m] of two joints, along no axis of theirs, and between their axes as unit vectors."""
    if a not in ours.poses or b not in theirs.poses:
        return float(np.inf)
    X, Y, one, other = ours.poses[a], theirs.poses[b], ours.above[a], theirs.above[b]
    apart = Y.apply(other.anchor) - X.apply(one.anchor)
    if one.axis is None or other.axis is None:
        return float(np.linalg.norm(apart))
    u, v = X.turn(one.axis), Y.turn(other.axis)
    return float(np.linalg.norm(np.cross(u, apart)) + np.linalg.norm(np.cross(u, v)))
