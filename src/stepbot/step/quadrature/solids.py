"""Volume, first and second moments of a solid by stepbot's own integration over its faces.

The divergence theorem makes an integral over a solid one over its faces: that of a homogeneous f of degree k is
the flux of f S / (3 + k). Green's theorem makes that one around their boundaries (:mod:`.contours`). Surfaces and edges
are cut where they are less smooth, at their knots, so that Gauss's rule converges on every piece as the pieces shrink.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
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

from ..kernel import MILLIMETRES_PER_METRE
from ..topology import faces_of
from .contours import Contours, Rule, add_curved, add_planar, gauss
from .curves import curve_of, spline_surface
from .splines import SplineSurface
from .surfaces import Extruded, Frames, Patch, Planes, Quadrics, Revolved, Sampled, Splined

_ROWS = 1000
"""Boundary points that are integrated to at once."""
_NONE = np.empty(0)


@dataclass
class _Group:
    """Faces of one kind of surface."""

    contours: Contours = field(default_factory=Contours)
    positions: list[Any] = field(default_factory=list)
    shapes: list[tuple[float, float, float, float]] = field(default_factory=list)
    signs: list[float] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class _Surface:
    """A patch with the boundaries of its faces."""

    patch: Patch
    contours: Contours
    signs: Array
    """Shape (n,): -1 for each face that looks the other way than its surface."""
    turning: bool

    def integrals(self, parts: int) -> Array:
        return _integral(self.patch, self.contours.rule(self.turning, parts), self.signs, parts)


class Boundary:
    """The faces of a solid, read from the kernel once, to integrate over as finely as it takes."""

    def __init__(self, shape: Any, origin: Array) -> None:
        """From a solid whose faces look outwards, and a point near it, which coordinates are taken with respect to."""
        planes, straight, round_ = _Group(), _Group(), _Group()
        self._surfaces: list[_Surface] = []
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
                add_planar(planes.contours, len(planes.signs), forward, position)
                planes.positions.append(position)
                planes.signs.append(sign)
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
        if planes.signs:
            flat = Planes(Frames.of(planes.positions, origin))
            self._surfaces.append(_Surface(flat, planes.contours, np.array(planes.signs), turning=False))
        for group, order in ((straight, 3), (round_, 24)):
            if group.signs:
                quadrics = Quadrics(Frames.of(group.positions, origin), np.array(group.shapes), order)
                self._surfaces.append(_Surface(quadrics, group.contours, np.array(group.signs), turning=True))

    def integrals(self, parts: int) -> Array:
        """Integrals of 1; x, y, z; and their products over what the faces enclose.

        Args:
            parts: How many parts each smooth piece is divided into.

        Returns:
            Shape (10,): volume; first moments; second moments xx, xy, xz, yy, yz, zz.
        """
        total = np.zeros(10)
        for surface in self._surfaces:
            total += surface.integrals(parts)
        return total


def quadrature(shape: Any, origin: Array, parts: int) -> Array:
    """The integrals of :meth:`Boundary.integrals`, of a solid that is integrated over once."""
    return Boundary(shape, origin).integrals(parts)


def properties_of(moments: Array, origin: Array) -> VolumeProperties | None:
    """In SI, from integrals in millimetres about an origin; None where there is no volume."""
    volume = float(moments[0])
    if not (np.isfinite(moments).all() and volume > 0.0):
        return None
    com = moments[1:4] / volume
    xx, xy, xz, yy, yz, zz = moments[4:]
    second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - volume * np.outer(com, com)
    inertia = np.trace(second) * np.eye(3) - second
    scale = MILLIMETRES_PER_METRE
    return VolumeProperties.rounded(volume / scale**3, (com + origin) / scale, inertia / scale**5)


def _quadric(surface: Any, kind: Any) -> tuple[Any, tuple[float, float, float, float]] | None:
    """Position and shape (see :class:`.surfaces.Quadrics`) of a cylinder, cone, sphere or torus."""
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
        return Extruded(curve_of(surface.BasisCurve(), 3), origin, np.array([way.X(), way.Y(), way.Z()]))
    if kind == GeomAbs_SurfaceType.GeomAbs_SurfaceOfRevolution:
        axis = surface.AxeOfRevolution()
        at, way = axis.Location(), axis.Direction()
        center, direction = (np.array([p.X(), p.Y(), p.Z()]) for p in (at, way))
        return Revolved(curve_of(surface.BasisCurve(), 3), center, direction, origin)
    return Sampled(surface, origin, (_intervals(surface, "U"), _intervals(surface, "V")))


def _splined(surface: SplineSurface, origin: Array) -> Splined:
    poles = surface.poles.copy()
    poles[..., :3] -= origin * poles[..., 3:]
    return Splined(SplineSurface(surface.u, surface.v, poles))


def _intervals(surface: Any, direction: str) -> Array:
    smooth = GeomAbs_Shape.GeomAbs_CN
    found = Array1_double(1, getattr(surface, f"Nb{direction}Intervals")(smooth) + 1)
    getattr(surface, f"{direction}Intervals")(found, smooth)
    return np.array(list(found))


def _integral(patch: Patch, rule: Rule, signs: Array, parts: int) -> Array:
    """What the faces of a patch contribute to the ten integrals."""
    total = np.zeros(10)
    if not len(rule.du):
        return total
    starts = np.zeros(len(signs))
    order = np.unique(rule.faces, return_index=True)
    starts[order[0]] = rule.uv[order[1], 1]
    nodes, weights = gauss(patch.order)
    for at in range(0, len(rule.du), _ROWS):
        cut = slice(at, at + _ROWS)
        faces, uv, du = rule.faces[cut], rule.uv[cut], rule.du[cut]
        section = patch.section(uv[:, 0], faces)
        rows, low, high = _panels(starts[faces], uv[:, 1], patch.breaks[1], parts)
        v = (low[:, None] + (high - low)[:, None] * nodes).reshape(-1)
        share = (-(signs[faces] * du)[rows, None] * (high - low)[:, None] * weights).reshape(-1)
        points, flux = section.at(np.repeat(rows, len(nodes)), v)
        total += _moments(points, share * flux)
    return total


def _panels(start: Array, end: Array, breaks: Array, parts: int) -> tuple[Any, Array, Array]:
    """Ways from start to end, cut at breaks and then into parts: number of the way, and both ends of each panel."""
    edges = np.concatenate([[-np.inf], breaks[1:-1], [np.inf]])
    low = np.clip(start[:, None], edges[:-1], edges[1:])
    high = np.clip(end[:, None], edges[:-1], edges[1:])
    rows, panels = np.nonzero(low != high)
    low, high = low[rows, panels], high[rows, panels]
    share = np.arange(parts + 1) / parts
    cuts = low[:, None] + (high - low)[:, None] * share
    return np.repeat(rows, parts), cuts[:, :-1].reshape(-1), cuts[:, 1:].reshape(-1)


def _moments(points: Array, share: Array) -> Array:
    x, y, z = points.T
    weighted = [share, share * x, share * y, share * z]
    second = [weighted[1] * x, weighted[1] * y, weighted[1] * z, weighted[2] * y, weighted[2] * z, weighted[3] * z]
    return np.array(
        [w.sum() * f for w, f in zip([*weighted, *second], (1 / 3, *(1 / 4,) * 3, *(1 / 5,) * 6), strict=True)]
    )
