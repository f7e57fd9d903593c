"""Denavit-Hartenberg parameters of a chain of joints, from the common normals of its axes.

Row i has the angle and the distance about and along axis i, and the length and the twist of the common normal to the
next axis. In the standard convention a joint is Rz(theta) Tz(d) Tx(a) Rx(alpha) of its row; in the modified one (Craig)
it is Rx(alpha) Tx(a) of the row before and Rz(theta) Tz(d) of its own. Signs keep angles at q = 0 small.
"""

from collections.abc import Sequence
from math import atan2

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, Pose, rotation_about

from .kinematics import configurations, link_poses
from .model import Frame, JointKind, Robot

_PARALLEL = 1e-9
_CHECKED = 8
"""Number of random configurations at which the table is compared with the kinematics."""
TOLERANCE = 1e-6
"""Largest deviation [m] of the tip, and of its rotation, of a table that is reported."""
_DECIMALS = 9


class DhRow(Struct, frozen=True):
    """A joint; its position is added to ``theta``, or to ``d`` if it slides."""

    joint: str
    slides: bool
    theta: float
    """[rad] at q = 0."""
    d: float
    """[m] at q = 0."""
    a: float
    """[m]."""
    alpha: float
    """[rad]."""


class DhTable(Struct, frozen=True, eq=False):
    """The parameters of a chain."""

    rows: tuple[DhRow, ...]
    base: Pose
    """Pose of the first frame in the root link."""
    tool: Pose
    """Pose of the tip in the last frame."""
    deviation: float
    """Largest deviation [m] or of rotations from the kinematics, at random configurations."""


def dh_table(robot: Robot, names: Sequence[str], tip: Frame) -> DhTable | None:
    """The parameters of the joints from the root to a tip; None with a joint that has not one axis."""
    joints = [robot.joint_by_name[name] for name in names]
    if any(joint.kind not in (JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC) for joint in joints):
        return None
    zero = {joint.name: 0.0 for joint in robot.joints if joint.kind is not JointKind.FIXED}
    X = link_poses(robot, zero)
    X_RT = X[tip.link] @ tip.X_LF
    points = [X[joint.child].p for joint in joints]
    axes = [X[joint.child].R @ np.array(joint.axis) for joint in joints]
    x = _across(axes[0], np.eye(3)[0], np.eye(3)[1])
    foot = points[0] + axes[0] * (axes[0] @ -points[0])
    base = Pose.of(np.column_stack([x, np.cross(axes[0], x), axes[0]]), foot)
    rows = []
    for i, joint in enumerate(joints):
        z, p = axes[i], points[i]
        if i + 1 < len(joints):
            here, there, normal = _normal(p, z, points[i + 1], axes[i + 1], foot, x)
            a, alpha = float((there - here) @ normal), _angle(z, axes[i + 1], normal)
        else:
            here = p + z * (z @ (X_RT.p - p))
            there, normal, a, alpha = here, _across(z, X_RT.R[:, 0], X_RT.R[:, 1]), 0.0, 0.0
        slides = joint.kind is JointKind.PRISMATIC
        numbers = (_angle(x, normal, z), float((here - foot) @ z), a, alpha)
        rows.append(DhRow(joint.name, slides, *(round(value, _DECIMALS) + 0.0 for value in numbers)))
        foot, x = there, normal
    last = Pose.of(np.column_stack([x, np.cross(axes[-1], x), axes[-1]]), foot)
    table = DhTable(tuple(rows), base, last.inverse() @ X_RT, 0.0)
    worst = 0.0
    for q in configurations(robot, _CHECKED):
        X_q = link_poses(robot, q)
        worst = max(worst, *forward(table, q).distance_to(X_q[tip.link] @ tip.X_LF))
    return DhTable(table.rows, table.base, table.tool, worst) if worst <= TOLERANCE else None


def forward(table: DhTable, q: dict[str, float]) -> Pose:
    """Pose of the tip in the root link, by the standard convention."""
    X = table.base
    for row in table.rows:
        turn, slide = (0.0, q[row.joint]) if row.slides else (q[row.joint], 0.0)
        about_z = Pose.of(rotation_about(np.eye(3)[2], row.theta + turn), (0.0, 0.0, row.d + slide))
        X = X @ about_z @ Pose.of(rotation_about(np.eye(3)[0], row.alpha), (row.a, 0.0, 0.0))
    return X @ table.tool


def _across(z: Array, *candidates: Array) -> Array:
    """The first direction that is not along z, across it."""
    for candidate in candidates:
        across = candidate - z * (z @ candidate)
        if np.linalg.norm(across) > _PARALLEL:
            return np.asarray(across / np.linalg.norm(across))
    raise ValueError("all directions are along the axis")


def _normal(p: Array, z: Array, p_next: Array, z_next: Array, foot: Array, x: Array) -> tuple[Array, Array, Array]:
    """The ends of the common normal of two axes, and its direction, which is the one nearer to x.

    Of the normals of parallel axes it is that at ``foot``.
    """
    across = np.cross(z, z_next)
    sine = float(np.linalg.norm(across))
    if sine <= _PARALLEL:
        here = foot
        there = p_next + z_next * (z_next @ (here - p_next))
        apart = there - here
        normal = apart / np.linalg.norm(apart) if np.linalg.norm(apart) > _PARALLEL else x
    else:
        normal = across / sine
        s, t = np.linalg.lstsq(np.column_stack([z, -z_next]), p_next - p, rcond=None)[0]
        here, there = p + s * z, p_next + t * z_next
    side = float(normal @ x)
    if abs(side) <= _PARALLEL:
        side = float(normal @ np.cross(z, x))
    return here, there, normal if side >= 0.0 else -normal


def _angle(a: Array, b: Array, about: Array) -> float:
    """The angle [rad] from a to b about an axis across both."""
    return atan2(float(np.cross(a, b) @ about), float(a @ b))
