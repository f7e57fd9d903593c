"""Drafts a robot from a plain assembly: the content of ``stepbot init``."""

from collections import defaultdict
from collections.abc import Sequence

from stepbot.geometry.spatial import Vector3, vector3
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly

from .axis import Axis
from .draft import CHOSEN, Alternative, Confidence, Draft, DraftClosure, DraftJoint, DraftLink
from .evidence import Hinge
from .facts import NO_FACTS, STATED, Facts
from .inference import Inferred, infer_from
from .link_claims import LinkClaims
from .loops import Arc
from .origins import Found, Origins
from .survey import ALL_SOURCES, Sources, Survey

_OFFERED = 0.3
"""Score from which an undrafted axis is offered as a comment."""
_KNOWN_LINK, _GUESSED_LINK = 0.9, 0.6
_NAMED = 3
"""Number of guessed parts of a link that are listed for each reason."""


def infer(assembly: Assembly, robot: str, sources: Sources = ALL_SOURCES) -> Draft:
    """Draft links, joints and closures.

    Args:
        assembly: Read with its faces (``ReadOptions.faces``).
        robot: Name of the robot.
        sources: Sources of evidence besides the geometry.
    """
    return Inference(assembly, robot, sources).draft()


class Inference:
    """Drafts one assembly, and again when more is known about it; its contacts are found once."""

    def __init__(self, assembly: Assembly, robot: str, sources: Sources = ALL_SOURCES) -> None:
        self._assembly, self._robot, self._survey = assembly, robot, Survey(assembly, sources)

    def draft(self, facts: Facts = NO_FACTS) -> Draft:
        """Draft links, joints and closures from everything known."""
        return _Drafting(self._assembly, infer_from(self._survey, facts)).draft(self._robot)


class _Drafting:
    def __init__(self, assembly: Assembly, found: Inferred) -> None:
        self._assembly, self._found = assembly, found
        self._origins = Origins(assembly)
        self._link_of = {i: n for n, members in enumerate(found.links) for i in members}
        self._claims = LinkClaims(assembly, found.links, found.root)
        self._names = self._link_names()

    def draft(self, robot: str) -> Draft:
        """The inferred mechanism, as data."""
        found = self._found
        order = [found.root, *(n for n in range(len(found.links)) if n != found.root)]
        tree = [arc for arc in found.arcs if not arc.is_closure]
        loops = [arc for arc in found.arcs if arc.is_closure]
        return Draft(
            robot=robot,
            root=self._names[found.root],
            links=tuple(self._link(n) for n in order),
            joints=tuple(self._joint(arc) for arc in tree),
            closures=tuple(self._closure(arc) for arc in loops),
            offered=tuple(self._alternative(h) for h in self._offered()),
        )

    def _link(self, n: int) -> DraftLink:
        members = self._found.links[n]
        guesses = self._guesses(members)
        score = _GUESSED_LINK if guesses else _KNOWN_LINK
        is_root = n == self._found.root
        return DraftLink(
            *(self._names[n], self._claims.paths(n), Confidence(score, guesses)),
            *(is_root, tuple(members)),
        )

    def _guesses(self, members: Sequence[int]) -> tuple[str, ...]:
        """Why parts of a link were assigned to it, each reason with its parts."""
        about: dict[str, list[str]] = defaultdict(list)
        for i in members:
            if i in self._found.guesses:
                about[self._found.guesses[i]].append(f"'{self._assembly.components[i].path}'")
        return tuple(f"{why}: {_first_of(paths)}" for why, paths in about.items())

    def _joint(self, arc: Arc) -> DraftJoint:
        found, confidence, doubt = self._origin(arc)
        axis = found.axis
        h, child = arc.hinge, self._names[arc.child]
        is_universal = h.type == JointKind.UNIVERSAL and h.axis2 is not None
        return DraftJoint(
            name=f"{child}_joint",
            type=h.type,
            origin=found.snippet,
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
        )

    def _closure(self, arc: Arc) -> DraftClosure:
        found, confidence, doubt = self._origin(arc)
        axis, h = found.axis, arc.hinge
        return DraftClosure(
            name=f"{self._names[arc.parent]}_{self._names[arc.child]}",
            type=h.type,
            origin=found.snippet,
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

    def _origin(self, arc: Arc) -> tuple[Found, Confidence, str]:
        """The origin of a joint, the evidence for it, and the doubt of its faces, unless the user has stated it."""
        h = arc.hinge
        found = self._origins.of(h, self._child_part(arc))
        selected = (f"on the axis of {found.selected_by}",) if found.selected_by else ()
        is_drafted = h.score >= CHOSEN and not h.why.startswith(STATED)
        return found, Confidence(h.score, (h.why, *selected)), found.doubt if is_drafted else ""

    def _child_part(self, arc: Arc) -> int:
        """The part of a joint's evidence that moves with the child."""
        return arc.hinge.a if self._link_of[arc.hinge.a] == arc.child else arc.hinge.b

    def _alternatives(self, arc: Arc) -> tuple[Alternative, ...]:
        """Other joints found between the same two links."""
        ends = {arc.parent, arc.child}
        between = [h for h in self._found.offered if {self._link_of[h.a], self._link_of[h.b]} == ends]
        return tuple(self._alternative(h) for h in _distinct(between, [arc.hinge]))

    def _offered(self) -> list[Hinge]:
        """Joints found within one link, or between links that another path joins."""
        joined = {frozenset((arc.parent, arc.child)) for arc in self._found.arcs}
        free = [
            h
            for h in self._found.offered
            if h.score >= _OFFERED and frozenset((self._link_of[h.a], self._link_of[h.b])) not in joined
        ]
        return _distinct(free, [arc.hinge for arc in self._found.arcs if arc.hinge.type != JointKind.FIXED])

    def _alternative(self, h: Hinge) -> Alternative:
        point, direction = _point(h.axis), _direction(h.axis)
        return Alternative(h.type, *self._paths(h), Confidence(h.score, (h.why,)), point, direction)

    def _paths(self, h: Hinge) -> tuple[str, str]:
        components = self._assembly.components
        return components[h.a].path, components[h.b].path

    def _link_names(self) -> list[str]:
        """A name for each link; equal ones are numbered."""
        names: list[str] = []
        for members in self._found.links:
            base = self._claims.name([self._found.survey.parts[i] for i in members])
            name, count = base, 1
            while name in names:
                count += 1
                name = f"{base}_{count}"
            names.append(name)
        return names


def _first_of(paths: Sequence[str]) -> str:
    shown = ", ".join(paths[:_NAMED])
    return f"{shown} and {len(paths) - _NAMED} more" if len(paths) > _NAMED else shown


def _distinct(hinges: Sequence[Hinge], known: Sequence[Hinge]) -> list[Hinge]:
    """The first of each axis, without those on an axis that is already used."""
    kept: list[Hinge] = []
    for h in sorted(hinges, key=lambda h: (-round(h.score, 6), h.a, h.b)):
        if not any(h.axis.same(other.axis) and h.type == other.type for other in (*known, *kept)):
            kept.append(h)
    return kept


def _point(axis: Axis) -> Vector3:
    return vector3(axis.point)


def _direction(axis: Axis) -> Vector3 | None:
    return vector3(axis.direction) if axis.direction is not None else None
