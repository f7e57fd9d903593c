"""Volume, first and second moments of a solid by stepbot's own integration over its faces.

The divergence theorem makes an integral over a solid one over its faces: that of a homogeneous f of degree k is
the flux of f S / (3 + k). Green's theorem makes that one around their boundaries (:mod:`.contours`). Surfaces and edges
are cut where they are less smooth, at their knots, so that Gauss's rule converges on every piece as the pieces shrink.

The error has two parts. Fewer Gauss points show that of the rule, which smaller pieces reduce. A boundary that does not
close leaves the other: the integral then depends on where along v it starts, which no finer rule changes.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from msgspec import Struct, field
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.collections import Array1_double
from OCP.GeomAbs import GeomAbs_Shape, GeomAbs_SurfaceType
from OCP.GeomAdaptor import GeomAdaptor_Surface
from OCP.GeomConvert import GeomConvert
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopoDS import TopoDS

from stepbot.geometry.spatial import Array
from stepbot.geometry.volume import VolumeProperties

from ..kernel import MILLIMETRES_PER_METRE, faces_of
from .contours import Contours, Rule, add_curved, add_planar, gauss
from .curves import curve_of, spline_surface
from .splines import Indices, SplineSurface
from .surfaces import Frames, Patch, extruded, planes, quadrics, revolved, sampled, splined

_ROWS = 2000
"""Boundary points that are integrated to at once."""
_MOST_PARTS = 8
"""Parts of a smooth piece at most."""
_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_NONE = np.empty(0)


class _Group(Struct):
    """Faces of one kind of surface."""

    contours: Contours = field(default_factory=Contours)
    positions: list[Any] = field(default_factory=list)
    shapes: list[tuple[float, float, float, float]] = field(default_factory=list)
    signs: list[float] = field(default_factory=list)


class _Surface(Struct, frozen=True, eq=False, dict=True):
    """A patch with the boundaries of its faces."""

    patch: Patch
    contours: Contours
    signs: Array
    """Shape (n,): -1 for each face that looks the other way than its surface."""
    turning: bool

    def integrals(self, parts: int, *, coarse: bool = False) -> Array:
        """What the faces contribute to the ten integrals."""
        is_whole = parts == 1 and not coarse
        rule = self._whole if is_whole else self.contours.rule(self.turning, parts, coarse)
        return self._integral(rule, parts, coarse)

    def undetermined(self) -> Array:
        """How far the integrals depend on where they start, in a face whose boundary does not close."""
        faces, v = self._whole.faces, self._whole.uv[:, 1]
        if not len(faces):
            return np.zeros(10)
        gaps: Array = np.bincount(faces, self._whole.du, len(self.signs)).astype(np.float64)
        low, high = np.full(len(gaps), np.inf), np.full(len(gaps), -np.inf)
        np.minimum.at(low, faces, v)
        np.maximum.at(high, faces, v)
        each = np.unique(faces, return_index=True)[1]
        used = faces[each]
        start = self._starts[used]
        end = np.where(high[used] - start > start - low[used], high[used], low[used])
        across = Rule(used, np.stack([self._whole.uv[each, 0], end], axis=1), gaps[used])
        return np.abs(self._integral(across, 1, coarse=False))

    @cached_property
    def _whole(self) -> Rule:
        return self.contours.rule(self.turning, 1)

    @cached_property
    def _starts(self) -> Array:
        """For each face the v that its integrals start at, however finely it is divided."""
        starts = np.zeros(len(self.signs))
        faces, first = np.unique(self._whole.faces, return_index=True)
        starts[faces] = self._whole.uv[first, 1]
        return starts

    def _integral(self, rule: Rule, parts: int, coarse: bool) -> Array:
        patch, total = self.patch, np.zeros(10)
        # Along v an exact rule needs neither smaller pieces nor a check by fewer points.
        order, parts = (patch.order, 1) if patch.is_exact else (patch.order * 2 // 3 if coarse else patch.order, parts)
        nodes, weights = gauss(order)
        starts = self._starts[rule.faces]
        used = np.flatnonzero((rule.du != 0.0) & (rule.uv[:, 1] != starts))
        for at in range(0, len(used), _ROWS):
            cut = used[at : at + _ROWS]
            faces, (u, v) = rule.faces[cut], rule.uv[cut].T
            section, du = patch.section(u, faces), -self.signs[faces] * rule.du[cut]
            for rows, low, high, lengths in _panels(starts[cut], v, patch.breaks[1], parts):
                points, flux = section(rows, low + (high - low) * nodes[:, None])
                total += _moments(points, du[rows] * lengths * weights[:, None] * flux)
        return total


class Boundary:
    """The faces of a solid, read from the kernel once, to integrate over as finely as it takes."""

    _surfaces: list[_Surface]

    def __init__(self, shape: Any, origin: Array) -> None:
        """From a solid whose faces look outwards, and a point near it, which coordinates are taken with respect to."""
        flat, straight, round_ = _Group(), _Group(), _Group()
        self._surfaces = []
        for face in faces_of(shape):
            orientation = face.Orientation()
            if orientation not in (TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED):
                continue
            sign = -1.0 if orientation == TopAbs_Orientation.TopAbs_REVERSED else 1.0
            forward = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
            surface = BRepAdaptor_Surface(face, False)
            kind = surface.GetType()
            if kind == GeomAbs_SurfaceType.GeomAbs_Plane:
                position = surface.Plane().Position()
                add_planar(flat.contours, len(flat.signs), forward, position)
                flat.positions.append(position)
                flat.signs.append(sign)
            elif (quadric := _quadric(surface, kind)) is not None:
                position, numbers = quadric
                group = round_ if numbers[2] else straight
                add_curved(group.contours, len(group.signs), forward, (_NONE, _NONE), split_lines=False)
                group.positions.append(position)
                group.shapes.append(numbers)
                group.signs.append(sign)
            else:
                patch, contours = _patch(face, origin), Contours()
                add_curved(contours, 0, forward, patch.breaks, split_lines=True)
                self._surfaces.append(_Surface(patch, contours, np.array([sign]), turning=False))
        if flat.signs:
            patch = planes(Frames.of(flat.positions, origin))
            self._surfaces.append(_Surface(patch, flat.contours, np.array(flat.signs), turning=False))
        for group, order in ((straight, 3), (round_, 24)):
            if group.signs:
                frames = Frames.of(group.positions, origin)
                patch = quadrics(frames, np.array(group.shapes), order, is_exact=group is straight)
                self._surfaces.append(_Surface(patch, group.contours, np.array(group.signs), turning=True))

    def integrals(self, parts: int) -> Array:
        """Integrals of 1; x, y, z; and their products over what the faces enclose.

        Args:
            parts: How many parts each smooth piece is divided into.

        Returns:
            Shape (10,): volume; first moments; second moments xx, xy, xz, yy, yz, zz.
        """
        return _sum([surface.integrals(parts) for surface in self._surfaces] if parts > 1 else self._undivided)

    def converged(self, tolerance: float) -> tuple[Array, float]:
        """The integrals, with smaller pieces for surfaces whose error is above its share of the tolerance.

        Returns:
            Shape (10,), as of :meth:`integrals`; and the error, relative, of volume, centre and inertia.
        """
        settled = list(self._undivided)
        changes = [a - surface.integrals(1, coarse=True) for surface, a in zip(self._surfaces, settled, strict=True)]
        total = _sum(settled)
        for k in np.flatnonzero(relative_sizes(np.array(changes), total) > tolerance / len(settled)):
            parts, error = 1, np.inf
            while parts < _MOST_PARTS and error > tolerance / len(settled):
                parts *= 2
                finer = self._surfaces[k].integrals(parts)
                changes[k], settled[k] = finer - settled[k], finer
                error = relative_sizes(changes[k][None], total)[0]
        total = _sum(settled)
        open_ = [surface.undetermined() for surface in self._surfaces]
        return total, float(relative_sizes(np.array(changes + open_), total).sum())

    @cached_property
    def _undivided(self) -> list[Array]:
        return [surface.integrals(1) for surface in self._surfaces]


def relative_sizes(changes: Array, moments: Array) -> Array:
    """Sizes (n,) of small changes (n, 10) of a solid's integrals (10,): the largest of volume, centre and inertia.

    The inertia's is about the axis with the largest one, the centre's in radii of gyration.
    """
    volume = moments[0]
    if not (np.isfinite(moments).all() and np.isfinite(changes).all() and volume > 0.0):
        return np.full(len(changes), np.inf)
    com = moments[1:4] / volume
    principal, axes = np.linalg.eigh(_inertia(moments[4:] - volume * _products(com, com)))
    if not principal[0] > 0.0:
        return np.full(len(changes), np.inf)
    of_volume = changes[:, 0]
    shift = changes[:, 1:4] - com * of_volume[:, None]
    second = changes[:, 4:] - 2.0 * _products(shift, com) - of_volume[:, None] * _products(com, com)
    scaled = axes / np.sqrt(principal)
    turned = np.linalg.eigvalsh(scaled.T @ _inertia(second) @ scaled)
    gyration = np.sqrt(principal.sum() / (2.0 * volume))
    moved = np.sqrt((shift**2).sum(axis=1)) / gyration
    return np.asarray(np.max([np.abs(of_volume) / volume, moved / volume, np.abs(turned).max(axis=1)], axis=0))


def _products(a: Array, b: Array) -> Array:
    """The symmetric part of the products of two vectors: xx, xy, xz, yy, yz, zz."""
    return np.stack([0.5 * (a[..., i] * b[..., j] + a[..., j] * b[..., i]) for i, j in _PAIRS], axis=-1)


def _inertia(second: Array) -> Array:
    """Inertia matrices (..., 3, 3) from second moments (..., 6)."""
    matrix = second[..., [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(*second.shape[:-1], 3, 3)
    return (second[..., 0] + second[..., 3] + second[..., 5])[..., None, None] * np.eye(3) - matrix


def _sum(parts: Sequence[Array]) -> Array:
    total = np.zeros(10)
    for part in parts:
        total += part
    return total


def properties_of(moments: Array, origin: Array) -> VolumeProperties | None:
    """In SI, from integrals in millimetres about an origin; None where there is no volume."""
    volume = float(moments[0])
    if not (np.isfinite(moments).all() and volume > 0.0):
        return None
    com = moments[1:4] / volume
    inertia = _inertia(moments[4:] - volume * _products(com, com))
    scale = MILLIMETRES_PER_METRE
    return VolumeProperties.rounded(volume / scale**3, (com + origin) / scale, inertia / scale**5)


def _quadric(surface: Any, kind: Any) -> tuple[Any, tuple[float, float, float, float]] | None:
    """Position and shape (see :func:`.surfaces.quadrics`) of a cylinder, cone, sphere or torus."""
    if kind == GeomAbs_SurfaceType.GeomAbs_Cylinder:
        cylinder = surface.Cylinder()
        return cylinder.Position(), (cylinder.Radius(), 0.0, 0.0, 1.0)
    if kind == GeomAbs_SurfaceType.GeomAbs_Cone:
        cone = surface.Cone()
        angle = cone.SemiAngle()
        return cone.Position(), (cone.RefRadius(), float(np.sin(angle)), 0.0, float(np.cos(angle)))
    if kind == GeomAbs_SurfaceType.GeomAbs_Sphere:
        sphere = surface.Sphere()
        return sphere.Position(), (0.0, 0.0, sphere.Radius(), 0.0)
    if kind == GeomAbs_SurfaceType.GeomAbs_Torus:
        torus = surface.Torus()
        return torus.Position(), (torus.MajorRadius(), 0.0, torus.MinorRadius(), 0.0)
    return None


def _patch(face: Any, origin: Array) -> Patch:
    """The surface of a face that is no plane and no quadric."""
    surface = GeomAdaptor_Surface(BRep_Tool.Surface_s(face))
    kind = surface.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_BSplineSurface:
        return _splined(spline_surface(surface.BSpline()), origin)
    if kind == GeomAbs_SurfaceType.GeomAbs_BezierSurface:
        return _splined(spline_surface(GeomConvert.SurfaceToBSplineSurface_s(surface.Bezier())), origin)
    if kind == GeomAbs_SurfaceType.GeomAbs_SurfaceOfExtrusion:
        way = surface.Direction()
        return extruded(curve_of(surface.BasisCurve(), 3), origin, np.array([way.X(), way.Y(), way.Z()]))
    if kind == GeomAbs_SurfaceType.GeomAbs_SurfaceOfRevolution:
        axis = surface.AxeOfRevolution()
        at, way = axis.Location(), axis.Direction()
        center, direction = (np.array([p.X(), p.Y(), p.Z()]) for p in (at, way))
        return revolved(curve_of(surface.BasisCurve(), 3), center, direction, origin)
    return sampled(surface, origin, (_intervals(surface, "U"), _intervals(surface, "V")))


def _splined(surface: SplineSurface, origin: Array) -> Patch:
    poles = surface.poles.copy()
    poles[..., :3] -= origin * poles[..., 3:]
    return splined(SplineSurface(surface.u, surface.v, poles))


def _intervals(surface: Any, direction: str) -> Array:
    smooth = GeomAbs_Shape.GeomAbs_CN
    bounds = Array1_double(1, getattr(surface, f"Nb{direction}Intervals")(smooth) + 1)
    getattr(surface, f"{direction}Intervals")(bounds, smooth)
    return np.array(list(bounds))


def _panels(start: Array, end: Array, breaks: Array, parts: int) -> Iterator[tuple[Indices, Array, Array, Array]]:
    """Ways (m,) from start to end, cut at breaks and then into parts, the pieces that are a whole interval together.

    Yields:
        Numbers of the ways (k,); lower and upper end of each piece, (k,) or (1,) where all have the same; and their
        lengths (k,), negative downwards.
    """
    edges = np.concatenate([[-np.inf], breaks[1:-1], [np.inf]])
    low = np.clip(start[:, None], edges[:-1], edges[1:])
    high = np.clip(end[:, None], edges[:-1], edges[1:])
    whole = np.abs(high - low) == np.diff(edges)
    share = np.arange(parts + 1) / parts
    for interval in np.flatnonzero(whole.any(axis=0)).tolist():
        rows = np.flatnonzero(whole[:, interval])
        cuts = edges[interval] + (edges[interval + 1] - edges[interval]) * share
        lengths = np.where(high[rows, interval] > low[rows, interval], 1.0, -1.0)
        for a, b in zip(cuts[:-1, None], cuts[1:, None], strict=True):
            yield rows, a, b, lengths * (b - a)
    rows, panels = np.nonzero((low != high) & ~whole)
    if len(rows):
        low, high = low[rows, panels], high[rows, panels]
        cuts = low[:, None] + (high - low)[:, None] * share
        low, high = cuts[:, :-1].reshape(-1), cuts[:, 1:].reshape(-1)
        yield np.repeat(rows, parts), low, high, high - low


def _moments(points: Array, share: Array) -> Array:
    (x, y, z), share = points.reshape(3, -1), share.reshape(-1)
    weighted = [share, share * x, share * y, share * z]
    second = [weighted[1] * x, weighted[1] * y, weighted[1] * z, weighted[2] * y, weighted[2] * z, weighted[3] * z]
    return np.array(
        [w.sum() * f for w, f in zip([*weighted, *second], (1 / 3, *(1 / 4,) * 3, *(1 / 5,) * 6), strict=True)]
    )
