"""Poses of joints, closures and frames in the assembly: every form of ``origin``.

All poses are as drawn, where each joint is at its ``zero``. The origin of a joint gives the joint's frame J, which is
fixed to the parent. The child's frame coincides with J at q = 0, so as drawn it is J moved by ``zero``. The root's
frame is the assembly's, unless the sidecar gives another, or the directions that point up and forward.
"""

from collections.abc import Iterable, Sequence

from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.inertia import rotation_of
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.joint_table import Basis, Evidence
from stepbot.robot.kinematics import displacement
from stepbot.robot.model import Joint, JointKind
from stepbot.sidecar.draft_comments import drafted_reviews
from stepbot.sidecar.origins import (
    AutoOrigin,
    AxisOrigin,
    CenterOrigin,
    ComponentOrigin,
    ExplicitOrigin,
    MateOrigin,
    Origin,
)
from stepbot.sidecar.tree import Keys
from stepbot.step.features.axes import (
    AxisFaces,
    AxisLine,
    Choice,
    axis_faces,
    choose,
    line_frame,
    lines,
    mates,
    millimetres,
    near_misses,
    selector,
    selectors,
)
from stepbot.step.structure.paths import quoted

from .axis_evidence import CENTRE, described, evidence_of, off_centre, radii_of
from .binder import Binder, listed
from .claims import Claims

ASSEMBLY = "assembly"
"""The name of the STEP's frame in ``relative_to``."""

_SHOWN_MISSES = 5
_SHOWN_PARENTS = 2


class OriginRequest(Struct, frozen=True):
    """The element whose origin is resolved."""

    keys: Keys
    links: tuple[str, str] | None = None
    """The two links whose parts ``auto`` compares; None if there are not exactly two."""
    direction_only: bool = False
    """Whether parallel lines are equivalent, as for a prismatic joint."""
    is_rigid: bool = False
    """Whether any frame will do, as for a fixed joint."""
    is_ball: bool = False
    """Whether the place on a line matters, too."""

    @property
    def link_words(self) -> tuple[str, str]:
        """The two links, for messages."""
        assert self.links is not None  # the sidecar's own check rejects `auto` without two links
        return f"link '{self.links[0]}'", f"link '{self.links[1]}'"


class Frames:
    """Resolves each origin to a pose in the assembly, once, and reports those it cannot resolve."""

    def __init__(self, binder: Binder, claims: Claims, root: str) -> None:
        self._binder = binder
        self._claims = claims
        self._root = root
        self._joint_above = {joint.child: name for name, joint in binder.document.joints.items()}
        self._links: dict[str, Pose | None] = {}
        self._joints: dict[str, Pose | None] = {}
        self._waiting: list[str] = []
        self._evidence: dict[Keys, Evidence] = {}
        self._faces: dict[str, AxisFaces] = {}
        self._unreviewed: frozenset[str] | None = None

    def link(self, name: str) -> Pose | None:
        """X_WL as drawn; None after a diagnostic."""
        if name not in self._links:
            if name in self._waiting:
                self._report_circle(name)
                self._links[name] = None
                return None
            self._waiting.append(name)
            pose = self._root_frame() if name == self._root else self._child_frame(self._joint_above[name])
            self._waiting.pop()
            self._links.setdefault(name, pose)
        return self._links[name]

    def joint(self, name: str) -> Pose | None:
        """X_WJ of a joint's own frame, fixed to its parent; None after a diagnostic."""
        self.link(self._binder.document.joints[name].child)
        return self._joints.get(name)

    def evidence(self, *keys: str) -> Evidence:
        """How the origin at a place of the sidecar was found."""
        return self._evidence.get(keys, Evidence(Basis.GIVEN))

    def _child_frame(self, name: str) -> Pose | None:
        joint = self._binder.document.joints[name]
        slides, rigid, ball = (joint.type is kind for kind in (JointKind.PRISMATIC, JointKind.FIXED, JointKind.BALL))
        request = OriginRequest(("joints", name, "origin"), (joint.parent, joint.child), slides, rigid, ball)
        X_WJ = self.resolve(joint.origin, request)
        self._joints[name] = X_WJ
        if X_WJ is None:
            return None
        moved = Joint(name, joint.type, joint.parent, joint.child, axis=joint.axis, pitch=joint.pitch or 0.0)
        # the sidecar's own check rejects `zero` for other joint types
        return X_WJ @ displacement(moved, joint.zero.value)

    def resolve(self, origin: Origin, request: OriginRequest) -> Pose | None:
        """X_WF of the frame that an origin gives; None after a diagnostic."""
        pose = self._base(AutoOrigin() if isinstance(origin, str) else origin, request)
        offset = None if isinstance(origin, str) else origin.offset
        if pose is None or offset is None:
            return pose
        evidence = self._evidence[request.keys]
        self._evidence[request.keys] = replace(evidence, text=f"{evidence.text}; moved by its offset")
        return pose @ Pose.from_xyz_rpy(offset.xyz, offset.rpy)

    def _base(self, origin: Origin, request: OriginRequest) -> Pose | None:
        """The frame before the offset."""
        if isinstance(origin, ExplicitOrigin):
            self._give(request, f"numbers, relative to {quoted(origin.relative_to)}")
            X_WR = self._reference(origin.relative_to, (*request.keys, "relative_to"))
            return None if X_WR is None else X_WR @ Pose.from_xyz_rpy(origin.xyz, origin.rpy)
        if isinstance(origin, ComponentOrigin):
            self._give(request, f"the frame of component {quoted(origin.component)}")
            return self._component(origin.component, (*request.keys, "component"))
        if isinstance(origin, CenterOrigin):
            return self._center(origin, request)
        if isinstance(origin, AxisOrigin):
            return self._axis(origin, request)
        if isinstance(origin, MateOrigin):
            return self._mate(origin, request)
        assert isinstance(origin, AutoOrigin)
        return self._auto(origin, request)

    def _root_frame(self) -> Pose | None:
        root = self._binder.document.root
        if root is None:
            return IDENTITY
        pose = IDENTITY if root.frame is None else self.resolve(root.frame, OriginRequest(("root", "frame")))
        return pose if pose is None or root.axes is None else Pose.of(rotation_of(*root.axes), pose.p)

    def _reference(self, name: str, keys: Keys) -> Pose | None:
        if name == ASSEMBLY:
            return IDENTITY
        links = self._binder.document.links
        return self.link(name) if name in links else self._component(name, keys, (ASSEMBLY, *links))

    def _component(self, pattern: str, keys: Keys, other_names: Iterable[str] = ()) -> Pose | None:
        index = self._binder.one(pattern, keys, other_names)
        return None if index is None else self._binder.assembly.components[index].X_WC

    def _center(self, origin: CenterOrigin, request: OriginRequest) -> Pose | None:
        keys, words = (*request.keys, "center"), f"the centre of the box around {quoted(origin.center)}"
        index = self._binder.one(origin.center, keys)
        if index is None:
            return None
        box = self._binder.assembly.bounds(index)
        if box is None:
            self._binder.report("SB404", keys, f"'{origin.center}' has no geometry and therefore no centre")
            return None
        self._give(request, words, off_centre(box) if request.is_ball and origin.offset is None else "")
        return Pose.of(position=[0.5 * (low + high) for low, high in zip(*box, strict=True)])

    def _axis(self, origin: AxisOrigin, request: OriginRequest) -> Pose | None:
        index = self._binder.one(origin.axis_of, (*request.keys, "axis_of"))
        if index is None:
            return None
        axes = lines(self._component_faces(index), origin.radius)
        choice = choose(axes, origin.near, direction_only=request.direction_only, selected=origin.radius is not None)
        if choice.line is not None:
            return self._on(choice.line, axes, "axis", origin, request)
        start = f"{{axis_of: {quoted(origin.axis_of)}"
        if choice.rivals:
            self._report_rivals(request, f"'{origin.axis_of}' has", choice, axes, start)
        else:
            with_radius = f" of radius {millimetres(origin.radius)}" if origin.radius is not None else ""
            self._report_none(request, f"'{origin.axis_of}' has no cylinder or cone{with_radius}")
        return None

    def _mate(self, origin: MateOrigin, request: OriginRequest) -> Pose | None:
        indices = [self._binder.one(p, (*request.keys, "mate", i)) for i, p in enumerate(origin.mate)]
        if indices[0] is None or indices[1] is None:
            return None
        a, b = self._component_faces(indices[0]), self._component_faces(indices[1])
        words = (f"'{origin.mate[0]}'", f"'{origin.mate[1]}'")
        return self._shared(a, b, words, origin, request, f"{{mate: [{', '.join(map(quoted, origin.mate))}]")

    def _auto(self, origin: AutoOrigin, request: OriginRequest) -> Pose | None:
        words = request.link_words
        assert request.links is not None
        if any(link in self._claims.incomplete for link in request.links):
            return None  # the link's parts are unknown; the unresolved path has been reported
        for link, word in zip(request.links, words, strict=True):
            if not self._claims.parts_of(link):
                message = f"{word} has no parts, so `auto` cannot find an axis"
                help = (
                    f"add `parts` to {word}, or name a component of the other link with a cylindrical face: "
                    "`origin: {axis_of: PATH}`",
                    "or give coordinates: `origin: {xyz: [0, 0, 0]}`",
                )
                self._binder.report("SB405", request.keys, message, help=help)
                return None
        a, b = (self._link_faces(link) for link in request.links)
        if request.is_rigid and origin.radius is None and origin.near is None:
            return self._anywhere(a, b, words, origin, request)
        return self._shared(a, b, words, origin, request, "{auto: true")

    def _anywhere(
        self, a: AxisFaces, b: AxisFaces, words: tuple[str, str], origin: AutoOrigin, request: OriginRequest
    ) -> Pose | None:
        """The frame of a joint that does not move: on the line of both sides if there is one, else the parent's."""
        assert request.links is not None
        anywhere = mates(a, b, None)
        line = choose(anywhere).line
        if line is not None:
            pose = self._on(line, anywhere, f"axis that {words[0]} and {words[1]} share", origin, request)
            self._evidence[request.keys] = replace(self._evidence[request.keys], doubt="")
            return pose
        self._give(request, f"the frame of {words[0]}, since a fixed joint needs no axis")
        return self.link(request.links[0])

    def _shared(
        self,
        a: AxisFaces,
        b: AxisFaces,
        words: tuple[str, str],
        origin: MateOrigin | AutoOrigin,
        request: OriginRequest,
        start: str,
    ) -> Pose | None:
        """The frame on a line shared by two sides."""
        shared = mates(a, b, origin.radius)
        choice = choose(shared, origin.near, direction_only=request.direction_only, selected=origin.radius is not None)
        if choice.line is not None:
            pose = self._on(choice.line, shared, f"axis that {words[0]} and {words[1]} share", origin, request)
            self._report_doubt(request, choice.line, shared, start)
            return pose
        if choice.rivals and all(line.basis is Basis.APART for line in choice.rivals):
            self._report_apart(request, words, choice, shared, start)
        elif choice.rivals:
            self._report_rivals(request, f"{words[0]} and {words[1]} share", choice, shared, start)
        else:
            with_radius = f" of radius {millimetres(origin.radius)}" if origin.radius is not None else ""
            self._report_misses(request, f"{words[0]} and {words[1]} share no axis{with_radius}", a, b)
        return None

    def _give(self, request: OriginRequest, text: str, doubt: str = "") -> None:
        self._evidence[request.keys] = Evidence(Basis.GIVEN, text, doubt=doubt)

    def _on(
        self,
        line: AxisLine,
        lines: Sequence[AxisLine],
        words: str,
        origin: AxisOrigin | MateOrigin | AutoOrigin,
        request: OriginRequest,
    ) -> Pose:
        """The frame on a line that was found, and a note that names the line."""
        self._evidence[request.keys] = evidence_of(
            line,
            lines,
            words,
            self._binder.path,
            selected=origin.radius is not None or origin.near is not None,
            radius=origin.radius,
            confirmed=not self._is_draft(request.keys),
            direction_only=request.direction_only,
            is_ball=request.is_ball and origin.offset is None,
        )
        return line_frame(line)

    def _is_draft(self, keys: Keys) -> bool:
        """Whether an origin is that of a draft, with a REVIEW that nobody has removed."""
        if self._unreviewed is None:
            reviews = drafted_reviews(self._binder.sidecar.text)
            self._unreviewed = frozenset(name for name, review in reviews.items() if review)
        return keys[0] in ("joints", "closures") and keys[1] in self._unreviewed

    def _component_faces(self, index: int) -> AxisFaces:
        return axis_faces(self._binder.assembly, self._binder.assembly.subtree(index))

    def _link_faces(self, link: str) -> AxisFaces:
        if link not in self._faces:
            self._faces[link] = axis_faces(self._binder.assembly, self._claims.parts_of(link))
        return self._faces[link]

    def _report_rivals(
        self, request: OriginRequest, words: str, choice: Choice, lines: Sequence[AxisLine], start: str
    ) -> None:
        offered = dict(zip(lines, selectors(lines), strict=True))
        several = "directions" if request.direction_only else "axes"
        self._binder.report(
            "SB402",
            request.keys,
            f"{words} {len(choice.rivals)} {several}, none of them twice as wide as the next",
            help=listed(tuple(f"origin: {start}{offered[line]}}}" for line in choice.rivals)),
            notes=listed(tuple(described(line, self._binder.path) for line in choice.rivals)),
        )

    def _report_apart(
        self, request: OriginRequest, words: tuple[str, str], choice: Choice, lines: Sequence[AxisLine], start: str
    ) -> None:
        """Report lines with faces of both sides that do not touch."""
        rivals = choice.rivals
        several = f"{len(rivals)} lines" if len(rivals) > 1 else "one line"
        remedies = tuple(f"origin: {start}{selector(line, lines)}}}" for line in rivals)
        self._binder.report(
            "SB406",
            request.keys,
            f"{words[0]} and {words[1]} have faces on {several}, but no shaft in a bore and no touching faces",
            help=(*(CENTRE if request.is_ball else ()), *listed(remedies)),
            notes=listed(tuple(described(line, self._binder.path) for line in rivals)),
        )

    def _report_doubt(self, request: OriginRequest, line: AxisLine, lines: Sequence[AxisLine], start: str) -> None:
        """Warn of an axis chosen on weak evidence, and give the origins that select it or another line."""
        evidence = self._evidence[request.keys]
        if not evidence.doubt:
            return
        others = [other for other in lines if other is not line and other.basis is not Basis.APART]
        shown = [line, *others[:_SHOWN_MISSES]]
        remedies = [f"origin: {start}{selector(one, lines)}}}" for one in (shown[1:] if evidence.selected else shown)]
        remedies[:0] = CENTRE if request.is_ball else ()
        if self._is_draft(request.keys):
            confirm = "its origin is right" if evidence.selected else "one of these is right and in the sidecar"
            remedies.insert(0, f"if {confirm}, remove the REVIEW comment of the draft above it")
        self._binder.report(
            "SB407",
            request.keys,
            f"weak evidence for its axis: {evidence.doubt}",
            help=tuple(remedies),
            notes=tuple(described(one, self._binder.path) for one in shown),
        )

    def _report_misses(self, request: OriginRequest, message: str, a: AxisFaces, b: AxisFaces) -> None:
        misses = near_misses(a, b)[:_SHOWN_MISSES]
        notes = []
        for miss in misses:
            tilt = f" and {miss.angle * 1e3:.3g} mrad" if miss.angle > 1e-6 else ""
            sides = [
                f"{quoted(self._binder.path(line.components[0]))} ({radii_of(line)})"
                for line in (miss.line_a, miss.line_b)
            ]
            notes.append(f"{millimetres(miss.distance)}{tilt} apart: {sides[0]} and {sides[1]}")
        snippets = [self._axis_snippet(line) for miss in misses[:1] for line in (miss.line_a, miss.line_b)]
        others = snippets or ["write the origin with `axis_of`, `center`, `component` or numbers"]
        help = CENTRE if request.is_ball else (*self._other_parents(request), *others)
        self._report_none(request, message, help, tuple(notes))

    def _other_parents(self, request: OriginRequest) -> list[str]:
        """Links with a shaft in a bore of the child's, or the reverse: one of them may be its parent."""
        if request.links is None or request.keys[0] != "joints":
            return []
        child = request.links[1]
        below = {joint.child for joint in self._binder.document.joints.values() if joint.parent == child}
        parents = []
        for link in self._binder.document.links:
            if link in request.links or link in below:
                continue
            line = choose(mates(self._link_faces(link), self._link_faces(child), None)).line
            if line is not None and line.basis is Basis.FIT:
                parents.append(f"link '{link}' and link '{child}' share an axis: `parent: {link}`, if it carries it")
        return parents[:_SHOWN_PARENTS]

    def _axis_snippet(self, line: AxisLine) -> str:
        """The origin that selects one line of the component it belongs to."""
        index = line.components[0]
        candidates = lines(axis_faces(self._binder.assembly, [index]))
        nearest = min(range(len(candidates)), key=lambda i: candidates[i].distance_to(line.point))
        return f"origin: {{axis_of: {quoted(self._binder.path(index))}{selectors(candidates)[nearest]}}}"

    def _report_none(
        self, request: OriginRequest, message: str, help: tuple[str, ...] = (), notes: tuple[str, ...] = ()
    ) -> None:
        self._binder.report("SB401", request.keys, message, help=help, notes=notes)

    def _report_circle(self, name: str) -> None:
        circle = [*self._waiting[self._waiting.index(name) :], name]
        joint = self._joint_above.get(name)
        keys: Keys = ("joints", joint, "origin") if joint is not None else ("root", "frame")
        depends = " depends on ".join(f"link '{link}'" for link in circle)
        self._binder.report("SB403", keys, f"circular origin reference: {depends}")
