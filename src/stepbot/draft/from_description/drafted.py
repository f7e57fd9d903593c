"""A draft with the joints, frames, limits and masses of a description, and the components found for each link."""

from collections.abc import Iterable, Iterator, Sequence
from math import isfinite

import numpy as np

from stepbot.diagnostics import listed
from stepbot.draft.draft import SURE, Confidence, Draft, DraftClosure, DraftJoint, DraftLink, OriginForm, OriginSnippet
from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.from_description.assignment import Assignment, assign
from stepbot.draft.from_description.lines import Lines, distinct
from stepbot.draft.from_description.placement import Placement, find_placement
from stepbot.draft.from_description.skeleton import Skeleton, SkeletonClosure, skeleton
from stepbot.draft.from_description.surfaces import Surfaces
from stepbot.draft.inference import infer_mechanism
from stepbot.draft.link_claims import LinkClaims
from stepbot.draft.parts.axis import Axis
from stepbot.draft.text.values import number, position
from stepbot.engines.description import Description
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Array, Pose, Vector3, perpendicular_frame, unit, vector3
from stepbot.robot.model import Joint, JointKind, Limit
from stepbot.step.assembly import Assembly

_KNOWN, _PLACED, _GUESSED = 0.95, 0.85, 0.6
_SAME_PLACE = 1e-9
_WITHIN, _SLACK = 0.95, 5e-4
"""Share of a link's vertices in the box of a body from which it is drawn there, and the slack [m] of the box."""
_AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


def draft_of_description(description: Description, assembly: Assembly, robot: str, source: str) -> Draft | None:
    """The draft of a description; None without evidence that it is of this assembly.

    Args:
        assembly: Read with its faces (``ReadOptions.faces``).
    """
    described = skeleton(description)
    if described is None or not any(component.body >= 0 for component in assembly.components):
        return None
    inferred = infer_mechanism(assembly)
    likely = distinct([*(arc.evidence.axis for arc in inferred.arcs), *(hinge.axis for hinge in inferred.offered)])
    lines = Lines(assembly)
    surfaces = Surfaces(inferred.survey.scene)
    placement = find_placement(described, assembly, likely, lines, surfaces)
    if placement is None:
        return None
    assigned = assign(described, placement, assembly, inferred, surfaces)
    moving = [arc.evidence for arc in inferred.arcs if arc.evidence.type is not JointKind.FIXED]
    return _Drafting(described, placement, assembly, lines, assigned).draft(robot, source, moving)


class _Drafting:
    def __init__(
        self, described: Skeleton, placement: Placement, assembly: Assembly, lines: Lines, assigned: Assignment
    ) -> None:
        self._described, self._placement, self._assembly = described, placement, assembly
        self._lines, self._assigned = lines, assigned
        self._members = {name: assigned.members(name) for name in described.links}
        self._claims = LinkClaims(assembly, list(self._members.values()), 0)

    def draft(self, robot: str, source: str, moving: Sequence[JointEvidence]) -> Draft:
        """The draft; ``moving`` are the joints that the STEP itself indicates."""
        root = self._described.root
        X_WR = self._placement.poses[root]
        recognized, all_of_them = len(self._assigned.recognized), len(self._assigned.link_of)
        note = f"{recognized} of {all_of_them} components recognized by their faces"
        notes = [f"placed by this: {self._placement.how}; {note}", *self._described.notes]
        notes += [*self._fused(), *self._split(moving)]
        return Draft(
            robot,
            root,
            tuple(self._link(n, name) for n, name in enumerate(self._described.links)),
            tuple(self._joint(child, joint) for child, joint in self._described.joints.items()),
            tuple(self._closure(closure) for closure in self._described.closures),
            notes=tuple(notes),
            source=source,
            root_frame=None if _is_identity(X_WR) else _numbers(X_WR),
            base=self._described.base,
            frames=self._described.frames,
        )

    def _fused(self) -> Iterator[str]:
        """Links of the description that have no component of their own, since one body of the STEP is several links."""
        for name, link in self._described.links.items():
            if self._members[name] or not len(link.points):
                continue
            cloud = self._placement.poses[name].apply(link.points)
            shares = {i: self._share_within(i, cloud) for i in self._assigned.link_of}
            most = max(shares, key=lambda i: (shares[i], -i), default=-1)
            if most >= 0 and shares[most] >= _WITHIN:
                body, other = self._assembly.components[most].path, self._assigned.link_of[most]
                yield f"link '{name}' has no component: '{body}', one body of link '{other}', is where its shapes are"

    def _share_within(self, i: int, cloud: Array) -> float:
        """The share of points that is in the bounding box of a component."""
        box = self._assembly.bounds(i)
        if box is None:
            return 0.0
        low, high = (np.array(corner) for corner in box)
        return float(((cloud >= low - _SLACK) & (cloud <= high + _SLACK)).all(axis=1).mean())

    def _split(self, moving: Sequence[JointEvidence]) -> Iterator[str]:
        """Links of the description whose components move on each other in the STEP."""
        group_of, link_of = self._described.rigid_groups(), self._assigned.link_of
        for h in moving:
            known = {h.a, h.b} <= self._assigned.recognized
            if known and h.score >= SURE and group_of[link_of[h.a]] == group_of[link_of[h.b]]:
                a, b = (self._assembly.components[i].path for i in (h.a, h.b))
                where = " and ".join(f"'{name}'" for name in dict.fromkeys((link_of[h.a], link_of[h.b])))
                yield f"'{a}' and '{b}' of {where} do not move here, but may in the STEP ({h.type}: {h.why})"

    def _link(self, n: int, name: str) -> DraftLink:
        members = self._members[name]
        guesses = [i for i in members if i in self._assigned.guesses]
        facts = []
        for count, what in (
            (sum(i in self._assigned.recognized for i in members), "recognized by their faces"),
            (sum(i in self._assigned.inferred for i in members), "by contacts, with the joint axes of this link"),
        ):
            if count:
                facts.append(f"{count} of {len(members)} components {what}")
        if not members:
            facts.append("no component found")
        for reason in dict.fromkeys(self._assigned.guesses[i] for i in guesses):
            paths = [self._assembly.components[i].path for i in guesses if self._assigned.guesses[i] == reason]
            facts.append(f"{_some(paths)}: {reason}")
        link = self._described.links[name]
        is_missing = not members and (len(link.points) > 0 or link.inertial.mass > 0.0)
        score = _GUESSED if guesses or is_missing else _KNOWN
        inertial = link.inertial if link.inertial.mass > 0.0 else None
        return DraftLink(
            *(name, self._claims.paths(n), Confidence(score, tuple(facts)), n == 0, tuple(members)),
            inertial=None if inertial is None else _rounded(inertial),
        )

    def _joint(self, child: str, joint: Joint) -> DraftJoint:
        X_WJ = self._placement.poses[joint.parent] @ joint.X_PC
        confidence, review = self._evidence(child, joint, X_WJ)
        q, limits = self._placement.q.get(child, 0.0), _limits(joint)
        slides = joint.kind is JointKind.PRISMATIC
        if limits is not None and not limits.lower <= q <= limits.upper:
            q_drawn, *ends = (position(value, slides=slides) for value in (q, limits.lower, limits.upper))
            review = f"drawn at {q_drawn}, outside of the described limits {' to '.join(ends)}"
            limits = None
        if joint.kind.bounded and joint.limit.lower == joint.limit.upper:
            given = [f"{key} {number(value)}" for key, value in _rates(joint) if isfinite(value)]
            only = position(joint.limit.lower, slides=slides)
            review = f"no range: the description limits it to {only}, which exporters write for joints without limits"
            review += f"; it has {' and '.join(given)} as well" if given else ""
            limits = None
        is_universal = joint.kind is JointKind.UNIVERSAL
        has_axis = joint.kind.has_axis
        return DraftJoint(
            joint.name,
            joint.kind,
            _numbers(X_WJ),
            _letter(joint.axis) if has_axis else "z",
            vector3(X_WJ.p),
            vector3(X_WJ.turn(joint.axis)) if has_axis else None,
            confidence,
            (self._largest(joint.parent), self._largest(child)),
            review=review,
            parent=joint.parent,
            child=child,
            axis2=_letter(joint.axis2) if is_universal else None,
            direction2=vector3(X_WJ.turn(joint.axis2)) if is_universal else None,
            limits=limits,
            zero=round(q, 9) + 0.0,
            pitch=2.0 * np.pi * joint.pitch if joint.kind is JointKind.SCREW else None,
            dynamics=None if joint.kind is JointKind.FIXED else joint.dynamics,
            mimic=joint.mimic,
        )

    def _evidence(self, child: str, joint: Joint, X_WJ: Pose) -> tuple[Confidence, str]:
        facts = ["from the description"]
        is_placed = self._placement.has(child) and self._placement.has(joint.parent)
        if is_placed:
            facts.append("both links are where it puts them")
        if joint.kind is JointKind.FIXED:
            return Confidence(_KNOWN if is_placed else _PLACED, tuple(facts)), ""
        on = () if joint.kind is JointKind.BALL else self._lines.on(Axis(X_WJ.p, X_WJ.turn(joint.axis)))
        if on:
            paths = [self._assembly.components[i].path for i in on]
            facts.append(f"its axis is that of faces of {_some(paths)}")
        if joint.kind.is_hinge and not on and not is_placed:
            return Confidence(_GUESSED, tuple(facts)), "no face of the STEP is about its axis"
        if not self._placement.has(child):
            review = f"`zero`, the position as drawn: no mesh of link '{child}' was found in the STEP"
            return Confidence(_GUESSED, tuple(facts)), review
        return Confidence(_KNOWN if on and is_placed else _PLACED, tuple(facts)), ""

    def _closure(self, closure: SkeletonClosure) -> DraftClosure:
        X_WA = self._placement.poses[closure.link_a]
        direction = None if closure.axis is None else X_WA.turn(unit(closure.axis))
        point = X_WA.apply(closure.point)
        R = np.eye(3) if direction is None else perpendicular_frame(direction)
        return DraftClosure(
            closure.name or f"{closure.link_a}_{closure.link_b}",
            closure.kind,
            _numbers(Pose.of(R, point)),
            "z",
            vector3(point),
            None if direction is None else vector3(direction),
            Confidence(_PLACED, ("from the description",)),
            (self._largest(closure.link_a), self._largest(closure.link_b)),
            link_a=closure.link_a,
            link_b=closure.link_b,
        )

    def _largest(self, link: str) -> str:
        """Path of the component with the most vertices of a link, for messages."""
        components = [self._assembly.components[i] for i in self._members[link]]
        sizes = [(len(self._assembly.bodies[c.body].mesh.vertices), -c.index, c.path) for c in components]
        return max(sizes)[-1] if sizes else "."


def _is_identity(X: Pose) -> bool:
    distance, angle = X.distance_to(Pose())
    return distance < _SAME_PLACE and angle < _SAME_PLACE


def _numbers(X: Pose) -> OriginSnippet:
    xyz, rpy = np.round(X.p, 9) + 0.0, np.round(X.rpy, 12) + 0.0
    return OriginSnippet(OriginForm.XYZ, xyz=vector3(xyz), rpy=vector3(rpy))


def _letter(axis: Vector3) -> str | Vector3:
    rounded = np.round(axis, 12) + 0.0
    for e, letter in _AXES.items():
        if np.array_equal(rounded, e):
            return letter
        if np.array_equal(-rounded, e):
            return f"-{letter}"
    return vector3(rounded)


def _limits(joint: Joint) -> Limit | None:
    """The value of the description, if it has one."""
    given = joint.limit
    values = given.lower, given.upper, given.velocity, given.effort
    if joint.kind is JointKind.FIXED or not any(map(isfinite, values)):
        return None
    return given


def _rates(joint: Joint) -> tuple[tuple[str, float], ...]:
    return ("effort", joint.limit.effort), ("velocity", joint.limit.velocity)


def _rounded(inertial: MassProperties) -> MassProperties:
    """Without rounding errors of composed rotations: products of inertia to 1e-9 of the largest moment."""
    largest = float(np.abs(inertial.inertia).max())
    inertia = np.array(inertial.inertia)
    inertia[np.abs(inertia) < 1e-9 * largest] = 0.0
    return MassProperties.of(inertial.mass, (np.round(inertial.com, 9) + 0.0).tolist(), inertia)


def _some(paths: Iterable[str]) -> str:
    return listed(list(paths), 3)
