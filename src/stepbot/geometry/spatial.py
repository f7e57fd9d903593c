"""Poses and inertia tensors: the only module that implements rotation conventions.

Notation as in Drake's multibody documentation: ``X_AB`` is the pose of frame B in frame A, ``R_AB`` its rotation and
``p_AB`` its position; a product must match letter by letter, ``X_WC = X_WA @ X_AB @ X_BC``. Roll, pitch and yaw turn
about the fixed axes X, Y, Z, in this order, as URDF and SDFormat define them. Quaternions are (w, x, y, z).
"""

import math
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

Vector3 = tuple[float, float, float]
Matrix3 = tuple[Vector3, Vector3, Vector3]

RESIDUE = 1e-12
"""Angle [rad], coordinate [m] or rotation entry below which a number is numeric residue."""

DECIMALS = 12
"""Decimals of a coordinate [m] or position of a joint [rad], [m] that are the same on every processor."""

ZERO3: Vector3 = (0.0, 0.0, 0.0)
IDENTITY3: Matrix3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO33: Matrix3 = (ZERO3, ZERO3, ZERO3)


def vector3(values: ArrayLike) -> Vector3:
    """Three plain floats from anything array-like of shape (3,)."""
    x, y, z = np.asarray(values, dtype=np.float64).tolist()
    return (x, y, z)


def matrix3(values: ArrayLike) -> Matrix3:
    """Three rows of plain floats from anything array-like of shape (3, 3)."""
    a, b, c = np.asarray(values, dtype=np.float64).tolist()
    return (tuple(a), tuple(b), tuple(c))


class Pose(Struct, frozen=True, dict=True):
    """A rigid transform, X_AB: turns coordinates in B into coordinates in A.

    The rotation is kept as a matrix, so that composing and inverting never pass through angles.
    """

    rotation: Matrix3 = IDENTITY3
    """R_AB, rows."""
    position: Vector3 = ZERO3
    """p_AB [m]."""

    @staticmethod
    def of(rotation: ArrayLike = IDENTITY3, position: ArrayLike = ZERO3) -> "Pose":
        """Pose from anything array-like: rotation (3, 3), position (3,) [m]."""
        return Pose(matrix3(rotation), vector3(position))

    @staticmethod
    def from_matrix(matrix: ArrayLike) -> "Pose":
        """Pose from a homogeneous (4, 4) or (3, 4) matrix."""
        (a, b, c, x), (d, e, f, y), (g, h, i, z) = np.asarray(matrix, dtype=np.float64)[:3].tolist()
        return Pose(((a, b, c), (d, e, f), (g, h, i)), (x, y, z))

    @staticmethod
    def from_xyz_rpy(xyz: ArrayLike = ZERO3, rpy: ArrayLike = ZERO3) -> "Pose":
        """Pose from a position [m] and fixed-axis roll, pitch, yaw [rad], as in URDF's ``<origin>``."""
        return Pose.of(rotation_from_rpy(rpy), xyz)

    @staticmethod
    def from_quaternion(wxyz: Sequence[float], position: ArrayLike = ZERO3) -> "Pose":
        """Pose from a quaternion (w, x, y, z), normalised here, and a position [m]."""
        return Pose.of(rotation_from_quaternion(wxyz), position)

    @cached_property
    def R(self) -> Array:
        """Rotation as a read-only array, shape (3, 3)."""
        return _read_only(np.array(self.rotation, dtype=np.float64))

    @cached_property
    def p(self) -> Array:
        """Position as a read-only array, shape (3,) [m]."""
        return _read_only(np.array(self.position, dtype=np.float64))

    @property
    def matrix(self) -> Array:
        """Homogeneous matrix, shape (4, 4)."""
        X = np.eye(4)
        X[:3, :3] = self.R
        X[:3, 3] = self.p
        return X

    @property
    def rpy(self) -> Vector3:
        """Fixed-axis roll, pitch, yaw [rad], without numeric residue."""
        roll, pitch, yaw = map(_without_residue, rpy_from_rotation(self.R))
        return (roll, pitch, yaw)

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Unit quaternion (w, x, y, z) with w >= 0, without numeric residue."""
        w, x, y, z = map(_without_residue, quaternion_from_rotation(self.R))
        return (w, x, y, z)

    @property
    def is_identity(self) -> bool:
        """Whether this is exactly the identity."""
        return self.rotation == IDENTITY3 and self.position == ZERO3

    def __matmul__(self, other: "Pose") -> "Pose":
        x, y, z = (_turned(self.rotation, column) for column in zip(*other.rotation, strict=True))
        a, b, c = _turned(self.rotation, other.position)
        p = self.position
        return Pose(((x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])), (a + p[0], b + p[1], c + p[2]))

    def inverse(self) -> "Pose":
        """X_BA from X_AB."""
        (a, b, c), (d, e, f), (g, h, i) = self.rotation
        back = ((a, d, g), (b, e, h), (c, f, i))
        x, y, z = _turned(back, self.position)
        return Pose(back, (-x, -y, -z))

    def apply(self, points: ArrayLike) -> Array:
        """Points (n, 3) or (3,) in B, expressed in A."""
        return self.turn(points) + self.p

    def turn(self, vectors: ArrayLike) -> Array:
        """Directions (n, 3) or (3,) in B, expressed in A."""
        given = np.asarray(vectors, dtype=np.float64)
        if given.ndim == 1:
            return np.array(_turned(self.rotation, given.tolist()))
        return rotated(self.R, given)

    def distance_to(self, other: "Pose") -> tuple[float, float]:
        """Distance between two poses: position [m] and angle [rad]."""
        return length(self.p - other.p), rotation_angle(matrix_product(self.R.T, other.R))


IDENTITY = Pose()


def _turned(R: Matrix3, vector: Sequence[float]) -> Vector3:
    """What :func:`rotated` returns for one vector, to the last bit, in a tenth of the time."""
    (a, b, c), (d, e, f), (g, h, i) = R
    x, y, z = vector
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def tidy(pose: Pose) -> Pose:
    """The pose rounded to 1e-12 m, so that it is the same on all machines.

    Rotation entries within 1e-12 of 0 or 1 are replaced by these values, a change of a picometre at a metre; the other
    entries are kept, so that the matrix stays a rotation to within 1e-12.
    """
    return Pose.of(*tidy_arrays(np.array(pose.rotation), np.array(pose.position)))


def tidy_arrays(R: Array, p: Array) -> tuple[Array, Array]:
    """Rotations (..., 3, 3) and positions (..., 3) [m] of :func:`tidy` poses."""
    nearest = np.rint(R)
    return np.where(np.abs(R - nearest) < RESIDUE, nearest, R) + 0.0, np.round(p, DECIMALS) + 0.0


def rotation_from_rpy(rpy: ArrayLike) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll), shape (3, 3)."""
    roll, pitch, yaw = np.asarray(rpy, dtype=np.float64).tolist()
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_rotation(R: Array) -> Vector3:
    """Roll, pitch, yaw [rad] of a rotation matrix, accurate through the gimbal pole.

    Pitch comes from ``atan2``, not ``asin``, which loses half the digits near +-90 degrees. Close to the pole, yaw is
    taken from the first column and roll is solved from the remainder, so that the result always reproduces the
    rotation.
    """
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    yaw = math.atan2(R[1, 0], R[0, 0]) if math.hypot(R[0, 0], R[1, 0]) > 1e-12 else 0.0
    cy, sy = math.cos(yaw), math.sin(yaw)
    # Undo the yaw: the second and third column of Rz(-yaw) R hold cos(roll) and sin(roll) in their y component.
    roll = math.atan2(sy * R[0, 2] - cy * R[1, 2], cy * R[1, 1] - sy * R[0, 1])
    return (roll, pitch, yaw)


def _without_residue(value: float) -> float:
    """0 for an angle [rad] or a component of a quaternion that moves a point at 1 m by less than a picometre."""
    return 0.0 if abs(value) < RESIDUE else value


def rotation_from_quaternion(wxyz: Sequence[float]) -> Array:
    """Rotation matrix (3, 3) of a quaternion (w, x, y, z); it need not be normalised."""
    w, x, y, z = np.asarray(wxyz, dtype=np.float64) / length(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_from_rotation(R: Array) -> tuple[float, float, float, float]:
    """Unit quaternion (w, x, y, z) with w >= 0 of a rotation matrix (Shepperd 1978: largest component first)."""
    diagonal = (float(R[0, 0] + R[1, 1] + R[2, 2]), float(R[0, 0]), float(R[1, 1]), float(R[2, 2]))
    largest = max(range(4), key=lambda i: diagonal[i])
    if largest == 0:
        q = np.array([1 + diagonal[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = np.empty(4)
        q[0] = R[k, j] - R[j, k]
        q[1 + i] = 1 + R[i, i] - R[j, j] - R[k, k]
        q[1 + j] = R[j, i] + R[i, j]
        q[1 + k] = R[k, i] + R[i, k]
    q /= length(q)
    w, x, y, z = (q if q[0] >= 0 else -q).tolist()
    return (w, x, y, z)


def rotation_about(axis: ArrayLike, angle: float) -> Array:
    """Rotation (3, 3) by ``angle`` [rad] about a unit ``axis`` (Rodrigues)."""
    a = np.asarray(axis, dtype=np.float64)
    K = cross_matrix(a)
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * matrix_product(K, K)


def rotation_angle(R: Array) -> float:
    """Angle [rad] in [0, pi] of a rotation matrix, accurate near zero and near pi."""
    axis_part = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return math.atan2(length(axis_part), float(np.trace(R)) - 1.0)


def cross(a: Array, b: Array) -> Array:
    """Cross products of vectors (..., 3); for a few vectors ten times as fast as numpy's own."""
    return a.take(_YZX, -1) * b.take(_ZXY, -1) - a.take(_ZXY, -1) * b.take(_YZX, -1)


_YZX, _ZXY = np.array([1, 2, 0]), np.array([2, 0, 1])


def dot(a: Array, b: Array) -> Array:
    """Dot products (...) of vectors (..., 3); x, y and z are added in this order, the same on all processors."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])


def matrix_product(A: Array, B: Array) -> Array:
    """Products (..., n, m) of matrices (..., n, k) and (..., k, m), the same on all processors.

    Those of BLAS differ in their last digit, because it has other instructions for each kind of processor
    (``docs/decisions/0035-the-same-bytes-on-every-processor.md``).
    """
    total = A[..., :, 0, None] * B[..., None, 0, :]
    for i in range(1, A.shape[-1]):
        total = total + A[..., :, i, None] * B[..., None, i, :]
    return np.asarray(total)


def rotated(R: Array, vectors: Array) -> Array:
    """Products (..., 3) of matrices (..., 3, 3) with vectors (..., 3), the same on all processors."""
    x, y, z = vectors[..., 0, None], vectors[..., 1, None], vectors[..., 2, None]
    return np.asarray(R[..., 0] * x + R[..., 1] * y + R[..., 2] * z)


def length(vector: ArrayLike) -> float:
    """Length of a vector (n,), the same on all processors."""
    return math.hypot(*np.asarray(vector, dtype=np.float64).tolist())


def lengths(vectors: Array) -> Array:
    """Lengths (...) of vectors (..., 3), the same on all processors."""
    return np.sqrt(dot(vectors, vectors))


def cross_matrix(v: ArrayLike) -> Array:
    """[v]x, shape (3, 3), so that ``cross_matrix(v) @ u == cross(v, u)``."""
    x, y, z = np.asarray(v, dtype=np.float64).tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def unit(v: ArrayLike) -> Array:
    """Vector (3,) scaled to length 1.

    Raises:
        ValueError: The vector is zero or not finite.
    """
    a = np.asarray(v, dtype=np.float64)
    size = length(a)
    if not math.isfinite(size) or size == 0.0:
        raise ValueError(f"no direction in {a.tolist()}")
    return a / size


def angle_between(a: ArrayLike, b: ArrayLike) -> float:
    """Angle [rad] between two directions (3,), in [0, pi]; NaN if one of them is zero."""
    try:
        u, v = unit(a), unit(b)
    except ValueError:
        return math.nan
    return math.atan2(length(cross(u, v)), float(dot(u, v)))


def shift_inertia(I_com: ArrayLike, mass: float, p: ArrayLike) -> Array:
    """Inertia (3, 3) about a point at ``p`` [m] from the centre of mass (Steiner); ``-mass`` for the inverse."""
    d = np.asarray(p, dtype=np.float64)
    return np.asarray(I_com, dtype=np.float64) + mass * (float(dot(d, d)) * np.eye(3) - np.outer(d, d))


def turn_inertia(R_AB: ArrayLike, I_B: ArrayLike) -> Array:
    """Inertias (..., 3, 3) given along the axes of B, expressed along the axes of A; exactly symmetric."""
    R = np.asarray(R_AB, dtype=np.float64)
    turned = matrix_product(matrix_product(R, np.asarray(I_B, dtype=np.float64)), R.swapaxes(-1, -2))
    return np.asarray(0.5 * (turned + turned.swapaxes(-1, -2)))


def perpendicular_frame(z: ArrayLike) -> Array:
    """Rotation (3, 3) whose z axis is the unit vector ``z`` and whose x axis is as close as possible to the parent's x.

    If z is within about 26 degrees of the parent's x (|z.x| > 0.9), x follows the parent's y instead.
    """
    z0, z1, z2 = unit(z).tolist()
    # Plain floats: as arrays the same operations take twenty times as long.
    t0, t1 = (0.0, 1.0) if abs(z0) > 0.9 else (1.0, 0.0)
    along = t0 * z0 + t1 * z1 + 0.0 * z2
    x0, x1, x2 = t0 - along * z0, t1 - along * z1, 0.0 - along * z2
    size = math.hypot(x0, x1, x2)
    x0, x1, x2 = x0 / size, x1 / size, x2 / size
    y0, y1, y2 = z1 * x2 - z2 * x1, z2 * x0 - z0 * x2, z0 * x1 - z1 * x0
    return np.array([[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]])


def bounds(points: ArrayLike) -> tuple[Vector3, Vector3]:
    """Lowest and highest corner of points (n, 3), in their unit.

    Raises:
        ValueError: There is no point.
    """
    low, high = corners(np.asarray(points, dtype=np.float64))
    return vector3(low), vector3(high)


def corners(points: Array) -> tuple[Array, Array]:
    """Lowest and highest corner (3,) of points (n, 3), as arrays; numpy is ten times as slow along their first axis."""
    columns = np.ascontiguousarray(points.T)
    return columns.min(axis=1), columns.max(axis=1)


def box_corners(low: Sequence[float], high: Sequence[float]) -> Array:
    """Corners (8, 3) of a box, from its lowest and highest one."""
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def join_bounds(boxes: Iterable[tuple[Vector3, Vector3]]) -> tuple[Vector3, Vector3]:
    """The bounding box of boxes.

    Raises:
        ValueError: There is no box.
    """
    corners = [corner for box in boxes for corner in box]
    if not corners:
        raise ValueError("no boxes to join")
    return bounds(corners)


def _read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array
