"""Where two fingers grip a cube: found on their collision shapes, in MuJoCo.

Two groups of links are fingers if the motor that moves them changes the gap between them by more than
:data:`SHORTEST_STROKE`, and they touch nothing when open. The cube is half as wide as the widest gap, its faces across
the direction in which the fingers close, its centre in the middle of the faces that are nearest to each other.
"""

from collections.abc import Mapping
from itertools import product

import numpy as np
from msgspec import Struct

from stepbot.engines.mujoco.simulation import MujocoSimulation
from stepbot.engines.simulation import Cube, Mechanism, Motor, Setup
from stepbot.geometry.spatial import Array, Pose, unit
from stepbot.robot.posing import NotReached, posed

from .mechanism import Fingers

SHORTEST_STROKE = 0.01
"""Change [m] of the gap from which two links count as fingers."""
WIDEST = 0.04
"""Largest edge [m] of a cube."""
FACE = 1.5e-3
"""Depth [m] of the faces that grip: vertices behind the nearest point by less belong to them."""
_TOUCHING = 1e-6
"""Depth [m] up to which the cube does not touch the robot."""
_OUTWARDS = (0.0, 0.1, 0.2, 0.3, 0.4)
"""Places of a given object, away from the hand, relative to its size: a large one touches the palm in the middle of the
fingers."""
_POSITIONS = 21
_FAR = 1.0


class Grasp(Struct, frozen=True):
    """A cube between two fingers."""

    fingers: Fingers
    cube: Cube
    X_HC: Pose
    """Pose of the cube in the hand's link."""
    open: Mapping[str, float]
    """Configuration with the widest gap."""
    closed: float
    """Position [rad] or [m] towards which the motors close."""
    gaps: tuple[float, float]
    """Narrowest and widest gap [m]."""


def find_grasp(
    file: str, mechanism: Mechanism, fingers: Fingers, mass: float, given: Cube | None = None
) -> Grasp | str:
    """The grasp of two groups of links, or why they are not fingers.

    Args:
        mass: Mass [kg] of the cube.
        given: What to grip in its place.
    """
    room = _Room(file, mechanism, fingers)
    path = path_of(mechanism, fingers, _POSITIONS) if room.has_shapes else []
    if len(path) < 2:
        return "a link without collision shapes, or a motor without limits"
    gaps = [room.gap(q)[0] for q in path]
    widest, narrowest = max(gaps), min(gaps)
    ends = gaps[0], gaps[-1]
    if widest - narrowest < SHORTEST_STROKE:
        return f"the gap changes by {1e3 * (widest - narrowest):.1f} mm, less than {1e3 * SHORTEST_STROKE:g} mm"
    if abs(ends[0] - ends[1]) < 0.5 * (widest - narrowest):
        return "the gap is not widest at one end of the range and narrowest at the other"
    if ends[0] < ends[1]:  # the path is to go from open to closed
        path, gaps = path[::-1], gaps[::-1]
    edge, why = given.edge if given else min(WIDEST, 0.5 * widest), ""
    for _ in range(1 if given else 3):
        near = next((i for i, gap in enumerate(gaps) if gap <= edge), len(gaps) - 1)
        X_HC = room.cube_pose(path[near], path[max(near - 1, 0)], path[max(near, 1)])
        if X_HC is None:
            why = "the faces nearest to each other are not opposite each other"
        else:
            cube = given or Cube(edge, mass)
            for out in _OUTWARDS if given else (0.0,):
                X_HO = X_HC @ Pose.of(position=(0.0, 0.0, out * edge))
                grasp = Grasp(fingers, cube, X_HO, path[0], path[-1][room.joint], (narrowest, widest))
                if not overlap(file, mechanism, grasp):
                    return grasp
            why = f"a {cube} between them touches the open hand"
        edge *= 0.7
    return why


def path_of(mechanism: Mechanism, fingers: Fingers, count: int) -> list[dict[str, float]]:
    """Configurations over the range of the fingers' motors, as far as the loops allow; none without limits."""
    motors = _motors(mechanism, fingers)
    limit = motors[0].limit
    if not np.isfinite([limit.lower, limit.upper]).all():
        return []
    path = []
    for q in np.linspace(limit.lower, limit.upper, count).tolist():
        try:
            path.append(posed(mechanism.robot, {motor.joint: q for motor in motors}))
        except NotReached:
            continue
    return path


def _motors(mechanism: Mechanism, fingers: Fingers) -> list[Motor]:
    return [motor for motor in mechanism.motors if motor.name in fingers.motors]


def overlap(file: str, mechanism: Mechanism, grasp: Grasp) -> float:
    """Depth [m] of the cube in the robot while the fingers are open; 0 if it does not touch it."""
    simulation = MujocoSimulation(file, mechanism, Setup(held=True, cube=grasp.cube))
    simulation.reset(grasp.open)
    allowed = simulation.penetration()
    simulation.place_cube(simulation.pose(grasp.fingers.hand) @ grasp.X_HC)
    depth = simulation.penetration() - allowed
    return depth if depth > _TOUCHING else 0.0


class _Room:
    """The robot without a floor, to measure gaps."""

    def __init__(self, file: str, mechanism: Mechanism, fingers: Fingers) -> None:
        self._fingers = fingers
        self._simulation = MujocoSimulation(file, mechanism, Setup(held=True))
        self._sides = [self._simulation.solids(side) for side in (fingers.one, fingers.other)]
        self.has_shapes = all(self._sides)
        self.joint = _motors(mechanism, fingers)[0].joint

    def gap(self, q: Mapping[str, float]) -> tuple[float, Array]:
        """Distance [m] of the two sides, and the nearest points (2, 3)."""
        self._simulation.reset(q)
        pairs = [self._simulation.distance(a, b, _FAR) for a, b in product(*self._sides)]
        return min(pairs, key=lambda pair: pair[0])

    def cube_pose(self, q: Mapping[str, float], before: Mapping[str, float], after: Mapping[str, float]) -> Pose | None:
        """Pose of the cube in the hand: x is the direction in which the fingers close; None if they do not face it.

        Args:
            q: Configuration in which they touch the cube.
            before: One of two configurations between which they close, ...
            after: ... and the other one.
        """
        moved = self._centres(after) - self._centres(before)
        closing = moved[0] - moved[1]
        if np.linalg.norm(closing) < 1e-9:
            return None
        x = unit(closing)
        _, ends = self.gap(q)
        faces = [self._face(side, x, end, sign) for side, end, sign in zip(self._sides, ends, (1.0, -1.0), strict=True)]
        X_WH = self._simulation.pose(self._fingers.hand)
        middle = 0.5 * (faces[0].mean(axis=0) + faces[1].mean(axis=0))
        z = middle - X_WH.p
        z -= x * (x @ z)
        z = unit(z) if np.linalg.norm(z) > 1e-6 else unit(np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))]))
        R = np.column_stack([x, np.cross(z, x), z])
        low = np.max([(face @ R).min(axis=0) for face in faces], axis=0)
        high = np.min([(face @ R).max(axis=0) for face in faces], axis=0)
        centre = 0.5 * (low + high)
        centre[0] = 0.5 * float((ends @ x).sum())
        if (high[1:] < low[1:]).any():
            return None
        return X_WH.inverse() @ Pose.of(R, R @ centre)

    def _centres(self, q: Mapping[str, float]) -> Array:
        self._simulation.reset(q)
        return np.array([self._points(side).mean(axis=0) for side in self._sides])

    def _points(self, side: list[int]) -> Array:
        return np.vstack([self._simulation.shape_points(geom) for geom in side])

    def _face(self, side: list[int], x: Array, end: Array, sign: float) -> Array:
        """Vertices of a side that face the other."""
        points = self._points(side)
        chosen: Array = points[sign * (points @ x - end @ x) > -FACE]
        return chosen if len(chosen) else end.reshape(1, 3)
