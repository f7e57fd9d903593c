"""Cylindrical and conical faces of a body, which define the lines that joints can bind to.

The extent along the axis is that of the trimmed face, so it is computed from the face's edges: exactly at the ends of
straight lines and of circles about the axis, elsewhere at the extremes of the curve. A free-form face counts if it is a
cylinder or a cone.

Planes, cylinders, cones and spheres may be written as free-form surfaces: B-splines, swept or revolved curves.
The kernel fits the surface. A deviation up to the tolerance moves the axis of a face that covers
a quarter of the circumference or more by less than ten times as much, 1e-6 m.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.gp import gp_Ax1, gp_Cone, gp_Cylinder, gp_Pln, gp_Pnt, gp_Sphere, gp_Vec
from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from ..assembly import AxisFace
from ..kernel import KERNEL_ERRORS, MILLIMETRES_PER_METRE, OUT_OF_MEMORY, evaluated, explored

_SAMPLES = 16
"""Number of samples on a curve between which its extremes are searched."""
_SECTIONS = 32
"""Steps of the search: they leave 2e-7 of the interval, and its square of the height."""
_LEVEL = 1e-9
"""Difference of height [mm] up to which samples are equal."""
_PARALLEL = 1e-9
"""Angle [rad] up to which directions are parallel."""
_SMALLEST = 1e-6
"""Radius [mm] below which a face is ignored: meshes are on a grid of a nanometre."""
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def axis_faces(faces: list[Any], errors: list[str]) -> tuple[AxisFace, ...]:
    """The faces of a body that are on a cylinder or a cone, in order; ``errors`` as for :func:`.evaluated`."""
    return tuple(face for face in evaluated(_axis_face, faces, errors) if face is not None)


def _axis_face(face: Any) -> AxisFace | None:
    surface = BRepAdaptor_Surface(face)
    quadric = _quadric(face, surface)
    if quadric is None or (size := size_on(quadric, face)) is None:
        return None
    low, high, radius = size
    axis = quadric.Axis()
    point, direction, scale = axis.Location(), axis.Direction(), MILLIMETRES_PER_METRE
    return AxisFace(
        (point.X() / scale, point.Y() / scale, point.Z() / scale),
        (direction.X(), direction.Y(), direction.Z()),
        radius / scale,
        low / scale,
        high / scale,
        is_bore(face, surface, axis),
        isinstance(quadric, gp_Cone),
    )


def _quadric(face: Any, surface: Any) -> gp_Cylinder | gp_Cone | None:
    kind = surface.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_Cylinder:
        return surface.Cylinder()
    if kind == GeomAbs_SurfaceType.GeomAbs_Cone:
        return surface.Cone()
    return revolved(face) if kind in FREE_FORMS else None


def size_on(quadric: gp_Cylinder | gp_Cone, face: Any) -> tuple[float, float, float] | None:
    """Lowest and highest position [mm] of a face's edges along the axis of its quadric, and its radius [mm].

    Of a cone, the larger radius. None for a face without extent, an infinite one or a line.
    """
    low, high = math.inf, -math.inf
    for edge in map(TopoDS.Edge, explored(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
        if not BRep_Tool.Degenerated_s(edge):
            for place in _extremes(BRepAdaptor_Curve(edge), quadric.Axis()):
                low, high = min(low, place), max(high, place)
    if not (math.isfinite(low) and math.isfinite(high)) or high <= low:
        return None
    radius = float(quadric.RefRadius() if isinstance(quadric, gp_Cone) else quadric.Radius())
    if isinstance(quadric, gp_Cone):
        slope = math.tan(quadric.SemiAngle())
        radius = max(abs(radius + low * slope), abs(radius + high * slope))
    return (low, high, radius) if radius > _SMALLEST else None


def outwards(face: Any, surface: Any) -> tuple[gp_Pnt, gp_Vec]:
    """A point [mm] in the middle of a face's parameters, and its outward normal there, not of unit length."""
    u = 0.5 * (surface.FirstUParameter() + surface.LastUParameter())
    v = 0.5 * (surface.FirstVParameter() + surface.LastVParameter())
    at, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(u, v, at, along_u, along_v)
    normal = along_u.Crossed(along_v)
    return at, normal.Reversed() if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED else normal


def is_bore(face: Any, surface: Any, axis: gp_Ax1) -> bool:
    """Whether the outward normal of the face points towards the axis."""
    at, normal = outwards(face, surface)
    # Along the axis the normal of a cone leans either way; only its component away from the axis counts.
    along, away = gp_Vec(axis.Direction()), gp_Vec(axis.Location(), at)
    away.Subtract(along.Multiplied(away.Dot(along)))
    return bool(normal.Dot(away) < 0.0)


def _extremes(curve: Any, axis: gp_Ax1) -> list[float]:
    """Candidate positions along a line of the lowest and the highest point of a curve."""
    origin, direction = axis.Location(), axis.Direction()
    x, y, z = direction.X(), direction.Y(), direction.Z()
    start = origin.X() * x + origin.Y() * y + origin.Z() * z

    def place(parameter: float) -> float:
        at = curve.Value(parameter)
        return float(at.X() * x + at.Y() * y + at.Z() * z - start)

    first, last = curve.FirstParameter(), curve.LastParameter()
    ends = [place(first), place(last)]
    if curve.GetType() == GeomAbs_CurveType.GeomAbs_Line or _is_around(curve, axis):
        return ends
    step = (last - first) / _SAMPLES
    places = [ends[0], *(place(first + step * k) for k in range(1, _SAMPLES)), ends[1]]
    slopes = [_slope(curve, parameter, direction) for parameter in (first, last)]
    return [
        *ends,
        _highest(place, places, first, step, slopes),
        -_highest(lambda p: -place(p), [-p for p in places], first, step, [-slope for slope in slopes]),
    ]


def _slope(curve: Any, parameter: float, direction: Any) -> float:
    """Derivative of a curve along a direction."""
    at, tangent = gp_Pnt(), gp_Vec()
    curve.D1(parameter, at, tangent)
    return float(tangent.Dot(gp_Vec(direction)))


def _is_around(curve: Any, axis: gp_Ax1) -> bool:
    """Whether a curve is a circle whose plane is perpendicular to a line: all of it is at one position."""
    if curve.GetType() != GeomAbs_CurveType.GeomAbs_Circle:
        return False
    return bool(curve.Circle().Axis().Direction().IsParallel(axis.Direction(), _PARALLEL))


def _highest(
    place: Callable[[float], float], places: list[float], first: float, step: float, slopes: list[float]
) -> float:
    """Maximum of a function near its largest samples; for a closed curve both ends are candidates.

    At an end towards which the function rises, the end itself.
    """
    top = max(places)
    rises = {0: slopes[0] < 0.0, len(places) - 1: slopes[1] > 0.0}
    peaks = [k for k, value in enumerate(places) if value >= top - _LEVEL and not rises.get(k, False)]
    last = len(places) - 1
    return max([top, *(_peak(place, first + step * max(k - 1, 0), first + step * min(k + 1, last)) for k in peaks)])


def _peak(place: Callable[[float], float], low: float, high: float) -> float:
    """Maximum of a unimodal function in an interval (golden section)."""
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_a, at_b = place(a), place(b)
    for _ in range(_SECTIONS):
        if at_a > at_b:
            high, b, at_b = b, a, at_a
            a = high - _GOLDEN * (high - low)
            at_a = place(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + _GOLDEN * (high - low)
            at_b = place(b)
    return max(at_a, at_b)


FREE_FORMS = (
    GeomAbs_SurfaceType.GeomAbs_BSplineSurface,
    GeomAbs_SurfaceType.GeomAbs_BezierSurface,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfRevolution,
    GeomAbs_SurfaceType.GeomAbs_SurfaceOfExtrusion,
)
_TOLERANCE = 1e-4
"""Maximum deviation [mm] of a free-form surface from a plane or quadric."""


def revolved(face: Any) -> gp_Cylinder | gp_Cone | None:
    """The cylinder or cone that a free-form face is on; None if it is on neither, or the kernel fails on it."""
    return _first(face, (("IsCylinder", gp_Cylinder()), ("IsCone", gp_Cone())))


def recognized(face: Any) -> gp_Pln | gp_Cylinder | gp_Cone | gp_Sphere | None:
    """The plane, cylinder, cone or sphere that a free-form face is on; None as for :func:`revolved`."""
    forms = ("IsPlane", gp_Pln()), ("IsCylinder", gp_Cylinder()), ("IsCone", gp_Cone()), ("IsSphere", gp_Sphere())
    return _first(face, forms)


def _first(face: Any, forms: Iterable[tuple[str, Any]]) -> Any:
    """The first form that the face has, fitted to it.

    Each is tried alone: the kernel fails on some faces, with a null curve or a division by zero.
    """
    for test, form in forms:
        try:
            if getattr(ShapeAnalysis_CanonicalRecognition(face), test)(_TOLERANCE, form):
                return form
        except OUT_OF_MEMORY:
            raise
        except KERNEL_ERRORS:
            continue
    return None


_KINDS = {
    GeomAbs_SurfaceType.GeomAbs_Plane: "plane",
    GeomAbs_SurfaceType.GeomAbs_Cylinder: "cylinder",
    GeomAbs_SurfaceType.GeomAbs_Cone: "cone",
    GeomAbs_SurfaceType.GeomAbs_Sphere: "sphere",
    GeomAbs_SurfaceType.GeomAbs_Torus: "torus",
}
_OTHER = "other"


def face_counts(faces: list[Any]) -> tuple[tuple[str, int], ...]:
    """Number of a body's faces by the kind of their surface in the file, sorted by name."""
    return tuple(sorted(Counter(_KINDS.get(BRepAdaptor_Surface(face).GetType(), _OTHER) for face in faces).items()))
