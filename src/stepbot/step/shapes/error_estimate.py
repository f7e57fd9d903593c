"""Error of the mass properties of a solid: the kernel's integration against stepbot's own, and against meshes.

    simple solids            the kernel's, which is exact to rounding
    both agree to 1e-5       stepbot's own; their difference is its error
    both agree to 1e-3, and  stepbot's own; the larger of their difference and its own error is its error
      stepbot's own is within
      1e-5 by its own estimate
    else                     the one that increasingly fine meshes converge to; its error is the larger of its deviation
                             from their limit and its last change
    meshes do not converge,  stepbot's own, if the kernel's adaptive integration (Gauss-Kronrod) agrees to 1e-3, its
      or have holes          claim included

An error above 1e-3 is reported; above a tenth the mass properties are unknown.
A solid is simple if all its faces are planes, cylinders, cones, spheres or tori between edges of few spans.
"""

from math import inf
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from stepbot.geometry.predicates import is_watertight
from stepbot.geometry.spatial import Array, corners
from stepbot.geometry.volume import VolumeProperties

from ..assembly import CERTAIN
from ..kernel import MILLIMETRES_PER_METRE, faces_of, mapped, mean_of_vertices
from ..quadrature.solids import Boundary, properties_of
from .exact import adaptive_volume
from .stitching import Stitched
from .tessellation import Tessellation, tessellated_once

_SAME = 1e-9
"""Relative difference up to which the kernel's integration is used unchanged."""
_AGREEMENT = 1e-5
"""Relative difference up to which two integration methods need no third."""
_CONVERGED = 1e-6
"""Error of stepbot's own integration at which its pieces are not divided further."""
_MOST_TRIANGLES = 50_000
"""Triangles beyond which no finer mesh is made as a second opinion."""
_SIMPLE_ERROR = 1e-9
"""Maximum error of the kernel on simple solids, as measured on closed forms and real files."""
_SIMPLE_SPANS = 8
_SIMPLE = frozenset(
    (
        GeomAbs_SurfaceType.GeomAbs_Plane,
        GeomAbs_SurfaceType.GeomAbs_Cylinder,
        GeomAbs_SurfaceType.GeomAbs_Cone,
        GeomAbs_SurfaceType.GeomAbs_Sphere,
        GeomAbs_SurfaceType.GeomAbs_Torus,
    )
)


class Estimate(Struct, frozen=True):
    """Mass properties and how far they may be off."""

    properties: VolumeProperties
    error: float
    """Relative, of volume, centre and inertia; above :data:`.assembly.CERTAIN` it is reported."""
    opinions: tuple[tuple[str, float], ...] = ()
    """Volumes [m^3] by several methods, if they do not agree."""


def estimated(shape: Any, kernel: VolumeProperties, mesh: Tessellation, *, is_closed: bool) -> Estimate:
    """Mass properties of a closed solid.

    Args:
        shape: The solid [mm].
        kernel: The result of the kernel's integration.
        is_closed: Whether the mesh is closed; otherwise it is not used.
    """

    def fits(properties: VolumeProperties) -> bool:
        """Whether the deviation of the mesh is within its tolerance."""
        volume = mesh.mesh.signed_volume / MILLIMETRES_PER_METRE**3
        return not is_closed or abs(volume - properties.volume) <= mesh.volume_tolerance * properties.volume

    if fits(kernel) and is_simple(shape):
        return Estimate(kernel, _SIMPLE_ERROR)
    origin = mean_of_vertices(shape)
    if origin is None:
        origin = np.array(kernel.unit_density.com) * MILLIMETRES_PER_METRE
    own = _integrated(shape, origin, kernel)
    if own is None:
        return _by_meshes(shape, mesh, [Estimate(kernel, inf)]) if is_closed else Estimate(kernel, inf)
    apart = _apart(own.properties, kernel)
    if apart <= _AGREEMENT and fits(own.properties):
        return Estimate(kernel if apart <= _SAME else own.properties, max(apart, _SIMPLE_ERROR))
    if apart <= CERTAIN and own.error <= _AGREEMENT and fits(own.properties):
        return Estimate(own.properties, max(apart, own.error))
    opinions = (("stepbot", own.properties.volume), ("the kernel", kernel.volume))
    best = Estimate(own.properties, max(apart, own.error), opinions)
    if is_closed:
        best = _by_meshes(shape, mesh, [own, Estimate(kernel, 0.0)])
    if best.error > CERTAIN and own.error <= CERTAIN:
        adaptive, claimed = adaptive_volume(shape, CERTAIN)
        off = abs(adaptive / own.properties.volume - 1.0)
        if max(off, claimed) <= CERTAIN:
            return Estimate(own.properties, max(off, claimed, own.error))
        best = replace(best, opinions=(*best.opinions, ("adaptive integration", adaptive)))
    return best


def _middle(mesh: Stitched) -> Array:
    """The middle (3,) [mm] of the bounding box."""
    low, high = corners(mesh.vertices)
    return np.asarray(0.5 * (low + high))


def by_mesh(mesh: Stitched) -> VolumeProperties | None:
    """Mass properties of a closed mesh [mm], where the kernel's integration has no result; None without a volume."""
    origin = _middle(mesh)
    return properties_of(_moments(mesh, origin), origin)


def is_simple(shape: Any) -> bool:
    """Whether all faces are planes, cylinders, cones, spheres or tori, and all edges short."""
    if any(BRepAdaptor_Surface(face, False).GetType() not in _SIMPLE for face in faces_of(shape)):
        return False
    edges = mapped(shape, TopAbs_ShapeEnum.TopAbs_EDGE)
    for index in range(1, edges.Extent() + 1):
        edge = TopoDS.Edge(edges.FindKey(index))
        if BRep_Tool.Degenerated_s(edge):
            continue
        curve = BRepAdaptor_Curve(edge)
        if curve.GetType() == GeomAbs_CurveType.GeomAbs_BSplineCurve and curve.NbKnots() > _SIMPLE_SPANS + 1:
            return False
    return True


def _integrated(shape: Any, origin: Array, kernel: VolumeProperties) -> Estimate | None:
    """By stepbot's own integration; its error is estimated where the kernel's does not agree with it."""
    boundary = Boundary(shape, origin)
    plain = properties_of(boundary.integrals(1), origin)
    if plain is not None and (apart := _apart(plain, kernel)) <= _AGREEMENT:
        return Estimate(plain, apart)
    moments, error = boundary.converged(_CONVERGED)
    properties = properties_of(moments, origin)
    return None if properties is None else Estimate(properties, error)


def _by_meshes(shape: Any, mesh: Tessellation, candidates: list[Estimate]) -> Estimate:
    """The candidate that increasingly fine meshes converge to, and its deviation from their limit.

    The error of a mesh falls with the square of its angles, and with its deflection, so that two meshes give the
    limit. The first two are the existing one and a coarser one.
    """
    origin = _middle(mesh.mesh)
    coarse = tessellated_once(shape, mesh.fineness.scaled_by_square(2.0)).mesh
    last = _moments(coarse, origin) if is_watertight(coarse.faces) else None
    current, fine, opinions = mesh.mesh, mesh.fineness, []
    best = replace(candidates[0], error=inf)
    while True:
        if is_watertight(current.faces):
            moments = _moments(current, origin)
            limits = [moments] if last is None else [moments, (4.0 * moments - last) / 3.0]
            last = moments
            for limit in filter(None, (properties_of(limit, origin) for limit in limits)):
                judged = [replace(c, error=max(c.error, _apart(limit, c.properties))) for c in candidates]
                best = min(best, *judged, key=lambda estimate: estimate.error)
                opinions = [("meshes", limit.volume)]
        if best.error <= CERTAIN or len(current.faces) > _MOST_TRIANGLES:
            break
        fine = fine.scaled_by_square(0.5)
        current = tessellated_once(shape, fine).mesh
    if best.error <= CERTAIN:
        return best
    names = ("stepbot", "the kernel") if len(candidates) > 1 else ("the kernel",)
    volumes = (c.properties.volume for c in candidates)
    return replace(best, opinions=(*zip(names, volumes, strict=True), *opinions))


def _apart(a: VolumeProperties, b: VolumeProperties) -> float:
    return a.deviation_from(b)[0]


def _moments(mesh: Stitched, origin: Array) -> Array:
    """The ten integrals of :meth:`.Boundary.integrals` over a closed mesh."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - origin for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = a + b + c
    second = [
        (volume * (total[:, i] * total[:, j] + a[:, i] * a[:, j] + b[:, i] * b[:, j] + c[:, i] * c[:, j])).sum() / 20.0
        for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    ]
    return np.array([volume.sum(), *(volume[:, None] * total).sum(axis=0) / 4.0, *second])
