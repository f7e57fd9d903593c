"""Reads all faces of a body: see :mod:`stepbot.step.faces`."""

import math
from typing import Any

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.gp import gp_Cone, gp_Cylinder, gp_Pln, gp_Sphere
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from stepbot.geometry.spatial import ZERO3, Array, Vector3, bounds, dot, vector3

from ..faces import Face, FaceKind
from ..kernel import MILLIMETRES_PER_METRE, evaluated, explored
from .axis_faces import FREE_FORMS, is_bore, outwards, recognized, size_on

_LARGEST = 1e6
"""Size [mm] of a bounding box from which it is that of an infinite surface, not of the face."""
_SEGMENTS = 16
"""Number of straight segments for a curved edge."""
_ALL_ROUND = 2.0 * math.pi
_NO_AXIS = (0.0, 0.0, 1.0)
_FORMS = {
    GeomAbs_SurfaceType.GeomAbs_Plane: BRepAdaptor_Surface.Plane,
    GeomAbs_SurfaceType.GeomAbs_Cylinder: BRepAdaptor_Surface.Cylinder,
    GeomAbs_SurfaceType.GeomAbs_Cone: BRepAdaptor_Surface.Cone,
    GeomAbs_SurfaceType.GeomAbs_Sphere: BRepAdaptor_Surface.Sphere,
}
"""The form of a surface of a type."""


def read_faces(faces: list[Any], errors: list[str]) -> tuple[Face, ...]:
    """All of a body's faces that the kernel can evaluate, in their order; ``errors`` as for :func:`.evaluated`."""
    return tuple(face for face in evaluated(_read_face, faces, errors) if face is not None)


def _read_face(face: Any) -> Face | None:
    surface = BRepAdaptor_Surface(face)
    geometry = _geometry(face, surface)
    box = _box(face)
    if isinstance(geometry, gp_Pln):
        return _plane(face, surface, geometry, box)
    if isinstance(geometry, gp_Cylinder | gp_Cone):
        return _revolved(face, surface, geometry, box)
    if isinstance(geometry, gp_Sphere):
        return _sphere(face, surface, geometry, box)
    if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Torus:
        torus = surface.Torus()
        point, direction = _metres(torus.Location()), _xyz(torus.Axis().Direction())
        radius = torus.MajorRadius() / MILLIMETRES_PER_METRE
        return Face(FaceKind.TORUS, point, direction, box, radius, span=_span(surface))
    middle = vector3(0.5 * (np.array(box[0]) + np.array(box[1])))
    return Face(FaceKind.OTHER, middle, _NO_AXIS, box)


def _geometry(face: Any, surface: Any) -> Any:
    """The plane, cylinder, cone or sphere of a face; None for others."""
    kind = surface.GetType()
    if kind in _FORMS:
        return _FORMS[kind](surface)
    return recognized(face) if kind in FREE_FORMS else None


def _plane(face: Any, surface: Any, plane: gp_Pln, box: tuple[Vector3, Vector3]) -> Face:
    normal = np.array(_xyz(plane.Axis().Direction()))
    if dot(np.array(_xyz(outwards(face, surface)[1])), normal) < 0.0:
        normal = -normal
    # A point in the middle of the face's box keeps coordinates small.
    middle = 0.5 * (np.array(box[0]) + np.array(box[1]))
    point = middle - normal * float(dot(middle - np.array(_metres(plane.Location())), normal))
    return Face(FaceKind.PLANE, vector3(point), vector3(normal), box, rings=_rings(face))


def _revolved(face: Any, surface: Any, quadric: Any, box: tuple[Vector3, Vector3]) -> Face | None:
    size = size_on(quadric, face)
    if size is None:
        return None
    low, high, radius = size
    kind, axis = FaceKind.CONE if isinstance(quadric, gp_Cone) else FaceKind.CYLINDER, quadric.Axis()
    direction = np.array(_xyz(axis.Direction()))
    point = np.array(_metres(axis.Location())) + direction * (0.5 * (low + high) / MILLIMETRES_PER_METRE)
    return Face(
        *(kind, vector3(point), vector3(direction), box, radius / MILLIMETRES_PER_METRE),
        *((high - low) / MILLIMETRES_PER_METRE, is_bore(face, surface, axis), _span(surface)),
    )


def _sphere(face: Any, surface: Any, sphere: gp_Sphere, box: tuple[Vector3, Vector3]) -> Face:
    centre = _metres(sphere.Location())
    at, normal = outwards(face, surface)
    is_socket = bool((np.array(_metres(at)) - np.array(centre)) @ np.array(_xyz(normal)) < 0.0)
    radius = sphere.Radius() / MILLIMETRES_PER_METRE
    return Face(FaceKind.SPHERE, centre, _NO_AXIS, box, radius, bore=is_socket, span=_span(surface))


def _span(surface: Any) -> float:
    """Angle about the axis that a face covers; the full circle for a free-form surface, whose parameter is no angle."""
    if surface.GetType() in FREE_FORMS:
        return _ALL_ROUND
    return min(_ALL_ROUND, abs(float(surface.LastUParameter() - surface.FirstUParameter())))


def _box(face: Any) -> tuple[Vector3, Vector3]:
    box = Bnd_Box()
    BRepBndLib.Add_s(face, box, False)
    if box.IsVoid():
        return ZERO3, ZERO3
    box.SetGap(0.0)
    if not box.IsOpen():
        low, high = box.CornerMin(), box.CornerMax()
        if low.Distance(high) < _LARGEST:
            return _metres(low), _metres(high)
    rings = _rings(face)  # of a face on an infinite surface
    return bounds(np.concatenate(rings)) if rings else (ZERO3, ZERO3)


def _rings(face: Any) -> tuple[Array, ...]:
    """Outline of a face, the outer wire first."""
    outer = BRepTools.OuterWire_s(face)
    rings: list[Array] = []
    for wire in map(TopoDS.Wire, explored(face, TopAbs_ShapeEnum.TopAbs_WIRE)):
        pieces = []
        edges = BRepTools_WireExplorer(wire, face)
        while edges.More():
            if not BRep_Tool.Degenerated_s(edges.Current()):
                pieces.append(_edge_points(edges.Current()))
            edges.Next()
        ring = np.concatenate(pieces) if pieces else np.zeros((0, 3))
        if len(ring) >= 3:
            rings.insert(0, ring) if wire.IsSame(outer) else rings.append(ring)
    return tuple(rings)


def _edge_points(edge: Any) -> Array:
    """Points (n, 3) [m] of an edge in the direction of its wire, without the last."""
    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    is_reversed = edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
    kind = curve.GetType()
    if kind == GeomAbs_CurveType.GeomAbs_Line:
        return np.array([_metres(curve.Value(last if is_reversed else first))])
    parameters = np.linspace(first, last, _SEGMENTS + 1)
    if is_reversed:
        parameters = parameters[::-1]
    if kind == GeomAbs_CurveType.GeomAbs_Circle:
        circle = curve.Circle()
        centre, radius = np.array(_metres(circle.Location())), circle.Radius() / MILLIMETRES_PER_METRE
        x, y = np.array(_xyz(circle.XAxis().Direction())), np.array(_xyz(circle.YAxis().Direction()))
        t = parameters[:-1, None]
        return np.asarray(centre + radius * (np.cos(t) * x + np.sin(t) * y))
    return np.array([_metres(curve.Value(t)) for t in parameters[:-1].tolist()])


def _xyz(p: Any) -> Vector3:
    return p.X(), p.Y(), p.Z()


def _metres(p: Any) -> Vector3:
    return p.X() / MILLIMETRES_PER_METRE, p.Y() / MILLIMETRES_PER_METRE, p.Z() / MILLIMETRES_PER_METRE
