"""Origins of drafted joints: a mate or an axis of components where possible, since these survive CAD changes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepbot.assemble.axis_evidence import doubt, face_words, faces_of_radius
from stepbot.geometry.spatial import Array, perpendicular_frame, rpy_from_rotation, vector3
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import AxisFaces, AxisLine, axis_faces, is_parallel, lines, mates, selectors

from .axis import Axis
from .draft import OriginForm, OriginSnippet
from .evidence import Hinge

_NANOMETRE = 9
_MICRORADIAN = 12


@dataclass(frozen=True)
class Found:
    """The origin of a joint."""

    snippet: OriginSnippet
    axis: Axis
    selected_by: str = ""
    """The faces whose radius selects the line among others, in words; empty if no radius does."""
    doubt: str = ""
    """Why the faces on the line are weak evidence; empty if they are strong, or if there are none."""


class Origins:
    """Writes origins; faces are collected once per component."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._faces: dict[int, AxisFaces] = {}

    def of(self, hinge: Hinge, child: int) -> Found:
        """The origin of a joint, the resulting axis, and its faces; ``child`` is the part on the child's side.

        The axis of the bearing between both parts if there is one, else the mate of both if it is on the axis, else the
        axis of one of them, else numbers.
        """
        kind, axis = hinge.type, hinge.axis
        if kind == JointKind.FIXED:
            return Found(OriginSnippet(OriginForm.XYZ), axis)
        if kind == JointKind.UNIVERSAL and hinge.axis2 is not None:
            x, y = axis.d, hinge.axis2.d
            return Found(_numbers(axis.point, np.column_stack([x, y, np.cross(x, y)])), axis)
        if axis.direction is None:
            return Found(_numbers(axis.point, np.eye(3)), axis)
        parent = hinge.b if child == hinge.a else hinge.a
        bearing = ((hinge.through,),) if hinge.through >= 0 else ()
        for parts in (*bearing, (parent, child), (child,), (parent,)):
            found = self._chosen(parts, axis, slides=kind == JointKind.PRISMATIC)
            if found is not None:
                return found
        return Found(_numbers(axis.point, perpendicular_frame(axis.d)), axis)

    def _chosen(self, parts: Sequence[int], axis: Axis, *, slides: bool) -> Found | None:
        """The line of one component, or the mate of two, on the axis, with its selector among all lines."""
        faces = [self._of(part) for part in parts]
        found = mates(faces[0], faces[1]) if len(faces) == 2 else lines(faces[0])
        form = OriginForm.MATE if len(faces) == 2 else OriginForm.AXIS_OF
        for line, selector in zip(found, selectors(found) if found else (), strict=True):
            own = Axis(np.array(line.point), np.array(line.direction))
            if own.same(axis):
                snippet = OriginSnippet(form, tuple(map(self._path, parts)), selector.radius, selector.near)
                others = [one for one in self._matching(faces, selector.radius) if one.point != line.point]
                if slides:
                    others = [one for one in others if not is_parallel(one, line)]
                return Found(snippet, own, self._selected_by(line, selector.radius), doubt(line, others))
        return None

    def _matching(self, faces: Sequence[AxisFaces], radius: float | None) -> tuple[AxisLine, ...]:
        """The lines that an origin with this radius is chosen among."""
        return mates(faces[0], faces[1], radius) if len(faces) == 2 else lines(faces[0], radius)

    def _selected_by(self, line: AxisLine, radius: float | None) -> str:
        """The faces of the radius that selects a line, in words; empty without a radius."""
        faces = faces_of_radius(line, radius)
        return " and ".join(dict.fromkeys(f"{face_words(face)} of '{self._path(face.component)}'" for face in faces))

    def _path(self, part: int) -> str:
        return self._assembly.components[part].path

    def _of(self, part: int) -> AxisFaces:
        if part not in self._faces:
            self._faces[part] = axis_faces(self._assembly, [part])
        return self._faces[part]


def _numbers(point: Array, R: Array) -> OriginSnippet:
    xyz = vector3(np.round(point, _NANOMETRE) + 0.0)
    rpy = vector3(np.round(rpy_from_rotation(R), _MICRORADIAN) + 0.0)
    return OriginSnippet(OriginForm.XYZ, xyz=xyz, rpy=rpy)
