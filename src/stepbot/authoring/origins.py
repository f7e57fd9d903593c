"""Origins of drafted joints: a mate or an axis of components where possible, since these survive CAD changes."""

from collections.abc import Sequence

import numpy as np

from stepbot.geometry.spatial import Array, perpendicular_frame, rpy_from_rotation, vector3
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import AxisFaces, axis_faces, lines, mates, selectors

from .axis import Axis
from .draft import OriginForm, OriginSnippet
from .evidence import Hinge

_NANOMETRE = 9
_MICRORADIAN = 12


class Origins:
    """Writes origins; faces are collected once per component."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._faces: dict[int, AxisFaces] = {}

    def of(self, hinge: Hinge, child: int) -> tuple[OriginSnippet, Axis]:
        """The origin of a joint, and the resulting axis; ``child`` is the part on the child's side.

        The axis of the bearing between both parts if there is one, else the mate of both if it is on the axis, else the
        axis of one of them, else numbers.
        """
        kind, axis = hinge.type, hinge.axis
        if kind == JointKind.FIXED:
            return OriginSnippet(OriginForm.XYZ), axis
        if kind == JointKind.UNIVERSAL and hinge.axis2 is not None:
            x, y = axis.d, hinge.axis2.d
            return _numbers(axis.point, np.column_stack([x, y, np.cross(x, y)])), axis
        if axis.direction is None:
            return _numbers(axis.point, np.eye(3)), axis
        parent = hinge.b if child == hinge.a else hinge.a
        bearing = ((hinge.through,),) if hinge.through >= 0 else ()
        for parts in (*bearing, (parent, child), (child,), (parent,)):
            found = self._chosen(parts, axis)
            if found is not None:
                return found
        return _numbers(axis.point, perpendicular_frame(axis.d)), axis

    def _chosen(self, parts: Sequence[int], axis: Axis) -> tuple[OriginSnippet, Axis] | None:
        """The line of one component, or the mate of two, on the axis, with its selector among all lines."""
        faces = [self._of(part) for part in parts]
        found = mates(faces[0], faces[1]) if len(faces) == 2 else lines(faces[0])
        form = OriginForm.MATE if len(faces) == 2 else OriginForm.AXIS_OF
        for line, selector in zip(found, selectors(found) if found else (), strict=True):
            own = Axis(np.array(line.point), np.array(line.direction))
            if own.same(axis):
                paths = tuple(self._assembly.components[part].path for part in parts)
                return OriginSnippet(form, paths, selector.radius, selector.near), own
        return None

    def _of(self, part: int) -> AxisFaces:
        if part not in self._faces:
            self._faces[part] = axis_faces(self._assembly, [part])
        return self._faces[part]


def _numbers(point: Array, R: Array) -> OriginSnippet:
    xyz = vector3(np.round(point, _NANOMETRE) + 0.0)
    rpy = vector3(np.round(rpy_from_rotation(R), _MICRORADIAN) + 0.0)
    return OriginSnippet(OriginForm.XYZ, xyz=xyz, rpy=rpy)
