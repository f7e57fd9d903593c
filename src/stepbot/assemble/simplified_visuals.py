"""Visual meshes within the triangle budgets of a sidecar: ``mesh: {max_triangles}`` of the robot and of links.

A link's own budget comes first; the robot's is for all links together. Collision meshes and masses do not change.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.triangle_budgets import Simplified, TriangleBudget, Unit, all_simplified
from stepbot.report.robot import SimplifiedVisuals
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.mesh_names import UniqueNames
from stepbot.robot.model import Link, MeshAsset, MeshRef, Robot, Visual
from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent
from stepbot.runtime.worker import Worker, WorkerDied

from .binder import Binder

_MILLIMETRES = 1e3

_Names = tuple[str, ...]
"""Mesh names of the visuals of one component, which have common borders."""


@dataclass(frozen=True)
class _Scope:
    """Links that share a budget."""

    name: str
    """Of the link; empty for the robot."""
    links: tuple[str, ...]
    max_triangles: int

    @property
    def keys(self) -> tuple[str, ...]:
        """The place in the sidecar."""
        return ("links", self.name, "mesh", "max_triangles") if self.name else ("mesh", "max_triangles")

    @property
    def subject(self) -> str:
        """For messages."""
        return f"link '{self.name}': " if self.name else ""


class SimplifiedVisualMeshes:
    """Simplifies the visual meshes of a robot, and reports SB610 and SB611."""

    def __init__(self, binder: Binder, cache: Cache | None, process: Worker | None, timeout: float) -> None:
        """Keep what is needed.

        Args:
            binder: The sidecar; its collector receives the diagnostics.
            cache: Cache of simplified meshes; None to disable it.
            process: An idle worker of :mod:`stepbot.geometry.mesh_worker`; None to compute in this process.
            timeout: Maximum time [s] to wait for one budget.
        """
        self._binder, self._cache, self._process, self._timeout = binder, cache, process, timeout

    def of(self, robot: Robot) -> tuple[Robot, tuple[SimplifiedVisuals, ...]]:
        """The robot within its budgets, and what was simplified; the robot itself without budgets or after SB902."""
        document = self._binder.document
        own = {
            name: link.mesh.max_triangles
            for name, link in document.links.items()
            if link.mesh is not None and link.mesh.max_triangles is not None
        }
        if not own and document.mesh.max_triangles is None:
            return robot, ()
        robot = share_meshes(robot)
        records = []
        for name, most in own.items():
            if name in robot.link_by_name:
                robot, record = self._within(robot, _Scope(name, (name,), most))
                records.append(record)
        if document.mesh.max_triangles is not None:
            others = tuple(link.name for link in robot.links if link.name not in own)
            taken = sum(_faces_drawn(robot, link) for link in robot.links if link.name in own)
            robot, record = self._within(robot, _Scope("", others, document.mesh.max_triangles), taken)
            records.append(record)
        return robot, tuple(record for record in records if record is not None)

    def _within(self, robot: Robot, scope: _Scope, taken: int = 0) -> tuple[Robot, SimplifiedVisuals | None]:
        """The robot with a scope within its budget; ``taken`` of it is used by links with budgets of their own."""
        links = [robot.link_by_name[name] for name in scope.links]
        before = sum(_faces_drawn(robot, link) for link in links)
        if before + taken <= scope.max_triangles:
            return robot, None
        counts = Counter(_names(group) for link in links for group in _groups(link))
        meshes = robot.mesh_by_name
        units = tuple(Unit(tuple(meshes[name].mesh for name in names), count) for names, count in counts.items())
        budget = TriangleBudget(units, max(scope.max_triangles - taken, 0))
        made = self._computed(budget)
        if made is None:
            return robot, None
        robot = _with_meshes(robot, scope.links, dict(zip(counts, made.units, strict=True)))
        self._report(scope, before + taken, made.triangles + taken, made.deviation)
        return robot, SimplifiedVisuals(
            scope.name, scope.max_triangles, before + taken, made.triangles + taken, made.deviation
        )

    def _computed(self, budget: TriangleBudget) -> Simplified | None:
        results = ResultsByContent(self._cache, "triangle budget", {"": budget}, (TriangleBudget, Simplified))
        if results.missing:
            try:
                worker = (
                    None if self._process is None else self._process.submit("simplified", results.missing, more=True)
                )
                results.add(all_simplified(results.missing) if worker is None else worker.result(self._timeout))
            except WorkerDied as death:
                report_death(death, "simplifies meshes", self._binder.span(("mesh",)), self._binder.found)
        return results.get("")

    def _report(self, scope: _Scope, before: int, after: int, deviation: float) -> None:
        span, off = self._binder.span(scope.keys), f"{_MILLIMETRES * deviation:.3g} mm"
        if after > scope.max_triangles:
            message = f"{scope.subject}visual meshes have {after} triangles, and {scope.max_triangles} are allowed"
            help = ("raise `max_triangles`, or hide parts: `visual: false`",)
            self._binder.found.add("SB610", message, span, help=help)
        message = f"{scope.subject}visual meshes simplified from {before} to {after} triangles, off by up to {off}"
        self._binder.found.add("SB611", message, span)


def _faces_drawn(robot: Robot, link: Link) -> int:
    """Number of triangles of a link's visual meshes."""
    meshes = robot.mesh_by_name
    return sum(len(meshes[v.geometry.name].mesh.faces) for v in link.visuals if isinstance(v.geometry, MeshRef))


def _groups(link: Link) -> Iterator[tuple[Visual, ...]]:
    """The visuals with meshes, those of one component together."""
    shown = [visual for visual in link.visuals if isinstance(visual.geometry, MeshRef)]
    for _, group in groupby(shown, key=lambda visual: (visual.component, visual.X_LG)):
        yield tuple(group)


def _names(group: Sequence[Visual]) -> _Names:
    return tuple(visual.geometry.name for visual in group if isinstance(visual.geometry, MeshRef))


def _with_meshes(robot: Robot, links: Sequence[str], made: dict[_Names, tuple[TriMesh, ...]]) -> Robot:
    """The robot with simplified meshes in some links; a colour without triangles is not drawn."""
    unique, meshes = UniqueNames(asset.name for asset in robot.meshes), robot.mesh_by_name
    assets: dict[tuple[_Names, int], MeshAsset | None] = {}
    for names, simple in made.items():
        for index, (name, mesh) in enumerate(zip(names, simple, strict=True)):
            if len(mesh.faces) == len(meshes[name].mesh.faces):
                assets[names, index] = meshes[name]
            elif len(mesh.faces):
                assets[names, index] = MeshAsset(unique.unique(f"{name}_visual"), mesh, meshes[name].source)
            else:
                assets[names, index] = None

    def simplified(link: Link) -> Link:
        shown: dict[str, MeshAsset | None] = {}
        for group in _groups(link):
            names = _names(group)
            shown |= {visual.name: assets[names, index] for index, visual in enumerate(group)}
        kept = []
        for visual in link.visuals:
            asset = shown.get(visual.name)
            if asset is not None:
                kept.append(replace(visual, geometry=MeshRef(asset.name)))
            elif visual.name not in shown:
                kept.append(visual)
        return replace(link, visuals=tuple(kept))

    changed = tuple(simplified(link) if link.name in links else link for link in robot.links)
    new = {asset.name: asset for asset in assets.values() if asset is not None}
    together = sorted({**meshes, **new}.values(), key=lambda asset: asset.name)
    return share_meshes(replace(robot, links=changed, meshes=tuple(together)))
