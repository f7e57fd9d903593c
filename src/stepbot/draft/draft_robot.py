"""Drafts a robot from a plain assembly: the content of ``stepbot init``.

The origin of a joint is a mate or an axis of components where possible, since these survive CAD changes.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble.axis_evidence import doubt, face_words, faces_of_radius
from stepbot.diagnostics import listed
from stepbot.draft.answers import NO_FACTS, STATED, Facts
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.draft import (
    CHOSEN,
    Alternative,
    Confidence,
    Draft,
    DraftClosure,
    DraftJoint,
    DraftLink,
    OriginForm,
    OriginSnippet,
)
from stepbot.draft.evidence.evidence import JointEvidence
from stepbot.draft.evidence.motor_models import models
from stepbot.draft.evidence.wheels import is_wheel, rolling, wheels
from stepbot.draft.gearing import geared
from stepbot.draft.inference import InferredMechanism, infer_from
from stepbot.draft.link_claims import LinkClaims
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.draft.text.draft_names import readable_name
from stepbot.geometry.spatial import Array, Vector3, length, perpendicular_frame, rpy_from_rotation, vector3
from stepbot.robot.model import Base, JointKind
from stepbot.step.assembly import Assembly, BodyKind
from stepbot.step.features.axes import AxisFaces, AxisLine, axis_faces, is_parallel, lines, mates, selectors

_NANOMETRE = 9
_MICRORADIAN = 12


class JointOrigin(Struct, frozen=True):
    """The origin of a joint."""

    snippet: OriginSnippet
    axis: Axis
    selected_by: str = ""
    """The faces whose radius selects the line among others, in words; empty if no radius does."""
    doubt: str = ""
    """Why the faces on the line are weak evidence; empty if they are strong, or if there are none."""


class Origins:
    """Writes origins; faces are collected once per component."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._faces: dict[int, AxisFaces] = {}

    def of(self, hinge: JointEvidence, child: int) -> JointOrigin:
        """The origin of a joint, the resulting axis, and its faces; ``child`` is the part on the child's side.

        The axis of the bearing between both parts if there is one, else the mate of both if it is on the axis, else the
        axis of one of them, else numbers.
        """
        kind, axis = hinge.type, hinge.axis
        if kind == JointKind.FIXED:
            return JointOrigin(OriginSnippet(OriginForm.XYZ), axis)
        if kind == JointKind.UNIVERSAL and hinge.axis2 is not None:
            x, y = axis.d, hinge.axis2.d
            return JointOrigin(_numbers(axis.point, np.column_stack([x, y, np.cross(x, y)])), axis)
        if axis.direction is None:
            return JointOrigin(_numbers(axis.point, np.eye(3)), axis)
        parent = hinge.b if child == hinge.a else hinge.a
        bearing = ((hinge.through,),) if hinge.through >= 0 else ()
        for parts in (*bearing, (parent, child), (child,), (parent,)):
            origin = self._chosen(parts, axis, slides=kind == JointKind.PRISMATIC)
            if origin is not None:
                return origin
        return JointOrigin(_numbers(axis.point, perpendicular_frame(axis.d)), axis)

    def _chosen(self, parts: Sequence[int], axis: Axis, *, slides: bool) -> JointOrigin | None:
        """The line of one component, or the mate of two, on the axis, with its selector among all lines."""
        faces = [self._of(part) for part in parts]
        candidates = mates(faces[0], faces[1]) if len(faces) == 2 else lines(faces[0])
        form = OriginForm.MATE if len(faces) == 2 else OriginForm.AXIS_OF
        for line, selector in zip(candidates, selectors(candidates) if candidates else (), strict=True):
            own = Axis(np.array(line.point), np.array(line.direction))
            if own.same(axis):
                snippet = OriginSnippet(form, tuple(map(self._path, parts)), selector.radius, selector.near)
                others = [one for one in self._matching(faces, selector.radius) if one.point != line.point]
                if slides:
                    others = [other for other in others if not is_parallel(other, line)]
                return JointOrigin(snippet, own, self._selected_by(line, selector.radius), doubt(line, others))
        return None

    def _matching(self, faces: Sequence[AxisFaces], radius: float | None) -> tuple[AxisLine, ...]:
        """The lines that an origin with this radius is chosen among."""
        return mates(faces[0], faces[1], radius) if len(faces) == 2 else lines(faces[0], radius)

    def _selected_by(self, line: AxisLine, radius: float | None) -> str:
        """The faces of the radius that selects a line, in words; empty without a radius."""
        faces = faces_of_radius(line, radius)
        return " and ".join(dict.fromkeys(f"{face_words(face)} of '{self._path(face.component)}'" for face in faces))

    def _path(self, part: int) -> str:
        return self._assembly.components[part].path

    def _of(self, part: int) -> AxisFaces:
        if part not in self._faces:
            self._faces[part] = axis_faces(self._assembly, [part])
        return self._faces[part]


def _numbers(point: Array, R: Array) -> OriginSnippet:
    xyz = vector3(np.round(point, _NANOMETRE) + 0.0)
    rpy = vector3(np.round(rpy_from_rotation(R), _MICRORADIAN) + 0.0)
    return OriginSnippet(OriginForm.XYZ, xyz=xyz, rpy=rpy)


_OFFERED = 0.3
"""Score from which an undrafted axis is offered as a comment."""
_KNOWN_LINK, _GUESSED_LINK = 0.9, 0.6
_ROUGHLY = 3.0
"""How far a screw may be from turned, in tolerances of a turned part."""
_SCREW = 2e-3
"""Share of the volume below which a part that turns about its own axis of symmetry is taken for a fastener."""
_NAMED = 3
"""Number of guessed parts of a link that are listed for each reason."""


def infer(assembly: Assembly, robot: str, sources: Sources = ALL_SOURCES) -> Draft:
    """Draft links, joints and closures.

    Args:
        assembly: Read with its faces (``ReadOptions.faces``).
        sources: Sources of evidence besides the geometry.
    """
    return Inference(assembly, robot, sources).draft()


class Inference:
    """Drafts one assembly, and again when more is known about it; its contacts are found once."""

    def __init__(self, assembly: Assembly, robot: str, sources: Sources = ALL_SOURCES) -> None:
        self._assembly, self._robot, self._survey = assembly, robot, Survey.settled(assembly, sources)

    def draft(self, facts: Facts = NO_FACTS) -> Draft:
        """Draft links, joints and closures from everything known."""
        return _Drafting(self._assembly, infer_from(self._survey, facts)).draft(self._robot)


class _Drafting:
    def __init__(self, assembly: Assembly, inferred: InferredMechanism) -> None:
        self._assembly, self._inferred = assembly, inferred
        self._origins = Origins(assembly)
        self._link_of = {i: n for n, members in enumerate(inferred.links) for i in members}
        self._claims = LinkClaims(assembly, inferred.links, inferred.root)
        self._wheels = wheels(inferred.survey)
        self._drawn: list[str] = []
        self._names = self._link_names()

    def draft(self, robot: str) -> Draft:
        """The inferred mechanism, as data."""
        inferred = self._inferred
        order = [inferred.root, *(n for n in range(len(inferred.links)) if n != inferred.root)]
        tree = [arc for arc in inferred.arcs if not arc.is_closure]
        loops = [arc for arc in inferred.arcs if arc.is_closure]
        return Draft(
            robot=robot,
            root=self._names[inferred.root],
            links=tuple(self._link(n) for n in order),
            joints=geared(self._inferred, tree, [self._joint(arc) for arc in tree]),
            closures=tuple(self._closure(arc) for arc in loops),
            offered=tuple(self._fused(h) for h in self._offered()),
            notes=(*self._stillness(), *self._drawn_off(), *inferred.survey.cut),
            base=Base.FLOATING if self._rolls(tree) and self._has_mass(inferred.root) else Base.FIXED,
        )

    def _stillness(self) -> tuple[str, ...]:
        """Why nothing moves, if nothing does."""
        if any(arc.evidence.type != JointKind.FIXED and arc.evidence.score >= CHOSEN for arc in self._inferred.arcs):
            return ()
        lines = len({(h.a, h.b) for h in self._inferred.offered})
        kinds = [
            self._assembly.bodies[component.body].kind for component in self._assembly.components if component.body >= 0
        ]
        meshes = kinds.count(BodyKind.TESSELLATED)
        why = "no two parts share an axis about or along which only they could move"
        if len(kinds) == 1:
            why = "the file has one body, and a link consists of whole ones"
        elif lines:
            pairs = "1 pair of parts shares" if lines == 1 else f"{lines} pairs of parts share"
            why = f"{pairs} an axis, but other evidence holds them together"
        elif meshes:
            why = f"{meshes} of {len(kinds)} bodies are triangles, which have no axes"
        return (f"no moving parts found: {why}",)

    def _drawn_off(self) -> tuple[str, ...]:
        """The parts that are drawn off what they fit."""
        survey = self._inferred.survey
        moved = [i for i in survey.moved if i not in survey.small]
        if not moved:
            return ()
        far = max(length(survey.moved[i].apply(survey.parts[i].com) - survey.parts[i].com) for i in moved)
        paths = listed([survey.parts[i].path for i in moved], _NAMED)
        return (f"drawn up to {1e3 * far:.2g} mm off what they fit, and compared as if in place: {paths}",)

    def _rolls(self, tree: Sequence[TreeJoint]) -> bool:
        """Whether nothing fixes the root to the ground: two wheels turn on it, or on any links what all stands on."""
        turning = [arc for arc in tree if self._is_wheel(arc, self._wheels)]
        if len(turning) < 2 or len([arc for arc in turning if arc.parent == self._inferred.root]) > 1:
            return len(turning) > 1
        standing = dict(rolling(self._inferred.survey))
        return len([arc for arc in turning if self._is_wheel(arc, standing)]) > 1

    def _is_wheel(self, arc: TreeJoint, known: Collection[int]) -> bool:
        """Whether a joint turns one of the known wheels about its axis of symmetry."""
        if arc.evidence.type != JointKind.REVOLUTE or arc.evidence.score < CHOSEN:
            return False
        return is_wheel(self._inferred.survey, known, self._inferred.links[arc.child], arc.evidence.axis)

    def _fused(self, h: JointEvidence) -> Alternative:
        """A joint within a link, with the part that it would free and what holds that part."""
        alternative = self._alternative(h)
        link = self._link_of[h.a]
        parts = self._inferred.survey.parts
        if link != self._link_of[h.b] or parts[h.a].is_small or parts[h.b].is_small:
            return alternative
        moving = min((h.a, h.b), key=lambda i: (parts[i].volume, -i))
        if Role.MOTOR in parts[moving].roles and not h.drives:
            return alternative  # it shares a hole for a screw with what carries it
        if parts[moving].volume < _SCREW * self._inferred.survey.volume and parts[moving].is_balanced(h.axis, _ROUGHLY):
            return alternative  # a screw without a name
        welds = [weld for weld in self._inferred.welds if (weld.a, weld.b) == (min(h.a, h.b), max(h.a, h.b))]
        held = max(welds, key=lambda weld: weld.score).why if welds else "other parts of the link hold both"
        freed = LinkClaims.name(self._claims, [parts[moving]])[0]
        return replace(
            alternative, link=self._names[link], moving=self._assembly.components[moving].path, held=held, freed=freed
        )

    def _link(self, n: int) -> DraftLink:
        members = self._inferred.links[n]
        guesses = self._guesses(members)
        score = _GUESSED_LINK if guesses else _KNOWN_LINK
        is_root = n == self._inferred.root
        return DraftLink(
            *(self._names[n], self._claims.paths(n), Confidence(score, guesses)),
            *(is_root, tuple(members)),
            drawn=self._drawn[n],
        )

    def _guesses(self, members: Sequence[int]) -> tuple[str, ...]:
        """Why parts of a link were assigned to it, each reason with its parts."""
        about: dict[str, list[str]] = defaultdict(list)
        for i in members:
            if i in self._inferred.guesses:
                about[self._inferred.guesses[i]].append(self._assembly.components[i].path)
        return tuple(f"{why}: {listed(paths, _NAMED)}" for why, paths in about.items())

    def _joint(self, arc: TreeJoint) -> DraftJoint:
        joint = self._moving_joint(arc)
        if joint.type is JointKind.FIXED or not joint.confidence.is_chosen or self._has_mass(arc.child):
            return joint
        weightless = f"nothing in '{joint.child}' encloses a volume: it needs an `inertial` to move"
        motion = Alternative(joint.type, *joint.parts, joint.confidence, joint.point, joint.direction)
        others = (motion, *joint.alternatives)
        return replace(joint, type=JointKind.FIXED, alternatives=others, review=weightless, doubt="", motor="")

    def _has_mass(self, n: int) -> bool:
        """Whether a link has a body that a robot can be built with: engines have no moving links without mass."""
        components = self._assembly.components
        return any(self._assembly.bodies[components[i].body].has_volume for i in self._inferred.links[n])

    def _moving_joint(self, arc: TreeJoint) -> DraftJoint:
        origin, confidence, doubt = self._origin(arc)
        axis = origin.axis
        h, child = self._as_drawn(arc.evidence), self._names[arc.child]
        is_universal = h.type == JointKind.UNIVERSAL and h.axis2 is not None
        return DraftJoint(
            name=f"{child}_joint",
            type=JointKind.CONTINUOUS if self._is_wheel(arc, self._wheels) else h.type,
            origin=origin.snippet,
            axis="x" if is_universal else "z",
            point=_point(axis),
            direction=_direction(axis),
            confidence=confidence,
            parts=self._paths(h),
            alternatives=self._alternatives(arc),
            review=h.review,
            doubt=doubt,
            parent=self._names[arc.parent],
            child=child,
            axis2="y" if is_universal else None,
            direction2=_direction(h.axis2) if h.axis2 is not None else None,
            motor=h.motor,
            models=models(self._assembly, h.motor) if h.motor else None,
        )

    def _closure(self, arc: TreeJoint) -> DraftClosure:
        origin, confidence, doubt = self._origin(arc)
        axis, h = origin.axis, arc.evidence
        return DraftClosure(
            name=f"{self._names[arc.parent]}_{self._names[arc.child]}",
            type=h.type,
            origin=origin.snippet,
            axis="z",
            point=_point(axis),
            direction=_direction(axis),
            confidence=confidence,
            parts=self._paths(h),
            alternatives=self._alternatives(arc),
            review=h.review,
            doubt=doubt,
            link_a=self._names[arc.parent],
            link_b=self._names[arc.child],
        )

    def _origin(self, arc: TreeJoint) -> tuple[JointOrigin, Confidence, str]:
        """The origin of a joint, the evidence for it, and the doubt of its faces, unless the user has stated it."""
        h = self._as_drawn(arc.evidence)
        origin = self._origins.of(h, h.a if self._link_of[h.a] == arc.child else h.b)
        selected = (f"on the axis of {origin.selected_by}",) if origin.selected_by else ()
        is_drafted = h.score >= CHOSEN and not h.why.startswith(STATED)
        return origin, Confidence(h.score, (h.why, *selected)), origin.doubt if is_drafted else ""

    def _as_drawn(self, h: JointEvidence) -> JointEvidence:
        """The evidence with its axes where the parts are drawn."""
        axes = [axis and self._inferred.survey.as_drawn(axis, (h.a, h.b)) for axis in (h.axis, h.axis2)]
        return replace(h, axis=axes[0] or h.axis, axis2=axes[1])

    def _alternatives(self, arc: TreeJoint) -> tuple[Alternative, ...]:
        """Other joints found between the same two links."""
        between = self._offered_between.get(frozenset((arc.parent, arc.child)), ())
        return tuple(self._alternative(h) for h in _distinct(between, [arc.evidence]))

    @cached_property
    def _offered_between(self) -> Mapping[frozenset[int], Sequence[JointEvidence]]:
        """Joints found, by their links."""
        between = defaultdict[frozenset[int], list[JointEvidence]](list)
        for h in self._inferred.offered:
            between[frozenset((self._link_of[h.a], self._link_of[h.b]))].append(h)
        return between

    def _offered(self) -> list[JointEvidence]:
        """Joints found within one link, or between links that another path joins."""
        joined = {frozenset((arc.parent, arc.child)) for arc in self._inferred.arcs}
        free = [
            h
            for h in self._inferred.offered
            if h.score >= _OFFERED and frozenset((self._link_of[h.a], self._link_of[h.b])) not in joined
        ]
        return _distinct(free, [arc.evidence for arc in self._inferred.arcs if arc.evidence.type != JointKind.FIXED])

    def _alternative(self, h: JointEvidence) -> Alternative:
        axis = self._inferred.survey.as_drawn(h.axis, (h.a, h.b))
        return Alternative(h.type, *self._paths(h), Confidence(h.score, (h.why,)), _point(axis), _direction(axis))

    def _paths(self, h: JointEvidence) -> tuple[str, str]:
        components = self._assembly.components
        return components[h.a].path, components[h.b].path

    def _link_names(self) -> list[str]:
        """A name for each link; equal ones are numbered."""
        names: list[str] = []
        for n, members in enumerate(self._inferred.links):
            parts = [self._inferred.survey.parts[i] for i in members]
            base, drawn = self._claims.name(parts, is_root=n == self._inferred.root)
            self._drawn.append("" if readable_name(drawn) == base else drawn)
            name, count = base, 1
            while name in names:
                count += 1
                name = f"{base}_{count}"
            names.append(name)
        return names


def _distinct(hinges: Sequence[JointEvidence], known: Sequence[JointEvidence]) -> list[JointEvidence]:
    """The first of each axis, without those on an axis that is already used."""
    kept: list[JointEvidence] = []
    for h in sorted(hinges, key=lambda h: (-round(h.score, 6), h.a, h.b)):
        if not any(h.axis.same(other.axis) and h.type == other.type for other in (*known, *kept)):
            kept.append(h)
    return kept


def _point(axis: Axis) -> Vector3:
    return vector3(axis.point)


def _direction(axis: Axis) -> Vector3 | None:
    return vector3(axis.direction) if axis.direction is not None else None
