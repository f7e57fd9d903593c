"""One body of a definition: healed, measured exactly, meshed, its axes found; all of this once per shape.

Only healing and the mesh are necessary. What fails beyond them is reported (SB233) and left out.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer

from stepbot.diagnostics import Finding
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.predicates import is_watertight
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import Rgba

from ..assembly import CERTAIN, Body, BodyKind, MeshTolerance
from ..features.axis_faces import axis_faces, face_counts
from ..features.face_reading import read_faces
from ..kernel import MILLIMETRES_PER_METRE, OUT_OF_MEMORY, faces_of
from ..structure.source import BodySource
from .error_estimate import Estimate, by_mesh, estimated
from .exact import integrate, refine, surface_area, volume_properties
from .healing import Healed, copied, healed, sewn, share_within, with_islands
from .splitting import split
from .stitching import Stitched, merged_by_position
from .tessellation import WATSON, Fineness, Tessellation, diagonal, fineness, fitted, tessellated_once
from .triangles import faceted_faces

_ROUNDING = 1e-12
"""Volume over area^1.5 below which a body has no volume."""
T = TypeVar("T")


class ReadBody(Struct, frozen=True, eq=False):
    """A body and its diagnostics."""

    body: Body
    findings: tuple[Finding, ...] = ()
    """The caller knows the component, which is the subject."""


class BodyRequest(Struct, frozen=True):
    """What to compute for a body."""

    tolerances: tuple[MeshTolerance, ...]
    """Of all its occurrences; the finest one applies."""
    refine_mass_to: float
    area: bool
    faces: bool
    only_mesh: str
    """Why only a mesh is to be made: what the complete body failed of, for messages."""


class _Work(Struct):
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

    def optional(self, what: str, compute: Callable[[], T], instead: T) -> T:
        """A result that the body can do without; where it fails that is reported."""
        try:
            return compute()
        except OUT_OF_MEMORY:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it costs this result alone
            self.say("SB233", f"{what} failed ({type(error).__name__} {error})".replace(" )", ")"))
            return instead

    def of_faces(
        self, what: str, read: Callable[[list[Any], list[str]], tuple[T, ...]], faces: list[Any]
    ) -> tuple[T, ...]:
        """What is read of each face, without the faces that it fails on."""
        errors: list[str] = []
        results: tuple[T, ...] = self.optional(what, lambda: read(faces, errors), ())
        if errors:
            self.say("SB233", f"{what} failed on {len(errors)} of its {len(faces)} faces ({errors[0]})")
        return results


def read_body(source: BodySource, request: BodyRequest) -> ReadBody:
    """Heal, measure and mesh a body."""
    if source.is_wire:
        none, defect = np.empty(0, dtype=np.int32), "curves and points only: no surface and no mass"
        return ReadBody(Body(BodyKind.WIRE, TriMesh.of(np.empty((0, 3)), none), none, (None,), False, defect))
    shape = copied(source.shape)
    if not any(BRep_Tool.Surface_s(face) is not None for face in faces_of(shape)):
        return _triangles_only(source, shape)
    if request.only_mesh:
        return _mesh_only(source, shape, request)
    work = _healed(source, shape)
    size = diagonal(work.healed.shape)
    wanted = fineness(request.tolerances, size)
    result = fitted(work.healed.shape, wanted, size)
    if result.mesh.open_edges and work.optional("sewing its faces", lambda: _sew(work), False):
        result = fitted(work.healed.shape, wanted, size)
    healed_faces = faces_of(work.healed.shape)
    if request.area:
        work.area = work.optional("integrating its area", lambda: surface_area(work.healed.shape), math.nan)
    axes = work.of_faces("finding axes", axis_faces, healed_faces)
    mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
    watertight = is_watertight(mesh.faces)
    defect = _defect(work, result, wanted, watertight)
    refined = _refined(work, mesh, result, request, watertight)
    face_colors, colors = _colored(source.face_colors, work.healed.origin, result.mesh)
    counts: tuple[tuple[str, int], ...] = work.optional("counting its faces", lambda: face_counts(healed_faces), ())
    faces = work.of_faces("reading faces", read_faces, healed_faces) if request.faces else ()
    body = Body(
        *(work.kind, mesh, face_colors, colors, watertight, defect, work.exact, work.exact_error, refined, axes),
        area=work.area,
        faces=faces,
        face_counts=counts,
    )
    return ReadBody(body, tuple(work.findings))


def _mesh_only(source: BodySource, shape: object, request: BodyRequest) -> ReadBody:
    """A body with the kernel's plain mesh, without anything else that may fail."""
    body = healed(shape, source.precision, sorted(source.face_colors))
    is_solid = _holds(source.shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    work = _Work(source, BodyKind.SOLID if is_solid else BodyKind.SURFACE, body)
    result = tessellated_once(body.shape, fineness(request.tolerances, diagonal(body.shape)), WATSON)
    mesh = TriMesh.of(result.mesh.vertices / MILLIMETRES_PER_METRE, result.mesh.faces)
    defect = work.say("SB233", f"measuring it and finding its axes failed ({request.only_mesh}); it has a mesh alone")
    colored = _colored(source.face_colors, body.origin, result.mesh)
    return ReadBody(Body(work.kind, mesh, *colored, False, defect), tuple(work.findings))


def _refined(
    work: _Work, mesh: TriMesh, result: Tessellation, request: BodyRequest, watertight: bool
) -> VolumeProperties | None:
    """Mass properties of a measuring mesh, if the sidecar asks for it."""
    if not (request.refine_mass_to > 0.0 and work.kind == BodyKind.SOLID and (work.exact or watertight)):
        return None

    none: tuple[VolumeProperties | None, str] = None, ""
    properties, shortfall = work.optional(
        "refining its measuring mesh",
        lambda: refine(work.healed.shape, mesh, result.fineness, work.exact, request.refine_mass_to),
        none,
    )
    if shortfall:
        work.say("SB511", shortfall)
    return properties


def _healed(source: BodySource, shape: object) -> _Work:
    """The body healed and oriented outwards, with its exact mass properties if it encloses a volume."""
    body = healed(shape, source.precision, sorted(source.face_colors))
    # Healing makes shells of solids that are not closed; such a body is still intended as a solid.
    is_solid = _holds(source.shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    if not _holds(body.shape, TopAbs_ShapeEnum.TopAbs_SOLID):
        return _Work(source, BodyKind.SOLID if is_solid else BodyKind.SURFACE, body)
    work = _Work(source, BodyKind.SOLID, body)
    if (nested := work.optional("nesting its shells", lambda: with_islands(body), None)) is not None:
        work.healed = nested
        work.say("SB217", "shells inside its voids count as solid")
    work.optional("integrating its volume", lambda: _integrate(work), None)
    return work


def _integrate(work: _Work) -> None:
    """Integrate the volume, and turn the faces of a body with a negative one outwards."""
    properties = integrate(work.healed.shape)
    if properties.Mass() < 0.0:
        work.healed = Healed(work.healed.shape.Reversed(), work.healed.origin)
        work.say("SB217", "inward-facing solid reoriented")
        properties = integrate(work.healed.shape)
    work.exact = volume_properties(properties)


def _sew(work: _Work) -> bool:
    """Whether an open solid could be closed by joining edges; reports it."""
    closed = sewn(work.healed, work.source.precision) if work.kind == BodyKind.SOLID else None
    if closed is None:
        return False
    work.healed, work.exact = closed, volume_properties(integrate(closed.shape))
    work.say("SB217", "faces without shared edges were sewn")
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
        return work.say("SB601", f"{faces} could not be meshed{_untried(result)}")
    if work.kind != BodyKind.SOLID:
        return "encloses no volume: surface without a solid"
    if result.mesh.open_edges:
        work.exact = None  # integrated over open surfaces, a volume depends on the origin
        return work.say(
            "SB602", f"{result.mesh.open_edges} of its edges belong to one face only; it encloses no volume"
        )
    if not watertight:
        _estimate(work, result, is_closed=False)
        return work.say("SB601", f"mesh is not manifold{_untried(result)}")
    if work.exact is None:  # the kernel integrates over some faces to nothing, or to no number
        work.exact = by_mesh(result.mesh)
    if work.exact is None or _is_nothing(work.exact, result.mesh):
        work.exact = None
        return work.say("SB602", "it encloses no volume")
    if within := work.optional("checking for self-intersection", lambda: share_within(result.mesh), 0.0):
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
    exact = work.exact
    estimate = work.optional(
        "estimating the error of its mass properties",
        lambda: estimated(work.healed.shape, exact, result, is_closed=is_closed),
        Estimate(exact, math.inf),
    )
    work.exact, work.exact_error = estimate.properties, min(estimate.error, 1.0)
    if estimate.error <= CERTAIN:
        return ""
    volumes = ", ".join(f"{volume * MILLIMETRES_PER_METRE**3:.6g} mm^3 by {way}" for way, volume in estimate.opinions)
    return work.say("SB605", f"mass properties do not converge: {volumes or 'nothing to compare with'}")


def _untried(result: Tessellation) -> str:
    """For messages, whether all ways were tried."""
    return result.untried and f"; {result.untried}"


def _is_nothing(exact: VolumeProperties, mesh: Stitched) -> bool:
    """Whether a volume is only the rounding error of surfaces that cancel each other."""
    return bool(exact.volume * MILLIMETRES_PER_METRE**3 < _ROUNDING * mesh.area**1.5)


def _triangles_only(source: BodySource, shape: object) -> ReadBody:
    """A body given as triangles: joined at equal points, oriented outwards if it is closed."""
    faces = faces_of(shape)  # unhealed: without surfaces, healing would tear them apart
    stitched = split(merged_by_position(faceted_faces(faces)[0]))
    watertight = is_watertight(stitched.faces)
    repaired = ""
    if not watertight and (consistent := stitched.consistent()):
        stitched, watertight, repaired = consistent, True, "triangles that face different sides reoriented"
    if watertight and stitched.signed_volume < 0.0:
        stitched, repaired = stitched.turned(), repaired or "inward-facing triangles reoriented"
    findings = [Finding("SB217", repaired)] if repaired else []
    mesh = TriMesh.of(stitched.vertices / MILLIMETRES_PER_METRE, stitched.faces)
    defect = "" if watertight else "its triangles are not closed; it encloses no volume"
    colored = _colored(source.face_colors, list(range(len(faces))), stitched)
    return ReadBody(Body(BodyKind.TESSELLATED, mesh, *colored, watertight, defect), tuple(findings))


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


def _holds(shape: object, kind: TopAbs_ShapeEnum) -> bool:
    return bool(TopExp_Explorer(shape, kind).More())


def _described(fine: Fineness) -> str:
    return f"{fine.deflection:.3g} mm and {math.degrees(fine.angle):.0f} degrees"
