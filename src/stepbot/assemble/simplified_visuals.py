"""Visual meshes within the budgets of a sidecar: ``max_triangles`` of robot and links, ``max_bytes`` of the robot.

A link's own budget comes first; the robot's is for all links together, and that of bytes last. Collision meshes and
masses do not change.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.simplification import Simplified, TriangleBudget, Unit, all_simplified
from stepbot.report.robot import SimplifiedVisuals
from stepbot.robot.mesh_files import MeshFiles, share_meshes
from stepbot.robot.mesh_names import UniqueNames
from stepbot.robot.model import Link, MeshAsset, MeshFormat, MeshRef, Robot, Visual
from stepbot.runtime.cache import Cache
from stepbot.runtime.cache.by_content import ResultsByContent
from stepbot.runtime.worker import Worker, WorkerDied

from .binder import Binder

_MILLIMETRES = 1e3
_ATTEMPTS = 6
"""Numbers of triangles that are tried for a number of bytes, which is nearly proportional to it."""
_MARGIN = 0.99
_NAMED = 3
"""Links that a message names."""

_Names = tuple[str, ...]
"""Mesh names of the visuals of one component, which have common borders."""


class _Scope(Struct, frozen=True):
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
        if not own and document.mesh.max_triangles is None and document.mesh.max_bytes is None:
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
        if document.mesh.max_bytes is not None:
            robot, record = self._within_bytes(robot, document.mesh.max_bytes)
            records.append(record)
        return robot, tuple(record for record in records if record is not None)

    def _within(self, robot: Robot, scope: _Scope, taken: int = 0) -> tuple[Robot, SimplifiedVisuals | None]:
        """The robot with a scope within its budget; ``taken`` of it is used by links with budgets of their own."""
        links = [robot.link_by_name[name] for name in scope.links]
        before = sum(_faces_drawn(robot, link) for link in links)
        if before + taken <= scope.max_triangles:
            return robot, None
        counts = Counter(_names(group) for link in links for group in _groups(link))
        made = self._computed(_budget(robot, counts, max(scope.max_triangles - taken, 0)))
        if made is None:
            return robot, None
        robot = _with_meshes(robot, scope.links, dict(zip(counts, made.units, strict=True)))
        after = made.triangles + taken
        self._report(scope, before + taken, after, made.deviation)
        return robot, SimplifiedVisuals(scope.name, before + taken, after, made.deviation, scope.max_triangles)

    def _within_bytes(self, robot: Robot, most: int) -> tuple[Robot, SimplifiedVisuals | None]:
        """The robot with visual meshes whose files have at most so many bytes, in each of their formats."""
        size = before = visual_bytes(robot)
        links = tuple(link.name for link in robot.links)
        counts = dict.fromkeys((_names(group) for link in robot.links for group in _groups(link)), 1)
        faces = sum(len(robot.mesh_by_name[name].mesh.faces) for names in counts for name in names)
        reduced, made = robot, None
        for _ in range(_ATTEMPTS):
            if size <= most or (made is not None and made.triangles > faces):
                break
            faces = int(faces * _MARGIN * most / size)
            made = self._computed(_budget(robot, counts, faces))
            if made is None:
                return robot, None
            reduced = _with_meshes(robot, links, dict(zip(counts, made.units, strict=True)))
            size = visual_bytes(reduced)
        if made is None:
            return robot, None
        self._report_bytes(robot, reduced, f"from {before} to {size} bytes", made.deviation, size - most)
        drawn = [sum(_faces_drawn(one, link) for link in one.links) for one in (robot, reduced)]
        return reduced, SimplifiedVisuals("", drawn[0], drawn[1], made.deviation, max_bytes=most)

    def _computed(self, budget: TriangleBudget) -> Simplified | None:
        results = ResultsByContent(self._cache, "triangle budget", {"": budget}, (TriangleBudget, Simplified))
        if results.missing:
            try:
                worker = (
                    None if self._process is None else self._process.submit("simplified", results.missing, more=True)
                )
                results.add(all_simplified(results.missing) if worker is None else worker.result(self._timeout))
            except WorkerDied as death:
                report_death(death, "simplifies meshes", self._binder.span(("mesh",)), self._binder.diagnostics)
        return results.get("")

    def _report(self, scope: _Scope, before: int, after: int, deviation: float) -> None:
        span, off = self._binder.span(scope.keys), f"{_MILLIMETRES * deviation:.3g} mm"
        if after > scope.max_triangles:
            message = f"{scope.subject}visual meshes have {after} triangles, and {scope.max_triangles} are allowed"
            help = ("raise `max_triangles`, or hide parts: `visual: false`",)
            self._binder.diagnostics.add("SB610", message, span, help=help)
        message = f"{scope.subject}visual meshes simplified from {before} to {after} triangles, off by up to {off}"
        self._binder.diagnostics.add("SB611", message, span)

    def _report_bytes(self, before: Robot, after: Robot, sizes: str, deviation: float, surplus: int) -> None:
        span, off = self._binder.span(("mesh", "max_bytes")), f"{_MILLIMETRES * deviation:.3g} mm"
        if surplus > 0:
            message = f"the files of visual meshes have {surplus} bytes more than `max_bytes`"
            help = ("raise `max_bytes`, or hide parts: `visual: false`",)
            self._binder.diagnostics.add("SB610", message, span, help=help)
        pairs = zip(before.links, after.links, strict=True)
        counts = {a.name: (_faces_drawn(before, a), _faces_drawn(after, b)) for a, b in pairs}
        reduced = sorted((one for one in counts if counts[one][0] > counts[one][1]), key=lambda one: -counts[one][0])
        named = [f"'{name}' {counts[name][0]} to {counts[name][1]}" for name in reduced[:_NAMED]]
        named += [f"{len(reduced) - _NAMED} more links"] if len(reduced) > _NAMED else []
        message = f"files of visual meshes reduced {sizes}, off by up to {off}; triangles: {', '.join(named)}"
        self._binder.diagnostics.add("SB611", message, span)


def visual_bytes(robot: Robot) -> int:
    """Size of the files of a robot's visual meshes, in OBJ where that is larger: readers may lack the chosen format."""
    formats = robot.mesh_formats
    seen = replace(robot, links=tuple(replace(link, collisions=()) for link in robot.links))
    files = (
        MeshFiles(replace(seen, mesh_formats=replace(formats, visual=kind))).all
        for kind in {formats.visual, MeshFormat.OBJ}
    )
    return max(sum(len(file.content()) for file in of_kind) for of_kind in files)


def _budget(robot: Robot, counts: Mapping[_Names, int], most: int) -> TriangleBudget:
    meshes = robot.mesh_by_name
    units = (Unit(tuple(meshes[name].mesh for name in names), count) for names, count in counts.items())
    return TriangleBudget(tuple(units), most)


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
