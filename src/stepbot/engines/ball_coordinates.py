"""Rotation of a ball joint by its coordinates yaw, pitch and roll, for engines that use its angular velocity.

Everything is expressed in the child's frame C. P is the frame after yaw and Q that after pitch, so that ``R_CQ =
Rx(roll)^T`` and ``R_CP = Rx(roll)^T Ry(pitch)^T``.
"""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, rotation_from_rpy
from stepbot.robot.dynamics import Rates
from stepbot.robot.kinematics import Configuration
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


class Velocities(Struct, frozen=True):
    """An engine's velocities and accelerations from those of named coordinates; a ball has an angular velocity."""

    size: int
    """Number of the engine's velocities."""
    names: tuple[str, ...]
    """The coordinates."""
    single: Sequence[tuple[int, str, float]]
    """Index of a velocity, its coordinate, and the velocity per unit speed of that."""
    balls: Sequence[tuple[tuple[str, str, str], int]]
    """Yaw, pitch and roll of each ball, and the index of the first of its velocities."""
    in_parent: bool = False
    """Whether angular velocities are in the parent's frame instead of the child's."""

    def rates(self, q: Configuration) -> Array:
        """The engine's velocities per unit speed of each coordinate, shape (size, n)."""
        E = np.zeros((self.size, len(self.names)))
        column = {name: i for i, name in enumerate(self.names)}
        for row, name, factor in self.single:
            E[row, column[name]] = factor
        for names, start in self.balls:
            angles = [q.get(name, 0.0) for name in names]
            E[start : start + 3, [column[name] for name in names]] = self._turned(angles, ball_rates(angles))
        return E

    def moving(self, q: Configuration, rates: Rates) -> tuple[Array, Array]:
        """The engine's velocities (size,) and accelerations (size,) from those of the coordinates."""
        E = self.rates(q)
        v, a = (np.array([rate.get(name, 0.0) for name in self.names]) for rate in rates)
        accelerations = E @ a
        for names, start in self.balls:
            angles, speeds = ([given.get(name, 0.0) for name in names] for given in (q, rates[0]))
            # The derivative of a vector is the same in both frames if it is their relative angular velocity.
            accelerations[start : start + 3] += self._turned(angles, ball_bias(angles, speeds))
        return E @ v, accelerations

    def _turned(self, angles: Sequence[float], vectors: Array) -> Array:
        """Vectors (3, ...) in the child's frame, in that of the engine."""
        yaw, pitch, roll = angles
        return rotation_from_rpy((roll, pitch, yaw)) @ vectors if self.in_parent else vectors


def inner_joints(file: Path, kinds: Collection[str] = ("planar", "floating")) -> str:
    """Names and kinds of such joints, for messages; empty if there are none.

    A floating joint below a root link ``world`` is the base of a floating robot, which engines read alike.

    Args:
        kinds: The kinds that the engine does not read.

    Raises:
        EngineRefused: The file is not XML.
    """
    lines = []
    for joint in xml_root(file).iterfind("joint") if is_file(file) else ():  # engines reject what is not there
        kind, parent = joint.get("type"), joint.find("parent")
        on_world = kind == "floating" and parent is not None and parent.get("link") == "world"
        if kind in kinds and not on_world:
            lines.append(f"'{joint.get('name')}' ({kind})")
    return ", ".join(lines)
