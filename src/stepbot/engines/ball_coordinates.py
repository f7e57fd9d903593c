"""Rotation of a ball joint by its coordinates yaw, pitch and roll, for engines that use its angular velocity.

Everything is expressed in the child's frame C. P is the frame after yaw and Q that after pitch, so that ``R_CQ =
Rx(roll)^T`` and ``R_CP = Rx(roll)^T Ry(pitch)^T``.
"""

from collections.abc import Sequence

import numpy as np

from stepbot.geometry.spatial import Array, rotation_from_rpy

_X = np.array([1.0, 0.0, 0.0])


def ball_rates(angles: Sequence[float]) -> Array:
    """Angular velocity [rad/s] per unit speed of yaw, pitch and roll, shape (3, 3), at these three angles [rad]."""
    _, pitch, roll = angles
    yawing = rotation_from_rpy((roll, pitch, 0.0)).T[:, 2]
    pitching = rotation_from_rpy((roll, 0.0, 0.0)).T[:, 1]
    return np.column_stack([yawing, pitching, _X])


def ball_bias(angles: Sequence[float], speeds: Sequence[float]) -> Array:
    """Angular acceleration (3,) [rad/s^2] at constant speeds [rad/s] of yaw, pitch and roll."""
    yawing, pitching, _ = ball_rates(angles).T
    yaw, pitch, roll = speeds
    turned = pitch * pitching + roll * _X
    return np.asarray(-yaw * np.cross(turned, yawing) - pitch * np.cross(roll * _X, pitching))
