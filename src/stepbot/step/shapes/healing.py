"""Heals one body like the kernel's own STEP import, with the precision that the file states.

With the kernel's default precision instead of the file's, volumes are wrong by percents; 126 files with 597 solids,
healed this way, have the volumes of the default import (586 of them to 1e-9, the worst to 1.3e-6).

Self-intersecting solids are closed, but part of their surface is inside them: any integration counts the volume of
overlapping lobes twice, so they are found, too.
"""

from typing import Any

import numpy as np
from msgspec import Struct
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_Copy,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepLib import BRepLib
from OCP.ShapeFix import ShapeFix_Shape
from OCP.TopAbs import TopAbs_ShapeEnum, TopAbs_State
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Solid

from stepbot.geometry.fixed_point import distinct
from stepbot.geometry.spatial import Array, Pose, cross

from ..kernel import MILLIMETRES_PER_METRE, faces_of, mapped
from .exact import integrate, surface_area
from .stitching import Indices, Stitched

_MAX_TOLERANCE = 1.0
"""Gaps [mm] up to which faces are joined."""
_MIN_TOLERANCE = 1e-7
_UNSCALED = 1e-9


class Healed(Struct, frozen=True, eq=False):
    """A body ready to be meshed and measured."""

    shape: Any
    origin: list[int]
    """For each of its faces the index of the original face before healing; -1 if there is none."""


def copied(shape: Any) -> Any:
    """A shape with its own topology: changes do not affect other bodies that share its faces.

    A location that mirrors or scales is applied to the geometry: the kernel neither meshes nor integrates below one.
    """
    location = shape.Location().Transformation()
    if location.IsNegative() or abs(location.ScaleFactor() - 1.0) > _UNSCALED:
        return BRepBuilderAPI_Transform(shape.Located(TopLoc_Location()), location, True).Shape()
    return BRepBuilderAPI_Copy(shape, False, False).Shape()


def healed(shape: Any, precision: float, colored: list[int]) -> Healed:
    """Heal a shape.

    Args:
        shape: A solid, shell or faces [mm]; changed in place.
        precision: Its uncertainty [mm].
        colored: Indices of the faces to be tracked.
    """
    before = mapped(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    fix = ShapeFix_Shape(shape)
    fix.SetPrecision(precision)
    fix.SetMaxTolerance(max(precision, _MAX_TOLERANCE))
    fix.SetMinTolerance(min(precision, _MIN_TOLERANCE))
    fix.Perform()
    result = fix.Shape()
    after = mapped(result, TopAbs_ShapeEnum.TopAbs_FACE)
    origins: dict[int, int] = {}  # by number, from 1: 0 is what healing drops
    for place in colored:
        replacement = fix.Context().Apply(before.FindKey(place + 1))
        if replacement is None or replacement.IsNull():
            continue
        pieces = mapped(replacement, TopAbs_ShapeEnum.TopAbs_FACE)
        for piece in range(1, pieces.Extent() + 1):
            origins[after.FindIndex(pieces.FindKey(piece))] = place
    return Healed(result, [origins.get(number, -1) for number in range(1, after.Extent() + 1)])


def with_islands(body: Healed) -> Healed | None:
    """The body with its shells outwards and inwards in turn, from the outside in; None where no void holds a shell.

    Healing turns every inner shell inwards, so that a lump inside a void would be subtracted.
    """
    shells = mapped(body.shape, TopAbs_ShapeEnum.TopAbs_SHELL)
    if mapped(body.shape, TopAbs_ShapeEnum.TopAbs_SOLID).Extent() != 1 or shells.Extent() < 3:
        return None
    alone = [_outwards(TopoDS.Shell(shells.FindKey(index))) for index in range(1, shells.Extent() + 1)]
    corners = (TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_VERTEX).Current() for solid in alone)
    points = [BRep_Tool.Pnt_s(TopoDS.Vertex(corner)) for corner in corners]
    depths = [0] * len(alone)
    for number, solid in enumerate(alone):
        box, classifier = Bnd_Box(), BRepClass3d_SolidClassifier(solid)
        BRepBndLib.Add_s(solid, box, False)
        for other, point in enumerate(points):
            if other != number and not box.IsOut(point):
                classifier.Perform(point, _MIN_TOLERANCE)
                depths[other] += classifier.State() == TopAbs_State.TopAbs_IN
    if max(depths) < 2:
        return None
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for one, depth in zip(alone, depths, strict=True):
        shell = TopExp_Explorer(one, TopAbs_ShapeEnum.TopAbs_SHELL).Current()
        builder.Add(solid, shell.Reversed() if depth % 2 else shell)
    return Healed(solid, body.origin)


def _outwards(shell: Any) -> Any:
    """A solid of one shell."""
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


_GAP = 1e-3
"""Gap [mm] that is sewn even if the file claims a higher precision."""
_MOST_CHANGED = 1e-3
"""Maximum relative change of volume by sewing."""


def sewn(body: Healed, precision: float) -> Healed | None:
    """The body as one closed solid, its faces outwards; None if gaps remain, or are too wide to be sure.

    Args:
        body: A solid with edges that belong to only one face [mm].
        precision: Its uncertainty [mm].
    """
    gap = max(precision, _GAP)
    sewing = BRepBuilderAPI_Sewing(gap)
    faces = faces_of(body.shape)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shells = TopExp_Explorer(sewing.SewedShape(), TopAbs_ShapeEnum.TopAbs_SHELL)
    if sewing.NbFreeEdges() or not shells.More():
        return None
    shell = TopoDS.Shell(shells.Current())
    shells.Next()
    if shells.More():  # nesting of several solids cannot be decided by sewing
        return None
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    volume = integrate(solid).Mass()
    if surface_area(solid) * MILLIMETRES_PER_METRE**2 * gap > _MOST_CHANGED * abs(volume):
        return None
    became = [sewing.Modified(face) if sewing.IsModified(face) else face for face in faces]
    origins = [
        next((origin for old, origin in zip(became, body.origin, strict=True) if old.IsSame(face)), -1)
        for face in faces_of(solid)
    ]
    return Healed(solid if volume > 0.0 else solid.Reversed(), origins)


_SAMPLES = 64
_LEAST = 0.03
"""Share of the surface from which it is reported: a single sample may be an artefact of the mesh."""
_STEEP = 0.02
"""Cosine below which a triangle is too close to edge-on to determine its sides."""
_AXES = Pose.from_xyz_rpy(rpy=(0.61, -0.37, 0.83)).R
"""A frame in which no typical CAD face is edge-on."""


def share_within(mesh: Stitched) -> float:
    """Share of a closed mesh's surface with the inside on both sides or on neither; 0 if it is small.

    A ray is cast upwards from the middle of a triangle. The number of exits from the solid minus that of entries is 0
    if it starts on an upper side and 1 if it starts on a lower one (Jordan).
    """
    points = mesh.vertices @ _AXES
    a, b, c = (points[mesh.faces[:, corner]] for corner in range(3))
    normals = cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    samples = _spread(lengths)
    samples = samples[np.abs(normals[samples, 2]) > _STEEP * lengths[samples]]
    if not len(samples):
        return 0.0
    starts = (a[samples] + b[samples] + c[samples]) / 3.0
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    x, y = starts[:, :1], starts[:, 1:2]
    near = (low[:, 0] <= x) & (high[:, 0] >= x) & (low[:, 1] <= y) & (high[:, 1] >= y)
    sample, triangle = np.nonzero(near)
    others = triangle != samples[sample]
    sample, triangle = sample[others], triangle[others]
    corners = np.stack([a[triangle], b[triangle], c[triangle]], axis=1)
    crossed = _crossings(starts[sample], corners, normals[triangle, 2])
    leaves = np.bincount(sample, crossed, len(samples))
    share = float((leaves != (normals[samples, 2] < 0.0)).mean())
    return share if share >= _LEAST else 0.0


def _spread(areas: Array) -> Indices:
    """Triangles at equal steps of the surface, each once."""
    total = np.cumsum(areas)
    if not total.size or not total[-1] > 0.0:
        return np.empty(0, dtype=np.int64)
    steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * total[-1]
    return distinct(np.searchsorted(total, steps))


def _crossings(starts: Array, corners: Array, rises: Array) -> Array:
    """Whether upward rays from points (k, 3) hit their triangles (k, 3, 3): 1 exits, -1 enters, 0 misses."""
    # Twice the signed areas that the point spans with the sides: the weights of the opposite corners.
    a = corners[:, :, :2] - starts[:, None, :2]
    b = np.roll(a, -1, axis=1)
    sides = (a[:, :, 0] * b[:, :, 1] - a[:, :, 1] * b[:, :, 0]) * np.sign(rises)[:, None]
    total = sides.sum(axis=1)
    hit = (sides >= 0.0).all(axis=1) & (total > 0.0)
    heights = (np.roll(corners[:, :, 2], 1, axis=1) * sides).sum(axis=1)
    return np.where(hit & (heights > starts[:, 2] * total), np.sign(rises), 0.0)
