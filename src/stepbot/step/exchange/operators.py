"""Transformation operators of a STEP file, rewritten so that the kernel reads them as ISO 10303-42 defines them.

``cartesian_transformation_operator_3d`` may mirror (its axes may be left-handed) and scale. The kernel assumes
right-handed axes, which turns a mirror image into a rotation, and divides by the scale. Operators that it would misread
are rewritten in the model before shapes are built. A negative scale violates the standard; the kernel's own writer uses
it for mirror images, and reads them back, so those are left alone.
"""

from typing import Any

import numpy as np
from OCP.collections import HArray1_double
from OCP.gp import gp_Trsf
from OCP.StepData import StepData_Factors
from OCP.StepGeom import StepGeom_CartesianPoint, StepGeom_CartesianTransformationOperator3d, StepGeom_Direction
from OCP.StepToGeom import StepToGeom
from OCP.TCollection import TCollection_HAsciiString

from stepbot.geometry.spatial import Array, dot, length, unit

from ..kernel import StepUnreadable, is_same_motion
from .selection import entities

_SAME = 1e-9
"""Sine up to which directions are parallel."""


def correct_operators(session: Any) -> None:
    """Rewrite the operators that the kernel would misread.

    Raises:
        StepUnreadable: An operator is not a valid transformation.
    """
    for operator in entities(session, StepGeom_CartesianTransformationOperator3d):
        scale = operator.Scale() if operator.HasScale() else 1.0
        if scale <= 0.0:
            continue
        try:
            R, origin = _axes(operator), _coordinates(operator.LocalOrigin())
        except ValueError:
            raise StepUnreadable("a transformation operator has an axis without a direction, or no origin") from None
        meant = np.column_stack([scale * R, origin])
        if not is_same_motion(_as_read(operator), meant):
            _rewrite(operator, R, origin, scale)
            if not is_same_motion(_as_read(operator), meant):
                raise StepUnreadable("the kernel does not support a transformation operator")


def _axes(operator: Any) -> Array:
    """The operator's axes as columns: base_axis of ISO 10303-42, which follows the second axis even if left-handed."""
    z = unit(_ratios(operator.Axis3())) if operator.HasAxis3() else np.array([0.0, 0.0, 1.0])
    x = _ratios(operator.Axis1()) if operator.HasAxis1() else np.array([1.0, 0.0, 0.0])
    if not operator.HasAxis1() and abs(z[0]) > 1.0 - _SAME:
        x = np.array([0.0, 1.0, 0.0])
    x = unit(x - dot(x, z) * z)
    y = _ratios(operator.Axis2()) if operator.HasAxis2() else np.array([0.0, 1.0, 0.0])
    y = y - dot(y, z) * z - dot(y, x) * x
    return np.column_stack([x, np.cross(z, x) if length(y) < _SAME else unit(y), z])


def _rewrite(operator: Any, R: Array, origin: Array, scale: float) -> None:
    """Change the operator so that the kernel reads it as x -> scale R x + origin.

    From rotation Q, point c and factor f it computes x -> (Q x + c) / f, with Q always right-handed.
    """
    factor = 1.0 / scale if np.linalg.det(R) > 0.0 else -1.0 / scale
    Q, c = factor * scale * R, factor * origin
    x, y, z = (_direction(Q[:, k]) for k in range(3))
    point = StepGeom_CartesianPoint()
    point.Init3D(TCollection_HAsciiString(""), *c.tolist())
    operator.Init(operator.Name(), True, x, True, y, point, True, factor, True, z)


def _as_read(operator: Any) -> Array:
    """The kernel's interpretation of an operator, shape (3, 4), in the unit of the file."""
    transformation = gp_Trsf()
    StepToGeom.MakeTransformation3d_s(operator, transformation, StepData_Factors())
    return np.array([[transformation.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)])


def _ratios(direction: Any) -> Array:
    if direction is None:
        raise ValueError("something that is not a direction")
    return np.array([direction.DirectionRatiosValue(index) for index in (1, 2, 3)])


def _coordinates(point: Any) -> Array:
    if point is None:
        raise ValueError("something that is not a point")
    return np.array([point.CoordinatesValue(index) for index in (1, 2, 3)])


def _direction(ratios: Array) -> Any:
    values = HArray1_double(1, 3)
    for index, value in enumerate(ratios.tolist(), start=1):
        values.SetValue(index, value)
    direction = StepGeom_Direction()
    direction.Init(TCollection_HAsciiString(""), values)
    return direction
