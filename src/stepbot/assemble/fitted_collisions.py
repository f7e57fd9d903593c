"""Collision shapes that a worker computes: fits to the solids of links, and their scores.

Those of ``auto`` and ``decompose`` are requested for all links at once, from the cache or a worker.
A link's components without a rule of their own are one solid, given in the frame of the first of them; a component with
a rule is a solid of its own, shared by all occurrences of its body. Neither depends on joints, so editing them does not
change a shape or its cache key.
"""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.solids.collision_scores import NO_SCORE, CollisionScore, UnscoredSolids, collision_scores
from stepbot.geometry.solids.collision_sets import CollisionRequest, CollisionSet, collision_sets
from stepbot.geometry.solids.primitive_fits import RoundFace
from stepbot.geometry.solids.unions import PlacedShape, PlacedSolid
from stepbot.geometry.spatial import IDENTITY, Pose, tidy
from stepbot.report.robot import LinkCollision, MeasuredBody
from stepbot.robot.model import Geometry, Link, MeshRef, Robot
from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.sidecar.document import Document
from stepbot.sidecar.shapes import CollisionShape
from stepbot.step.assembly import Assembly, AxisFace, Component

from .binder import Binder
from .claims import Claims
from .collision_rules import CollisionRule, is_merged, link_rule, part_rule
from .material_assignment import MaterialAssignment

_SHAFTS = 24
"""Number of cylindrical faces of a solid that primitives are fitted to, the largest ones."""


class JoinedComponents(Struct, frozen=True):
    """Components whose solids get one set of shapes."""

    components: tuple[int, ...]
    """Indices; the first one's frame is that of the shapes."""
    rule: CollisionRule


class FittedCollisions:
    """The sets of shapes of a robot."""

    def __init__(
        self,
        binder: Binder,
        claims: Claims,
        assignments: Sequence[MaterialAssignment],
        bodies: Sequence[MeasuredBody],
        cache: Cache | None,
        process: Worker | None,
    ) -> None:
        """Look the sets up in the cache or start to compute them; returns at once.

        Args:
            assignments: The sidecar's settings for each component.
            process: An idle worker of :mod:`stepbot.geometry.mesh_worker`; None to compute in this process.
        """
        wanted = {
            joined: _wanted(binder.assembly, joined, bodies, others)
            for joined, others in _all_joined(binder, claims, assignments).items()
        }
        self._sets = ResultsByContent(cache, "collision set", wanted, (CollisionRequest, CollisionSet))
        self._process: Worker | None = None
        if self._sets.missing and process is not None:
            self._process = process.submit("collisions", self._sets.missing, more=True)

    def wait(self, timeout: float = DEFAULT_TIMEOUT) -> None:
        """Wait for the sets; afterwards the worker is idle again.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
        """
        missing = self._sets.missing
        if missing:
            self._sets.add(collision_sets(missing) if self._process is None else self._process.result(timeout))

    def of(self, joined: JoinedComponents) -> CollisionSet:
        """The shapes of components, in the frame of the first."""
        return self._sets[joined]

    def get(self, joined: JoinedComponents) -> CollisionSet | None:
        """The same; None for components that were not joined."""
        return self._sets.get(joined)


def closed_parts(assembly: Assembly, indices: Sequence[int]) -> tuple[int, ...]:
    """Those of components whose meshes are closed."""
    return tuple(index for index in indices if _is_closed(assembly, index))


def missing_volume(components: Sequence[Component], bodies: Sequence[MeasuredBody]) -> float:
    """Exact volume [m^3] of components, minus that of their meshes."""
    measured = [bodies[component.body] for component in components]
    return exact_sum(
        body.used.mass - body.mesh.mass for body in measured if body.used is not None and body.mesh is not None
    )


def joined_parts(assembly: Assembly, indices: Sequence[int], rule: CollisionRule) -> JoinedComponents | None:
    """The closed solids among components; None without any."""
    closed = closed_parts(assembly, indices)
    return JoinedComponents(closed, rule) if closed else None


def joined_part(assembly: Assembly, index: int, rule: CollisionRule) -> JoinedComponents | None:
    """A component with a rule of its own, as the first occurrence of its body; None if it is not closed."""
    first = assembly.first_of_body[assembly.components[index].body]
    return JoinedComponents((first,), rule) if _is_closed(assembly, index) else None


def _is_closed(assembly: Assembly, index: int) -> bool:
    body = assembly.bodies[assembly.components[index].body]
    return body.watertight and len(body.mesh.faces) > 0


class _Others(Struct, frozen=True):
    """What else a link has."""

    beside: tuple[int, ...] = ()
    """Components under the same rule."""
    is_all: bool = False
    """Whether there are no others."""


def _all_joined(
    binder: Binder, claims: Claims, assignments: Sequence[MaterialAssignment]
) -> dict[JoinedComponents, _Others]:
    """All sets, and what is beside each in its link."""
    assembly, document = binder.assembly, binder.document
    joined: dict[JoinedComponents, _Others] = {}
    for link in document.links:
        whole = []
        for index in claims.parts_of(link):
            rule = part_rule(assignments[index].collision, assignments[index].contact, link, document)
            if rule is None:
                whole.append(index)
                continue
            if rule.is_decomposed and (one := joined_part(assembly, index, rule)) is not None:
                joined.setdefault(one, _Others())
        common = link_rule(link, document)
        if common is not None and common.is_decomposed:
            several = joined_parts(assembly, whole, common)
            if several is not None:
                beside = tuple(index for index in whole if index not in several.components)
                joined[several] = _Others(beside, len(whole) == len(claims.parts_of(link)))
    return joined


def _wanted(
    assembly: Assembly, joined: JoinedComponents, bodies: Sequence[MeasuredBody], others: _Others
) -> CollisionRequest:
    components = [assembly.components[index] for index in joined.components]
    X_AW = components[0].X_WC.inverse()
    solids: list[PlacedSolid] = []
    faces: list[AxisFace] = []
    for component in components:
        placed = _placed(assembly, component, X_AW)
        solids.append(placed if component is not components[0] else replace(placed, X_AC=IDENTITY))
        faces += [face.moved(solids[-1].X_AC) for face in assembly.bodies[component.body].axis_faces if not face.cone]
    shafts = sorted((face for face in faces if not face.bore), key=lambda face: -face.radius * (face.high - face.low))
    rule = joined.rule
    assert rule.max_vertices is not None
    return CollisionRequest(
        tuple(solids),
        missing_volume(components, bodies),
        tuple(RoundFace(np.array(face.point), np.array(face.direction), face.radius) for face in shafts[:_SHAFTS]),
        tuple(RoundFace(np.array(face.point), np.array(face.direction), face.radius) for face in faces if face.bore),
        rule.shape is CollisionShape.AUTO,
        rule.filled,
        rule.max_hulls,
        rule.max_vertices,
        tuple(_placed(assembly, assembly.components[index], X_AW) for index in others.beside),
        others.is_all,
        rule.max_faces,
    )


def _placed(assembly: Assembly, component: Component, X_AW: Pose) -> PlacedSolid:
    """The mesh of a component, in A."""
    return PlacedSolid(assembly.bodies[component.body].mesh, tidy(X_AW @ component.X_WC))


def wait_for(fitted: FittedCollisions, binder: Binder, timeout: float) -> bool:
    """Wait for the shapes; False after SB902, if the worker died."""
    try:
        fitted.wait(timeout)
    except WorkerDied as death:
        report_death(death, "fits collision shapes", binder.span(("links",)), binder.diagnostics)
        return False
    return True


class ScoredCollisions:
    """The collision shapes of a robot, which are scored when the report needs it."""

    def __init__(
        self,
        binder: Binder,
        claims: Claims,
        robot: Robot,
        X_WL: Mapping[str, Pose],
        bodies: Sequence[MeasuredBody],
        fitted: FittedCollisions,
        cache: Cache | None,
        process: Worker | None,
    ) -> None:
        """Keep what scores need; computes nothing.

        Args:
            binder: The assembly and the sidecar; its collector receives SB902.
            X_WL: Frame of each link as drawn.
            process: Worker of :mod:`stepbot.geometry.mesh_worker`, idle when the scores are requested; None to compute
                in this process.
        """
        self._binder, self._claims, self._robot, self._bodies = binder, claims, robot, bodies
        self._X_WL, self._fitted = X_WL, fitted
        self._cache, self._process = cache, process

    def result(self, timeout: float = DEFAULT_TIMEOUT) -> tuple[LinkCollision, ...]:
        """The shapes of every link that has any, with scores where stepbot has chosen them; without scores after SB902.

        A set was scored when it was fitted, with the hulls beside it, if these are all that a link has; other shapes
        take about half a second for a link.
        """
        links = [link for link in self._robot.links if link.collisions]
        known = {link.name: score for link in links if (score := self._known(link)) is not None}
        unscored = {
            link.name: self._unscored(link) for link in links if self._is_chosen(link) and link.name not in known
        }
        scores = ResultsByContent(self._cache, "collision score", unscored, (UnscoredSolids, CollisionScore))
        self._compute(scores, timeout)
        return tuple(self._record(link, known.get(link.name) or scores.get(link.name) or NO_SCORE) for link in links)

    def _is_chosen(self, link: Link) -> bool:
        rule = link_rule(link.name, self._binder.document)
        return rule is not None and (rule.is_decomposed or rule.max_vertices is not None)

    def _known(self, link: Link) -> CollisionScore | None:
        """The score of a link with one set around all of its closed solids, and hulls of the others; else None."""
        rule = link_rule(link.name, self._binder.document)
        if rule is None or not rule.is_decomposed:
            return None
        joined = joined_parts(self._binder.assembly, self._claims.parts_of(link.name), rule)
        made = None if joined is None else self._fitted.get(joined)
        return made.score if made is not None and made.scored == len(link.collisions) else None

    def _compute(self, scores: ResultsByContent[str, UnscoredSolids, CollisionScore], timeout: float) -> None:
        """Compute the missing scores, unless the worker dies (SB902)."""
        missing = scores.missing
        if not missing:
            return
        try:
            submitted = None if self._process is None else self._process.submit("scores", missing, more=True)
            scores.add(collision_scores(missing) if submitted is None else submitted.result(timeout))
        except WorkerDied as death:
            report_death(death, "scores collision shapes", self._binder.span(("links",)), self._binder.diagnostics)

    def _unscored(self, link: Link) -> UnscoredSolids:
        """The closed solids of a link and its shapes, in the frame of the first component."""
        assembly = self._binder.assembly
        parts = [assembly.components[index] for index in closed_parts(assembly, self._claims.parts_of(link.name))]
        if not parts:
            return UnscoredSolids((), 0.0, ())
        X_AW = parts[0].X_WC.inverse()
        X_AL = X_AW @ self._X_WL[link.name]
        solids = tuple(PlacedSolid(assembly.bodies[part.body].mesh, tidy(X_AW @ part.X_WC)) for part in parts)
        shapes = []
        for shape in link.collisions:
            of = shape.geometry
            geometry = self._robot.mesh_by_name[of.name].mesh if isinstance(of, MeshRef) else of
            shapes.append(PlacedShape(geometry, tidy(X_AL @ shape.X_LG)))
        return UnscoredSolids(solids, missing_volume(parts, self._bodies), tuple(shapes))

    def _record(self, link: Link, score: CollisionScore) -> LinkCollision:
        meshes = [self._robot.mesh_by_name[of.name].mesh for of in _geometries(link) if isinstance(of, MeshRef)]
        rule = _rule(link.name, self._binder.document)
        counts = Counter(type(of).__name__.lower() for of in _geometries(link) if not isinstance(of, MeshRef))
        if meshes:
            counts["mesh" if rule == "mesh" else "hull"] += len(meshes)
        vertices = tuple(len(mesh.vertices) for mesh in meshes)
        return LinkCollision(
            link.name,
            rule,
            dict(sorted(counts.items())),
            sum(len(mesh.vertices) for mesh in meshes),
            max(vertices, default=0),
            score.iou,
            score.overshoot,
        )


def _geometries(link: Link) -> list[Geometry]:
    return [shape.geometry for shape in link.collisions]


def _rule(link: str, document: Document) -> str:
    """The rule of a link in words: ``auto``, ``merged hull``, ``given``."""
    rule = link_rule(link, document)
    if rule is None:
        return "given"
    return f"merged {rule.shape.value}" if is_merged(link, document) else rule.shape.value
