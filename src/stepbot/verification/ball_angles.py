"""Three angles about axes through one point, as coordinates of a ball joint.

Everything is expressed in the frame of the parent. The axes are given for all angles at 0; the second moves with the
first, and the third with both. They reach every rotation if the second is perpendicular to the other two (Davenport),
whichever these are: Cardan angles about three axes, Euler angles about two.
"""

from collections.abc import Sequence
from math import atan2, pi

import numpy as np

from stepbot.geometry.spatial import Array, rotation_about


class BallAngles:
    """Rotations, their rates, and the conversion from a rotation to the angles."""

    def __init__(self, axes: Array) -> None:
        """Store the axes, unit vectors, shape (3, 3), one per row."""
        self.axes = axes

    @property
    def slant(self) -> tuple[float, float]:
        """Deviation [rad] from perpendicularity of the second axis to the first, and of the third to the second."""
        first, second, third = self.axes
        return abs(float(np.arcsin(first @ second))), abs(float(np.arcsin(second @ third)))

    def rotation(self, angles: Sequence[float]) -> Array:
        """The rotation (3, 3) at three angles [rad]."""
        R = np.eye(3)
        for axis, angle in zip(self.axes, angles, strict=True):
            R = R @ rotation_about(axis, angle)
        return R

    def rates(self, angles: Sequence[float]) -> Array:
        """Angular velocity [rad/s] per unit speed of each angle, shape (3, 3), one column per angle."""
        R, columns = np.eye(3), []
        for axis, angle in zip(self.axes, angles, strict=True):
            columns.append(R @ axis)
            R = R @ rotation_about(axis, angle)
        return np.column_stack(columns)

    def bias(self, angles: Sequence[float], speeds: Sequence[float]) -> Array:
        """Angular acceleration (3,) [rad/s^2] at constant speeds [rad/s] of the angles."""
        w, bias = np.zeros(3), np.zeros(3)
        for axis, speed in zip(self.rates(angles).T, speeds, strict=True):
            bias = bias + np.cross(w, axis) * speed  # an axis moves with the angles before it
            w = w + axis * speed
        return bias

    def clearance(self, angles: Sequence[float]) -> float:
        """Distance of the axes from gimbal lock, which is at 0; at most 1."""
        return abs(float(np.linalg.det(self.rates(angles))))

    def angles(self, R: Array) -> tuple[float, float, float]:
        """One of the two sets of angles [rad] of a rotation (3, 3)."""
        first, second, third = self.axes
        normal = np.cross(first, second)
        # The second angle carries the first axis into the third at `offset`, where the two sets of axes meet.
        offset = atan2(-float(third @ normal), float(third @ first))
        turned = R @ third
        across = float(np.hypot(turned @ second, turned @ normal))
        a = atan2(float(turned @ second), -float(turned @ normal)) if across > 0.0 else 0.0
        b = atan2(across, float(turned @ first)) - offset
        rest = (rotation_about(first, a) @ rotation_about(second, b)).T @ R
        c = atan2(float(np.cross(second, rest @ second) @ third), float(second @ rest @ second))
        return a, (b + pi) % (2.0 * pi) - pi, c
