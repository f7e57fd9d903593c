"""The pose of a described robot in the assembly, and its joint positions as drawn.

Methods, in order: the assembly's own frame, aligned bounding boxes, pairs of joint axes aligned with axes of the
assembly, matching vertices. From the first link, each further one follows through its joint, at the position that
matches most of its vertices with vertices of the assembly.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations, islice, permutations, product
from math import pi

import numpy as np
from msgspec import Struct

from stepbot.draft.from_description.lines import Lines, matching_pairs
from stepbot.draft.from_description.skeleton import Skeleton
from stepbot.draft.from_description.surfaces import Surfaces, spread
from stepbot.draft.from_description.votes import slides, translations, turns
from stepbot.draft.parts.axis import Axis, are_parallel
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, Pose, corners
from stepbot.robot.kinematics import displacement
from stepbot.robot.model import Joint, JointKind
from stepbot.step.assembly import Assembly

_SAMPLE, _MOVED = 60, 300
"""Maximum number of a link's vertices compared with faces, and with vertices."""
_VOTING, _VERTICES = 24, 20_000
_FOUND = 0.5
"""Share of a link's vertices on faces of the assembly from which the link is found there."""
_BETTER = 0.1
"""Share by which another position of a joint must be better than 0."""
_BOXES = 2e-3
"""Relative difference of sizes up to which the robot's bounding box matches the assembly's."""
_TRIED, _GROWN = 200, 4
"""Maximum number of poses that are compared, and followed through the whole robot."""
_PAIRS = 12
_LINES, _OFFERED, _AHEAD = 12, 4, 2
"""Maximum number of joint positions by axes, of those compared further, and number of joints to look ahead."""
_AT_LIMIT = 1e-6
"""Distance [rad] or [m] up to which a position is 0 or a limit: meshes are in single precision."""


class Placement(Struct, frozen=True, eq=False):
    """The described robot in the assembly."""

    poses: Mapping[str, Pose]
    """X_WL of each link as drawn."""
    q: Mapping[str, float]
    """By child link, the positions [rad] or [m] as drawn of joints that are not at 0."""
    shares: Mapping[str, float]
    """For each link with points, their share on faces of the assembly."""
    axes: int
    """Number of rotating joints on an axis of the assembly."""
    how: str
    """How it was found, for messages."""

    def has(self, link: str) -> bool:
        """Whether the link was confirmed at its pose."""
        return self.shares.get(link, 0.0) >= _FOUND

    @property
    def rank(self) -> tuple[int, int, float]:
        """Sort key; greater is better."""
        return sum(map(self.has, self.shares)), self.axes, round(exact_sum(self.shares.values()), 6)


def find_placement(
    described: Skeleton, assembly: Assembly, axes: Sequence[Axis], lines: Lines, surfaces: Surfaces
) -> Placement | None:
    """The best placement; None without evidence that the description is of this assembly.

    Args:
        axes: Likely joint axes, without duplicates.
    """
    return _Placing(described, assembly, axes, lines, surfaces).best()


class _Placing:
    def __init__(
        self, described: Skeleton, assembly: Assembly, axes: Sequence[Axis], lines: Lines, surfaces: Surfaces
    ) -> None:
        self._described, self._axes, self._lines, self._known = described, axes, lines, surfaces
        self._vertices = _vertices(assembly)
        self._samples = {name: spread(link.points, _SAMPLE) for name, link in described.links.items()}
        self._at_zero = described.poses(Pose(), {})
        self._turning = {child: joint for child, joint in described.joints.items() if joint.kind.is_hinge}

    def best(self) -> Placement | None:
        candidates = [self._grown(self._described.root, Pose(), "its frame is that of the STEP")]
        for ways in (self._by_boxes, self._by_axes, self._by_vertices):
            if self._is_whole(max(candidates, key=lambda candidate: candidate.rank)):
                break
            tried = sorted(islice(ways(), _TRIED), key=lambda one: self._first_rank(one[0], one[1]), reverse=True)
            for one in tried[:_GROWN]:
                candidates.append(self._grown(*one))
                if self._is_whole(candidates[-1]):
                    break
        best = max(candidates, key=lambda candidate: candidate.rank)
        return best if self._is_credible(best) else None

    def _is_whole(self, placement: Placement) -> bool:
        """Whether every link with points was found, or every axis if there are none."""
        if placement.shares:
            return all(map(placement.has, placement.shares))
        return placement.axes == len(self._turning)

    def _is_credible(self, placement: Placement) -> bool:
        links, axes, _ = placement.rank
        if placement.shares and 2 * links >= len(placement.shares):
            return True
        return 2 * axes >= max(1, len(self._turning)) and (axes >= 2 or not placement.shares)

    def _first_rank(self, seed: str, X_WL: Pose) -> tuple[float, int]:
        """Score of a link's pose before the robot is followed."""
        share = round(self._known.share(X_WL.apply(self._samples[seed])), 6)
        return share, self._axes_on(self._described.poses(X_WL @ self._at_zero[seed].inverse(), {}))

    def _by_boxes(self) -> Iterator[tuple[str, Pose, str]]:
        """Poses that align the bounding boxes of robot and assembly, in 24 orientations."""
        points = [self._at_zero[name].apply(sample) for name, sample in self._clouds.items() if len(sample)]
        if not points or not len(self._vertices):
            return
        cloud = np.concatenate(points)
        low, high = corners(self._vertices)
        for R in _orientations():
            first, last = corners(cloud @ R.T)
            if np.abs((high - low) - (last - first)).max() < _BOXES * float(np.linalg.norm(high - low)):
                shift = 0.5 * (low + high - first - last)
                yield self._described.root, Pose.of(R, shift), "the boxes around both are one"

    def _by_axes(self) -> Iterator[tuple[str, Pose, str]]:
        """Poses that align two joint axes, neither parallel nor far apart in the tree, with two likely axes."""
        lines = {child: self._axis(joint, self._at_zero) for child, joint in self._turning.items()}
        pairs = [(a, b) for a, b in combinations(lines, 2) if not are_parallel(lines[a].d, lines[b].d)]
        for a, b in sorted(pairs, key=lambda pair: not self._common(*pair))[:_PAIRS]:
            link = self._common(a, b) or self._described.root
            for X_WR in matching_pairs((lines[a], lines[b]), self._axes):
                yield link, X_WR @ self._at_zero[link], "joint axes lie on axes of the STEP"

    def _common(self, a: str, b: str) -> str:
        """The link with the axes of two joints for any positions; empty if there is none."""
        one, two = ({j.parent, j.child} for j in (self._turning[a], self._turning[b]))
        return min(one & two, default="")

    def _by_vertices(self) -> Iterator[tuple[str, Pose, str]]:
        """Poses of the links with the most vertices, in 24 orientations."""
        vertices = spread(self._vertices, _VERTICES)
        largest = sorted(self._clouds, key=lambda name: (-len(self._clouds[name]), name))[:2]
        for name in largest:
            outer = _extremes(self._clouds[name], _VOTING)
            for R in _orientations() if len(outer) else ():
                for shift in translations(outer @ R.T, vertices):
                    yield name, Pose.of(R, shift), f"vertices of link '{name}' lie on those of the STEP"

    @cached_property
    def _clouds(self) -> dict[str, Array]:
        return {name: link.points for name, link in self._described.links.items()}

    def _grown(self, seed: str, X_WL: Pose, how: str) -> Placement:
        """All links from one, with each joint at the position at which links and axes beyond it match the assembly."""
        poses, q = {seed: X_WL}, dict[str, float]()
        waiting = [seed]
        for at in waiting:
            for child, joint, other in self._around(at):
                if other in poses:
                    continue
                X = poses[at]
                best = self._position(joint, X, at, _AHEAD)[1] if joint.kind.is_pair else 0.0
                poses[other] = _beyond(joint, X, at, best)
                if best:
                    q[child] = best
                waiting.append(other)
        shares = {
            name: self._known.share(poses[name].apply(sample)) for name, sample in self._samples.items() if len(sample)
        }
        return Placement(poses, q, shares, self._axes_on(poses), how)

    def _around(self, link: str) -> list[tuple[str, Joint, str]]:
        """Joints at a link, by child, with the link on the other side."""
        return [
            (child, joint, joint.child if link == joint.parent else joint.parent)
            for child, joint in self._described.joints.items()
            if link in (joint.parent, joint.child)
        ]

    def _position(self, joint: Joint, X: Pose, near: str, ahead: int) -> tuple[float, float]:
        """Score of the best position of a joint, from 0 to 1, and that position [rad] or [m].

        Args:
            X: Pose of the near link in the assembly.
            ahead: Number of further joints that may decide between equal positions.
        """
        body = self._body(joint, near)
        ranked = sorted(
            ((self._suits(joint, X, near, q, body), q) for q in self._offered(joint, X, near, body)),
            key=lambda one: (-round(one[0], 2), abs(one[1])),
        )
        close = [(score, q) for score, q in ranked if score > ranked[0][0] - _BETTER]
        if len(close) == 1 or not ahead:
            return ranked[0]
        further = []
        for score, q in close[:_OFFERED]:
            X_far = _beyond(joint, X, near, q)
            beyond = [
                self._position(following, X_far @ X_FO, other, ahead - 1)[0]
                for other, X_FO in body
                for _, following, far in self._around(other)
                if following is not joint and following.kind.is_pair and far not in dict(body)
            ]
            further.append((0.5 * (score + exact_sum(beyond) / len(beyond)) if beyond else score, q))
        return min(further, key=lambda one: (-round(one[0], 1), abs(one[1])))

    def _body(self, joint: Joint, near: str) -> list[tuple[str, Pose]]:
        """The link beyond a joint and all links fixed to it, with their poses in it."""
        far = joint.child if near == joint.parent else joint.parent
        poses = {far: Pose()}
        waiting = [far]
        for at in waiting:
            for _, fixed, other in self._around(at):
                if fixed.kind is JointKind.FIXED and other not in poses:
                    poses[other] = _beyond(fixed, poses[at], at, 0.0)
                    waiting.append(other)
        return list(poses.items())

    def _offered(self, joint: Joint, X: Pose, near: str, body: Sequence[tuple[str, Pose]]) -> list[float]:
        """Candidate positions of a joint: 0, those that match vertices, and those that match axes beyond it."""
        X_WJ = X if near != joint.parent else X @ joint.X_PC
        line, sign = Axis(X_WJ.p, X_WJ.turn(joint.axis)), 1.0 if near == joint.parent else -1.0
        still = _beyond(joint, X, near, 0.0)
        parts = [X_FO.apply(spread(self._described.links[name].points, _MOVED)) for name, X_FO in body]
        vertices = still.apply(np.concatenate(parts))
        offsets = [0.0]
        if joint.kind is JointKind.PRISMATIC:
            offsets += slides(vertices, self._vertices, line) if len(vertices) else []
        else:
            offsets += turns(vertices, self._vertices, line) if len(vertices) else []
            for axis in self._axes_of(joint, still, body):
                offsets += self._lines.turns(line, axis)[:_LINES]
        return list(dict.fromkeys(_within(joint, sign * q) for q in offsets))

    def _axes_of(self, joint: Joint, X: Pose, body: Sequence[tuple[str, Pose]]) -> list[Axis]:
        """Axes of all but one rotating joints on a body at a pose."""
        axes = []
        for name, X_FO in body:
            for _, other, _ in self._around(name):
                if other is not joint and other.kind.is_hinge:
                    X_WJ = X @ X_FO @ other.X_PC if name == other.parent else X @ X_FO
                    axes.append(Axis(X_WJ.p, X_WJ.turn(other.axis)))
        return axes

    def _suits(self, joint: Joint, X: Pose, near: str, q: float, body: Sequence[tuple[str, Pose]]) -> float:
        """Share of a body's vertices on faces, and of its axes on axes of the assembly, from 0 to 1."""
        X_far = _beyond(joint, X, near, q)
        samples = [X_FO.apply(self._samples[name]) for name, X_FO in body]
        axes = self._axes_of(joint, X_far, body)
        share = self._known.share(X_far.apply(np.concatenate(samples)))
        return 0.5 * (share + sum(map(self._lines.has, axes)) / len(axes)) if axes else share

    def _axes_on(self, poses: Mapping[str, Pose]) -> int:
        return sum(self._lines.has(self._axis(joint, poses)) for joint in self._turning.values())

    @staticmethod
    def _axis(joint: Joint, poses: Mapping[str, Pose]) -> Axis:
        X_WC = poses[joint.child]
        return Axis(X_WC.p, X_WC.turn(joint.axis))


def _beyond(joint: Joint, X: Pose, near: str, q: float) -> Pose:
    """Pose of the link beyond a joint at a position, ``X`` being that of the near link."""
    X_PC = joint.X_PC @ displacement(joint, q)
    return X @ X_PC if near == joint.parent else X @ X_PC.inverse()


def _within(joint: Joint, q: float) -> float:
    """The equivalent position within the limits, if there is one; within the tolerance, 0 and the limits themselves."""
    if abs(q) < _AT_LIMIT:
        return 0.0
    lower, upper = joint.limit.lower, joint.limit.upper
    for turn in (0.0, 2.0 * pi, -2.0 * pi) if joint.kind.is_hinge else (0.0,):
        if lower - _AT_LIMIT <= q + turn <= upper + _AT_LIMIT:
            return min(max(q + turn, lower), upper)
    return q


def _vertices(assembly: Assembly) -> Array:
    """Vertices (n, 3) of all bodies in the assembly."""
    vertices = [
        component.X_WC.apply(assembly.bodies[component.body].mesh.vertices)
        for component in assembly.components
        if component.body >= 0
    ]
    return np.concatenate([np.zeros((0, 3)), *vertices])


def _orientations() -> list[Array]:
    """The 24 rotations that map axes to axes, the identity first."""
    turns = []
    for order, signs in product(permutations(range(3)), product((1.0, -1.0), repeat=3)):
        R = np.zeros((3, 3))
        R[range(3), order] = signs
        if np.linalg.det(R) > 0.0:
            turns.append(R)
    return turns


def _extremes(points: Array, most: int) -> Array:
    """Extreme points (n, 3) in directions all around, without duplicates: corners are independent of the meshing."""
    if not len(points):
        return points
    k = np.arange(4 * most) + 0.5
    height, angle = 1.0 - 2.0 * k / len(k), pi * (1.0 + 5.0**0.5) * k
    around = np.column_stack([np.sqrt(1.0 - height**2) * f for f in (np.cos(angle), np.sin(angle))] + [height])
    outer = np.unique(np.argmax(points @ around.T, axis=0))
    return spread(points[outer], most)
