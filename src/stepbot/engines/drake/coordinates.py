"""Coordinates of a Drake plant, converted to those of the reference: three angles per ball, two per universal joint."""

from collections.abc import Mapping, Sequence
from typing import Any

from stepbot.geometry.spatial import Array, Pose

from ..ball_coordinates import Velocities
from ..observation import Request


class Coordinates:
    """Positions and velocities of a plant's joints as functions of named coordinates.

    Drake parametrizes a ball by roll, pitch and yaw, and its velocity as the angular velocity in the parent's frame.
    """

    def __init__(self, plant: Any, joints: Sequence[Any], request: Request) -> None:
        """Classify the joints; a ball or universal joint without coordinates in the request does not move."""
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
        single = [(start, name, 1.0) for name, (_, start) in self._single.items()]
        balls = [(names, start) for names, (_, start) in self._balls.items()]
        self.velocities = Velocities(plant.num_velocities(), self.names, single, balls, in_parent=True)

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


def pose(X: Any) -> Pose:
    """A pose from Drake's."""
    return Pose.of(X.rotation().matrix(), X.translation())
