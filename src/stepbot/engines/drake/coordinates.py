"""Coordinates of a Drake plant, converted to those of the reference: three angles per ball, two per universal joint."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Array, Pose, rotation_from_rpy
from stepbot.robot.dynamics import Rates

from ..ball_coordinates import ball_bias, ball_rates
from ..observation import Request


class Coordinates:
    """Positions and velocities of a plant's joints as functions of named coordinates.

    Drake parametrizes a ball by roll, pitch and yaw, and its velocity as the angular velocity in the parent's frame.
    """

    def __init__(self, plant: Any, joints: Sequence[Any], request: Request) -> None:
        """Classify the joints; a ball or universal joint without coordinates in the request does not move."""
        self._nv = plant.num_velocities()
        self._single: dict[str, tuple[int, int]] = {}
        self._balls: dict[tuple[str, str, str], tuple[int, int]] = {}
        names: list[str] = []
        for joint in joints:
            name, kind = joint.name(), joint.type_name()
            start = (joint.position_start(), joint.velocity_start())
            if joint.num_velocities() == 1:
                self._single[name] = start
                names.append(name)
            elif kind == "universal" and name in request.universals:
                for i, angle in enumerate(request.universals[name]):
                    self._single[angle] = (start[0] + i, start[1] + i)
                    names.append(angle)
            elif kind == "ball_rpy" and name in request.balls:
                self._balls[request.balls[name]] = start
                names += request.balls[name]
        self.names = tuple(names)

    def place(self, positions: Array, q: Mapping[str, float]) -> None:
        """Set the joints to ``q``; missing coordinates are 0."""
        for name, (start, _) in self._single.items():
            positions[start] = q.get(name, 0.0)
        for names, (start, _) in self._balls.items():
            yaw, pitch, roll = (q.get(name, 0.0) for name in names)
            positions[start : start + 3] = roll, pitch, yaw

    def read(self, positions: Array) -> dict[str, float]:
        """The coordinates of the plant's current configuration."""
        q = {name: float(positions[start]) for name, (start, _) in self._single.items()}
        for names, (start, _) in self._balls.items():
            roll, pitch, yaw = positions[start : start + 3].tolist()
            q |= dict(zip(names, (yaw, pitch, roll), strict=True))
        return q

    def rates(self, q: Mapping[str, float]) -> Array:
        """Drake's velocities per unit speed of each coordinate, shape (nv, n)."""
        E = np.zeros((self._nv, len(self.names)))
        column = {name: i for i, name in enumerate(self.names)}
        for name, (_, start) in self._single.items():
            E[start, column[name]] = 1.0
        for names, (_, start) in self._balls.items():
            angles, R_PC = _turned(names, q)
            E[start : start + 3, [column[name] for name in names]] = R_PC @ ball_rates(angles)
        return E

    def moving(self, q: Mapping[str, float], rates: Rates) -> tuple[Array, Array]:
        """Drake's velocities (nv,) and accelerations (nv,) from those of the coordinates."""
        E = self.rates(q)
        v, a = (np.array([rate.get(name, 0.0) for name in self.names]) for rate in rates)
        accelerations = E @ a
        for names, (_, start) in self._balls.items():
            angles, R_PC = _turned(names, q)
            # The derivative of a vector is the same in both frames if it is their relative angular velocity.
            bias = ball_bias(angles, [rates[0].get(name, 0.0) for name in names])
            accelerations[start : start + 3] += R_PC @ bias
        return E @ v, accelerations


def _turned(names: Sequence[str], q: Mapping[str, float]) -> tuple[list[float], Array]:
    """Yaw, pitch and roll, and their rotation."""
    yaw, pitch, roll = (q.get(name, 0.0) for name in names)
    return [yaw, pitch, roll], rotation_from_rpy((roll, pitch, yaw))


def pose(X: Any) -> Pose:
    """A pose from Drake's."""
    return Pose.of(X.rotation().matrix(), X.translation())
