"""Shapes of ``auto`` and ``decompose`` collisions: requested for all links at once, from the cache or a worker.

A link's components without a rule of their own are one solid, given in the frame of the first of them; a component with
a rule is a solid of its own, shared by all occurrences of its body. Neither depends on joints, so editing them does not
change a shape or its cache key.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.solids.collision_sets import CollisionSet, Wanted, collision_sets
from stepbot.geometry.solids.primitive_fits import RoundFace
from stepbot.geometry.solids.unions import PlacedSolid
from stepbot.geometry.spatial import IDENTITY, Pose, tidy
from stepbot.report.robot import MeasuredBody
from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.sidecar.document import CollisionShape
from stepbot.step.assembly import Assembly, AxisFace, Component

from .binder import Binder
from .claims import Claims
from .collision_rules import CollisionRule, link_rule, part_rule
from .material_assignment import MaterialAssignment

_SHAFTS = 24
"""Number of cylindrical faces of a solid that primitives are fitted to, the largest ones."""


@dataclass(frozen=True)
class Joined:
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
        of: Sequence[MaterialAssignment],
        bodies: Sequence[MeasuredBody],
        cache: Cache | None,
        process: Worker | None,
    ) -> None:
        """Look the sets up in the cache or start to compute them; returns at once.

        Args:
            claims: The link of each component.
            of: The sidecar's settings for each component.
            bodies: Each body of the assembly, measured.
            cache: Cache of sets; None to disable it.
            process: An idle worker of :mod:`stepbot.geometry.mesh_worker`; None to compute in this process.
        """
        wanted = {
            joined: _wanted(binder.assembly, joined, bodies, others)
            for joined, others in _all_joined(binder, claims, of).items()
        }
        self._sets = ResultsByContent(cache, "collision set", wanted, (Wanted, CollisionSet))
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

    def of(self, joined: Joined) -> CollisionSet:
        """The shapes of components, in the frame of the first."""
        return self._sets[joined]

    def get(self, joined: Joined) -> CollisionSet | None:
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


def joined_parts(assembly: Assembly, indices: Sequence[int], rule: CollisionRule) -> Joined | None:
    """The closed solids among components; None without any."""
    closed = closed_parts(assembly, indices)
    return Joined(closed, rule) if closed else None


def joined_part(assembly: Assembly, index: int, rule: CollisionRule) -> Joined | None:
    """A component with a rule of its own, as the first occurrence of its body; None if it is not closed."""
    first = assembly.first_of_body[assembly.components[index].body]
    return Joined((first,), rule) if _is_closed(assembly, index) else None


def _is_closed(assembly: Assembly, index: int) -> bool:
    body = assembly.bodies[assembly.components[index].body]
    return body.watertight and len(body.mesh.faces) > 0


@dataclass(frozen=True)
class _Others:
    """What else a link has."""

    beside: tuple[int, ...] = ()
    """Components under the same rule."""
    is_all: bool = False
    """Whether there are no others."""


def _all_joined(binder: Binder, claims: Claims, of: Sequence[MaterialAssignment]) -> dict[Joined, _Others]:
    """All sets, and what is beside each in its link."""
    assembly, document = binder.assembly, binder.document
    found: dict[Joined, _Others] = {}
    for link in document.links:
        whole = []
        for index in claims.parts_of(link):
            rule = part_rule(of[index].collision, of[index].contact, link, document)
            if rule is None:
                whole.append(index)
                continue
            if rule.is_decomposed and (one := joined_part(assembly, index, rule)) is not None:
                found.setdefault(one, _Others())
        common = link_rule(link, document)
        if common is not None and common.is_decomposed:
            several = joined_parts(assembly, whole, common)
            if several is not None:
                beside = tuple(index for index in whole if index not in several.components)
                found[several] = _Others(beside, len(whole) == len(claims.parts_of(link)))
    return found


def _wanted(assembly: Assembly, joined: Joined, bodies: Sequence[MeasuredBody], others: _Others) -> Wanted:
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
    return Wanted(
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
        report_death(death, "fits collision shapes", binder.span(("links",)), binder.found)
        return False
    return True
