"""Scores of the collision shapes of each link against its solids, for the report."""

from collections import Counter
from collections.abc import Mapping, Sequence

from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.solids.collision_scores import NO_SCORE, CollisionScore, Unscored, collision_scores
from stepbot.geometry.solids.unions import PlacedShape, PlacedSolid
from stepbot.geometry.spatial import Pose, tidy
from stepbot.report.robot import LinkCollision, MeasuredBody
from stepbot.robot.model import Geometry, Link, MeshRef, Robot
from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.sidecar.document import Document

from .binder import Binder
from .claims import Claims
from .collision_rules import is_merged, link_rule
from .fitted_collisions import FittedCollisions, closed_parts, joined_parts, missing_volume


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
            claims: The link of each component.
            X_WL: Frame of each link as drawn.
            bodies: Each body of the assembly, measured.
            fitted: The sets of shapes that were fitted, with their scores.
            cache: Cache of scores; None to disable it.
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
        scores = ResultsByContent(self._cache, "collision score", unscored, (Unscored, CollisionScore))
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

    def _compute(self, scores: ResultsByContent[str, Unscored, CollisionScore], timeout: float) -> None:
        """Compute the missing scores, unless the worker dies (SB902)."""
        missing = scores.missing
        if not missing:
            return
        try:
            submitted = None if self._process is None else self._process.submit("scores", missing, more=True)
            scores.add(collision_scores(missing) if submitted is None else submitted.result(timeout))
        except WorkerDied as death:
            report_death(death, "scores collision shapes", self._binder.span(("links",)), self._binder.found)

    def _unscored(self, link: Link) -> Unscored:
        """The closed solids of a link and its shapes, in the frame of the first component."""
        assembly = self._binder.assembly
        parts = [assembly.components[index] for index in closed_parts(assembly, self._claims.parts_of(link.name))]
        if not parts:
            return Unscored((), 0.0, ())
        X_AW = parts[0].X_WC.inverse()
        X_AL = X_AW @ self._X_WL[link.name]
        solids = tuple(PlacedSolid(assembly.bodies[part.body].mesh, tidy(X_AW @ part.X_WC)) for part in parts)
        shapes = []
        for shape in link.collisions:
            of = shape.geometry
            geometry = self._robot.mesh_by_name[of.name].mesh if isinstance(of, MeshRef) else of
            shapes.append(PlacedShape(geometry, tidy(X_AL @ shape.X_LG)))
        return Unscored(solids, missing_volume(parts, self._bodies), tuple(shapes))

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
