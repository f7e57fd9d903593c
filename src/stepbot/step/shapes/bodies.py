"""One body of a definition: healed, measured exactly, meshed, its axes found; all of this once per shape."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.predicates import is_watertight
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import Rgba

from ..assembly import CERTAIN, AxisFace, Body, BodyKind, MeshTolerance
from ..features.axis_faces import axis_faces
from ..features.face_counts import face_counts
from ..features.face_reading import read_faces
from ..kernel import MILLIMETRES_PER_METRE
from ..structure.source import BodySource
from ..topology import faces_of
from .error_estimate import estimated
from .exact import integrate, surface_area, volume_properties
from .healing import Healed, copied, healed, unhealed
from .measuring import Refinement, refine
from .self_intersection import share_within
from .sewing import sewn
from .splitting import split
from .stitching import Stitched, merged_by_position
from .tessellation import Fineness, Tessellation, diagonal, fineness, fitted
from .triangles import faceted_faces

_ROUNDING = 1e-12
"""Volume over area^1.5 below which a body has no volume."""
_NO_MESH = TriMesh.of(np.empty((0, 3)), np.empty((0, 3)))


@dataclass(frozen=True)
class Finding:
    """A diagnostic of a body; its component, which is the subject, is unknown here."""

    code: str
    message: str
    help: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ReadBody:
    """A body and its diagnostics."""

    body: Body
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class BodyRequest:
    """What to compute for a body."""

    tolerances: tuple[MeshTolerance, ...]
    """Of all its occurrences; the finest one applies."""
    refine_mass_to: float = 0.0
    area: bool = False
    """Whether to integrate its area."""
    faces: bool = False
    """Whether to keep every face."""


@dataclass
class _Work:
    """The state of the body being made."""

    source: BodySource
    kind: BodyKind
    healed: Healed
    exact: VolumeProperties | None = None
    exact_error: float = 0.0
    area: float = 0.0
    findings: list[Finding] = field(default_factory=list)

    def say(self, code: str, message: str, *help: str) -> str:
        self.findings.append(Finding(code, message, help))
        return message


def read_body(source: BodySource, request: BodyRequest) -> ReadBody:
    """Heal, measure and mesh a body."""
    if source.is_wire:
        return ReadBody(_wire())
    shape = copied(source.shape)
    if not _has_surfaces(shape):
        return _triangles_only(source, shape)
    work = _healed(source, shape)
    size = diagonal(work.healed.shape)
    wanted = fineness(request.tolerances, size)
    result = fitted(work.healed.shape, wanted, size)
    if result.mesh.open_edges and _sew(work):
        result = fitted(work.healed.shape, wanted, size)
    if request.area:
        work.area = surface_area(work.healed.shape)
    faces = axis_faces(faces_of(work.healed.shape))
    mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
    watertight = is_watertight(mesh.faces)
    defect = _defect(work, result, wanted, watertight)
    refinement = Refinement()
    if request.refine_mass_to > 0.0 and work.kind == BodyKind.SOLID and (work.exact or watertight):
        refinement = refine(work.healed.shape, mesh, result.fineness, work.exact, request.refine_mass_to)
        if refinement.shortfall:
            work.say("SB606", refinement.shortfall)
    body = _body(work, result.mesh, mesh, watertight, defect, refinement.properties, faces)
    body = replace(body, face_counts=face_counts(faces_of(work.healed.shape)))
    if request.faces:
        body = replace(body, faces=read_faces(faces_of(work.healed.shape)))
    return ReadBody(body, tuple(work.findings))


def _healed(source: BodySource, shape: object) -> _Work:
    """The body healed and oriented outwards, with its exact mass properties if it encloses a volume."""
    body = healed(shape, source.precision, sorted(source.face_colors))
    # Healing makes shells of solids that are not closed; such a body is still intended as a solid.
    is_solid = _holds(source.shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    if not _holds(body.shape, TopAbs_ShapeEnum.TopAbs_SOLID):
        return _Work(source, BodyKind.SOLID if is_solid else BodyKind.SURFACE, body)
    work = _Work(source, BodyKind.SOLID, body)
    properties = integrate(body.shape)
    if properties.Mass() < 0.0:
        work.healed = Healed(body.shape.Reversed(), body.origin)
        work.say("SB217", "inward-facing solid reoriented")
        properties = integrate(work.healed.shape)
    work.exact = volume_properties(properties)
    return work


def _sew(work: _Work) -> bool:
    """Whether an open solid could be closed by joining edges; reports it."""
    closed = sewn(work.healed, work.source.precision) if work.kind == BodyKind.SOLID else None
    if closed is None:
        return False
    work.healed, work.exact = closed, volume_properties(integrate(closed.shape))
    work.say("SB228", "faces without shared edges were sewn")
    return True


def _defect(work: _Work, result: Tessellation, wanted: Fineness, watertight: bool) -> str:
    """Faults of the body's mesh, for messages; also drops exact values that are meaningless."""
    count = len(result.mesh.faces)
    if result.fineness.angle > wanted.angle:
        work.say(
            "SB603",
            f"too many faces at the requested tolerance; meshed at {_described(result.fineness)}: {count} faces",
        )
    if result.missing:
        faces = f"{len(result.missing)} of its faces" if len(result.missing) > 1 else "one of its faces"
        _estimate(work, result, is_closed=False)
        return work.say("SB601", f"{faces} could not be meshed")
    if work.kind != BodyKind.SOLID:
        return "encloses no volume: surface without a solid"
    if result.mesh.open_edges:
        work.exact = None  # integrated over open surfaces, a volume depends on the origin
        return work.say(
            "SB602", f"{result.mesh.open_edges} of its edges belong to one face only; it encloses no volume"
        )
    if not watertight:
        _estimate(work, result, is_closed=False)
        return work.say("SB604", "mesh is not manifold")
    if work.exact is None or _is_nothing(work.exact, result.mesh):
        work.exact = None
        return work.say("SB602", "it encloses no volume")
    if within := share_within(result.mesh):
        return work.say(
            "SB607",
            f"self-intersecting: {within:.0%} of its surface lies inside it, so its volume is wrong",
            "repair it in CAD, or set its mass in the sidecar",
            "a thin-walled body may need a finer `mesh`",
        )
    return _estimate(work, result, is_closed=True)


def _estimate(work: _Work, result: Tessellation, *, is_closed: bool) -> str:
    """Confirm the exact mass properties; returns their fault, for messages."""
    if work.exact is None:
        return ""
    estimate = estimated(work.healed.shape, work.exact, result, is_closed=is_closed)
    work.exact, work.exact_error = estimate.properties, min(estimate.error, 1.0)
    if estimate.error <= CERTAIN:
        return ""
    volumes = ", ".join(f"{volume * MILLIMETRES_PER_METRE**3:.6g} mm^3 by {way}" for way, volume in estimate.opinions)
    return work.say("SB605", f"mass properties do not converge: {volumes or 'nothing to compare with'}")


def _is_nothing(exact: VolumeProperties, mesh: Stitched) -> bool:
    """Whether a volume is only the rounding error of surfaces that cancel each other."""
    return bool(exact.volume * MILLIMETRES_PER_METRE**3 < _ROUNDING * mesh.area**1.5)


def _body(
    work: _Work,
    stitched: Stitched,
    mesh: TriMesh,
    watertight: bool,
    defect: str,
    refined: VolumeProperties | None,
    faces: tuple[AxisFace, ...],
) -> Body:
    face_colors, colors = _colored(work.source.face_colors, work.healed.origin, stitched)
    return Body(
        *(work.kind, mesh, face_colors, colors, watertight, defect),
        *(work.exact, work.exact_error, refined, faces, work.area),
    )


def _triangles_only(source: BodySource, shape: object) -> ReadBody:
    """A body given as triangles: joined at equal points, oriented outwards if it is closed."""
    body = unhealed(shape)
    found, _ = faceted_faces(faces_of(shape))
    stitched = split(merged_by_position(found))
    watertight = is_watertight(stitched.faces)
    findings = []
    if watertight and stitched.signed_volume < 0.0:
        stitched = stitched.turned()
        findings.append(Finding("SB217", "inward-facing triangles reoriented"))
    mesh = TriMesh.of(stitched.vertices / MILLIMETRES_PER_METRE, stitched.faces)
    defect = "" if watertight else "its triangles are not closed; it encloses no volume"
    face_colors, colors = _colored(source.face_colors, body.origin, stitched)
    return ReadBody(Body(BodyKind.TESSELLATED, mesh, face_colors, colors, watertight, defect), tuple(findings))


def _wire() -> Body:
    none = np.empty(0, dtype=np.int32)
    return Body(BodyKind.WIRE, _NO_MESH, none, (None,), False, "curves and points only: no surface and no mass")


def _colored(
    wanted: dict[int, Rgba], origin: list[int], stitched: Stitched
) -> tuple[NDArray[np.int32], tuple[Rgba | None, ...]]:
    """For each triangle, the index of its colour, and the colours; the first, None, is the component's own."""
    colors: list[Rgba | None] = [None, *dict.fromkeys(wanted[place] for place in sorted(wanted))]
    of_face = np.array([colors.index(wanted.get(place)) for place in origin], dtype=np.int32)
    by_triangle = of_face[stitched.places] if len(of_face) else np.zeros(len(stitched.faces), dtype=np.int32)
    used = sorted(set(by_triangle.tolist()))
    renumbered = {old: new for new, old in enumerate(used)}
    table = np.array([renumbered.get(old, 0) for old in range(len(colors))], dtype=np.int32)
    return table[by_triangle], tuple(colors[old] for old in used) or (None,)


def _has_surfaces(shape: object) -> bool:
    return any(BRep_Tool.Surface_s(face) is not None for face in faces_of(shape))


def _holds(shape: object, kind: TopAbs_ShapeEnum) -> bool:
    return bool(TopExp_Explorer(shape, kind).More())


def _described(fine: Fineness) -> str:
    return f"{fine.deflection:.3g} mm and {math.degrees(fine.angle):.0f} degrees"
