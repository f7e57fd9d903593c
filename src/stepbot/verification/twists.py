"""Twists: instantaneous motions of a body, and the screw motions that they generate.

A twist is (w, v): angular velocity [rad/s], then velocity [m/s] of the point at the origin. The twist of a joint is the
logarithm of its motion by one unit of its coordinate; poses are then products of exponentials (Brockett 1984; Lynch and
Park, Modern Robotics, ch. 4).
"""

import numpy as np

from stepbot.geometry.spatial import Array, Pose, cross_matrix, rotation_angle, vector3

_SMALL = 1e-12
"""Angle [rad] below which a motion is a pure translation."""


def twist_of(motion: Pose) -> Array:
    """The twist (6,) that generates a motion in one second; rotations are below half a turn."""
    R = motion.R
    angle = rotation_angle(R)
    if angle < _SMALL:
        return np.concatenate([np.zeros(3), motion.p])
    twice_sine = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    w = twice_sine * angle / float(np.linalg.norm(twice_sine))
    K = cross_matrix(w)
    V = np.eye(3) + K * ((1.0 - np.cos(angle)) / angle**2) + K @ K * ((angle - np.sin(angle)) / angle**3)
    return np.concatenate([w, np.linalg.solve(V, motion.p)])


def pitch_of(twist: Array) -> float:
    """Advance [m/rad] of a rotating twist."""
    w, v = twist[:3], twist[3:]
    return float(w @ v) / float(w @ w)


def foot(twist: Array) -> Array:
    """The point (3,) [m] on a rotating twist's axis that is nearest to the origin."""
    w, v = twist[:3], twist[3:]
    return np.asarray(np.cross(w, v)) / float(w @ w)


def common_point(twists: Array) -> tuple[Array, float]:
    """The point (3,) [m] nearest to the axes of twists (n, 6), and their largest velocity [m/s] at it."""
    A = np.vstack([-cross_matrix(twist[:3]) for twist in twists])
    b = np.concatenate([twist[3:] for twist in twists])
    p: Array = np.linalg.lstsq(A, b, rcond=None)[0]
    return p, float(np.abs(A @ p - b).max())


def direction(twist: Array) -> tuple[float, float, float]:
    """Unit direction of a twist's axis; of its translation if it does not rotate."""
    w = twist[:3] if np.linalg.norm(twist[:3]) > _SMALL else twist[3:]
    return vector3(w / np.linalg.norm(w))
