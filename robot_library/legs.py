"""Forward and inverse kinematics of legs with three joints, of quadrupeds and hexapods.

The first joint turns the leg about an axis of the body, x for a quadruped and z for a hexapod; hip and knee turn
about y of the first joint's child. At q = 0 the leg is straight, along the unit vector ``straight``. ::

    body --first--> hip link --hip, about y--> upper link --knee, about y--> lower link --> foot

Lengths are in any one unit.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import acos, atan2, sqrt
from typing import Any

import numpy as np

from .expected import frame
from .moments import Array, pose, turn


@dataclass(frozen=True, eq=False)
class Leg:
    """One leg."""

    name: str
    X_BF: Array
    """Frame of the first joint in the body, shape (4, 4)."""
    first: str
    """``x`` or ``z``: the axis of the first joint."""
    hip: tuple[float, float, float]
    """The hip in the frame of the first joint's child."""
    upper: float
    lower: float
    straight: tuple[float, float, float]
    """Direction of the straight leg: -z for a quadruped, x for a hexapod."""
    knee: int
    """Sign of the knee's position."""

    def places(self, q: Sequence[float]) -> tuple[Array, Array, Array, Array]:
        """Frames in the body of the children of the three joints, and of the foot, axes as the lower link's."""
        along = np.array(self.straight)
        X_B1 = self.X_BF @ pose(rotation=turn(self.first, q[0]))
        X_B2 = X_B1 @ pose(self.hip, turn("y", q[1]))
        X_B3 = X_B2 @ pose(self.upper * along, turn("y", q[2]))
        return X_B1, X_B2, X_B3, X_B3 @ pose(self.lower * along)

    def reaching(self, foot: Array) -> tuple[float, float, float]:
        """Inverse kinematics: joint positions [rad] for a foot position in the body, shape (3,).

        Raises:
            ValueError: The position is out of reach.
        """
        p = self.X_BF[:3, :3].T @ (foot - self.X_BF[:3, 3])
        first = self._first(p)
        from_hip = turn(self.first, first).T @ p - np.array(self.hip)
        x, z = float(from_hip[0]), float(from_hip[2])
        cosine = (x * x + z * z - self.upper**2 - self.lower**2) / (2 * self.upper * self.lower)
        knee = self.knee * acos(cosine)
        along = np.array(self.straight)
        bent = self.upper * along + self.lower * (turn("y", knee) @ along)
        return first, _near(atan2(x, z) - atan2(float(bent[0]), float(bent[2]))), knee

    def _first(self, p: Array) -> float:
        """The position of the first joint at which a point is in the plane of hip and knee."""
        x, y, z = (float(value) for value in p)
        if self.first == "z":
            return atan2(y, x)
        aside = self.hip[1]
        return _near(atan2(z, y) - atan2(-sqrt(y * y + z * z - aside * aside), aside))


def _near(angle: float) -> float:
    """The same angle [rad] between -pi and pi."""
    return atan2(np.sin(angle), np.cos(angle))


def known_feet(
    foot: Callable[..., Array],
    joints: Sequence[str],
    drawn: Mapping[str, Sequence[float]],
    limits: tuple[Sequence[float], Sequence[float]],
    seed: int,
) -> dict[str, Any]:
    """The part of expected.json for legs: the poses of the feet at 21 joint positions, the drawn ones first.

    Args:
        foot: Computes X_BF [m] of a leg, by name, at positions [rad] of its joints.
        joints: Suffixes of the joint names, after the leg's name.
        drawn: Joint positions [rad] of each leg in the drawing.
        limits: Lowest and highest positions [rad] of a leg's joints.
        seed: Seed of the random positions.
    """
    rng = np.random.default_rng(seed)
    low, high = map(np.array, limits)
    states: list[Mapping[str, Sequence[float]]] = [drawn]
    states += [{name: (low + (high - low) * rng.random(len(joints))).tolist() for name in drawn} for _ in range(20)]
    return {
        "motions": [
            {
                "joints": {f"{name}_{joint}": q for name in drawn for joint, q in zip(joints, at[name], strict=True)},
                "frames": {f"{name}_foot": frame(foot(name, *at[name])) for name in drawn},
            }
            for at in states
        ]
    }
