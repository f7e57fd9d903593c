"""Rotation of a ball joint by its coordinates yaw, pitch and roll, for engines that use its angular velocity.

Everything is expressed in the child's frame C. P is the frame after yaw and Q that after pitch, so that ``R_CQ =
Rx(roll)^T`` and ``R_CP = Rx(roll)^T Ry(pitch)^T``.
"""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from stepbot.geometry.spatial import Array, rotation_from_rpy
from stepbot.runtime.file import is_file

from .xml import xml_root

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


def inner_joints(file: Path, kinds: Collection[str] = ("planar", "floating")) -> str:
    """Names and kinds of such joints, for messages; empty if there are none.

    A floating joint below a root link ``world`` is the base of a floating robot, which engines read alike.

    Args:
        kinds: The kinds that the engine does not read.

    Raises:
        EngineRefused: The file is not XML.
    """
    found = []
    for joint in xml_root(file).iterfind("joint") if is_file(file) else ():  # engines reject what is not there
        kind, parent = joint.get("type"), joint.find("parent")
        on_world = kind == "floating" and parent is not None and parent.get("link") == "world"
        if kind in kinds and not on_world:
            found.append(f"'{joint.get('name')}' ({kind})")
    return ", ".join(found)
