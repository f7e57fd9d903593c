"""Meshes bodies with the kernel's mesher, to a tolerance relative to each.

If the mesher leaves holes it is run again: after straightening curves of faces (:func:`straighten`), then with its
other algorithm and finer, up to a limit of processor time and of faces; the best mesh is kept. A finer mesh of the
whole body is made only if the faces that are missing can be meshed that fine by themselves, which takes milliseconds.
"""

import math
import time
from collections.abc import Iterator
from typing import Any

from msgspec import Struct, field
from msgspec.structs import replace
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d
from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from stepbot.geometry.predicates import is_watertight

from ..assembly import MeshTolerance
from ..kernel import MILLIMETRES_PER_METRE, explored, faces_of
from .splitting import split
from .stitching import Stitched, stitched
from .triangles import edge_uses, faceted_faces

MAX_FACES = 200_000
"""Maximum number of faces of a body's written mesh."""

MAX_RETRIED = 80_000
"""Maximum number of faces that a finer mesh may be expected to have to be made only because the first is incomplete."""

_DELABELLA = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Delabella
"""Divide and conquer: as accurate as the kernel's default in 0.6 of its time, over the bodies of ten assemblies."""
WATSON = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Watson
"""The kernel's default."""
RETRY_SECONDS = 5.0
"""Processor time [s] after which no further way is tried; the last one may take longer."""
_COARSEST_ANGLE = math.pi / 2
_COARSEST_DEFLECTION = 0.1


class Fineness(Struct, frozen=True):
    """Tolerance of a body's mesh."""

    deflection: float
    """Chordal deviation [mm]."""
    angle: float
    """[rad]."""

    def scaled(self, factor: float) -> "Fineness":
        """Both tolerances times a factor."""
        return Fineness(self.deflection * factor, self.angle * factor)

    def scaled_by_square(self, factor: float) -> "Fineness":
        """The angle scaled by a factor, the deflection by its square; the error of a mesh then scales by the square."""
        return Fineness(self.deflection * factor**2, self.angle * factor)


class Tessellation(Struct, frozen=True, eq=False):
    """The mesh of a body."""

    mesh: Stitched
    """[mm]."""
    fineness: Fineness
    """The tolerance that was used in the end."""
    missing: list[int] = field(default_factory=list)
    """Indices of faces without triangles."""
    untried: str = ""
    """Why further ways to complete it were left untried, for messages; empty if all were tried."""

    @property
    def volume_tolerance(self) -> float:
        """Relative error of volume that a mesh of this tolerance may have.

        A facet of a cylinder that spans the angle a misses a^2/6 of it, of a sphere up to a^2/4; and a mesh is nowhere
        further from its surface than the chordal deviation.
        """
        by_angle = self.fineness.angle**2 / 2 + 0.02
        volume = abs(self.mesh.signed_volume)
        by_deflection = 1.5 * self.mesh.area * self.fineness.deflection / volume if volume > 0.0 else by_angle
        return max(0.01, min(by_angle, by_deflection))

    @property
    def is_complete(self) -> bool:
        """Whether the mesh has every face, and is closed unless the shape itself is open."""
        return not self.missing and (self.mesh.open_edges > 0 or is_watertight(self.mesh.faces))


def diagonal(shape: Any) -> float:
    """Diagonal [mm] of the bounding box of a shape."""
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    return 0.0 if box.IsVoid() else math.sqrt(box.SquareExtent())


def fineness(tolerances: tuple[MeshTolerance, ...], size: float) -> Fineness:
    """The finest of several tolerances for a body of diagonal ``size`` [mm]."""
    deflections = (t.absolute * MILLIMETRES_PER_METRE or t.relative * size for t in tolerances)
    return Fineness(min(deflections), min(t.angle for t in tolerances))


def tessellated(shape: Any, wanted: Fineness) -> Tessellation:
    """Mesh a shape, in several ways until no face is missing and the mesh is as closed as the shape."""
    faces = faces_of(shape)
    best = tessellated_once(shape, wanted)
    if best.is_complete:
        return best
    start, last, untried = time.process_time(), best, ""
    for algorithm, factor in _ways(faces):
        fine = wanted.scaled(factor)
        if time.process_time() - start > RETRY_SECONDS:
            return replace(best, untried=f"tries ended at {RETRY_SECONDS:g} s of processor time")
        # A finer mesh has more faces in proportion at least.
        if fine.angle * MAX_RETRIED < last.fineness.angle * len(last.mesh.faces) and factor < 1.0:
            return replace(best, untried=f"a finer mesh would have more than {MAX_RETRIED} faces")
        if factor < 1.0 and not all(_is_meshed_alone(faces[i], fine, algorithm) for i in best.missing):
            untried = "no finer mesh has all faces"
            continue
        last = tessellated_once(shape, fine, algorithm)
        if last.is_complete:
            return last
        if len(last.missing) < len(best.missing):
            best = last
    return replace(best, untried=untried)


def tessellated_once(shape: Any, wanted: Fineness, algorithm: IMeshTools_MeshAlgoType = _DELABELLA) -> Tessellation:
    """Mesh a shape by one method only, complete or not."""
    faces = faces_of(shape)
    BRepTools.Clean_s(shape)
    _mesh(shape, wanted, algorithm)
    tessellation, missing = faceted_faces(faces)
    return Tessellation(split(stitched(tessellation, edge_uses(faces))), wanted, missing)


def _ways(faces: list[Any]) -> Iterator[tuple[IMeshTools_MeshAlgoType, float]]:
    """Algorithms and tolerance factors to try on a body with an incomplete mesh; straightens it first."""
    if straighten(faces):
        yield from ((_DELABELLA, 1.0), (WATSON, 1.0), (_DELABELLA, 0.5), (WATSON, 0.25))
    else:
        yield from ((WATSON, 1.0), (_DELABELLA, 0.5), (WATSON, 0.25))


def fitted(shape: Any, wanted: Fineness, size: float) -> Tessellation:
    """Mesh a shape of diagonal ``size`` [mm], more coarsely if it would have more than :data:`MAX_FACES` faces."""
    result = tessellated(shape, wanted)
    while len(result.mesh.faces) > MAX_FACES:
        current = result.fineness
        if current.angle >= _COARSEST_ANGLE and current.deflection >= _COARSEST_DEFLECTION * size:
            break
        # The number of faces of a doubly curved surface grows with the square of the fineness, of a cylinder linearly.
        factor = max(1.25, math.sqrt(len(result.mesh.faces) / MAX_FACES))
        result = tessellated(shape, current.scaled(factor))
    return result


def _is_meshed_alone(face: Any, wanted: Fineness, algorithm: IMeshTools_MeshAlgoType) -> bool:
    """Whether a face has triangles if it is meshed without its body; the face itself keeps what it has."""
    alone = BRepBuilderAPI_Copy(face, True, False).Shape()
    _mesh(alone, wanted, algorithm)
    return not faceted_faces(faces_of(alone))[1]


def _mesh(shape: Any, wanted: Fineness, algorithm: IMeshTools_MeshAlgoType) -> None:
    parameters = IMeshTools_Parameters()
    parameters.MeshAlgo = algorithm
    parameters.Deflection, parameters.Angle = wanted.deflection, min(wanted.angle, _COARSEST_ANGLE)
    BRepMesh_IncrementalMesh(shape, parameters)


_SLANT = 1e-9
"""Component of a unit direction below which a line counts as parallel to an axis."""


def straighten(faces: list[Any]) -> int:
    """Make lines nearly parallel to an axis of parameter space exactly parallel, in place; returns their number."""
    forward = TopAbs_Orientation.TopAbs_FORWARD
    return sum(
        _straighten_edge(TopoDS.Edge(edge.Oriented(forward)), face)
        for face in (TopoDS.Face(face.Oriented(forward)) for face in faces)
        for edge in explored(face, TopAbs_ShapeEnum.TopAbs_EDGE)
    )


def _straighten_edge(edge: Any, face: Any) -> bool:
    """Whether an edge of a face had a line to straighten."""
    curves = [BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)]
    if BRep_Tool.IsClosed_s(edge, face):
        curves.append(BRep_Tool.CurveOnSurface_s(TopoDS.Edge(edge.Reversed()), face, 0.0, 0.0))
    straight = [_straight(curve) for curve in curves]
    if not any(straight):
        return False
    builder, (first, last) = BRep_Builder(), BRep_Tool.Range_s(edge, face)
    replaced = [new or old for new, old in zip(straight, curves, strict=True)]
    builder.UpdateEdge(edge, *replaced, face, BRep_Tool.Tolerance_s(edge))
    builder.Range(edge, face, first, last)
    return True


def _straight(curve: Any) -> Geom2d_Line | None:
    """The exact line for a slightly slanted one; None if there is nothing to change."""
    if not isinstance(curve, Geom2d_Line):
        return None
    line = curve.Lin2d()
    x, y = line.Direction().X(), line.Direction().Y()
    if 0.0 < abs(x) < _SLANT:
        return Geom2d_Line(line.Location(), gp_Dir2d(0.0, 1.0 if y > 0.0 else -1.0))
    if 0.0 < abs(y) < _SLANT:
        return Geom2d_Line(line.Location(), gp_Dir2d(1.0 if x > 0.0 else -1.0, 0.0))
    return None
