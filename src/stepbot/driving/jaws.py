"""Where a single jaw grips a cube against the link that carries it: found on their collision shapes, in MuJoCo.

Jaw and hand meet at their hinge in every position, so the nearest points of both are no faces that grip. Instead, balls
that touch the hand are tried, on a grid over the space that the jaw sweeps. The jaw grips a ball if it comes to it from
an end of its range that leaves the ball free, opposite the hand, and could close further. The cube takes the place of a
ball, flat on the hand.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from math import acos, ceil, degrees, radians, sqrt, tan

import numpy as np
from msgspec import Struct

from stepbot.engines.mujoco.simulation import MujocoSimulation
from stepbot.engines.simulation import Cube, Mechanism, Setup
from stepbot.geometry.spatial import Array, Pose, corners, rotated, unit
from stepbot.robot.model import Base

from .grasping import FACE, SHORTEST_STROKE, WIDEST, Grasp, overlap, path_of
from .mechanism import Fingers

NARROWEST = 0.01
"""Smallest edge [m] of a cube."""
WIDEST_WEDGE = 40.0
"""Largest angle [deg] between the faces that grip, less than the angle of friction."""
_FRICTION_ANGLE = 45.0
"""Angle [deg] between faces at which a cube that lies flat on one of them is pressed out, with a coefficient of 1."""
LEAST_COVER = 0.15
"""Least share of each of the two gripped faces of the cube, and a quarter edge around them, in front of jaw or hand."""
_NEAR = 0.1
"""Distance of a face that is in front of the cube, relative to the cube's edge; at most :data:`FACE`."""
_SPACING, _MOST_POINTS = 0.005, 8000
"""Spacing [m] of the grid, wider for jaws that sweep a large space."""
_STEP, _POSITIONS = 0.003, (21, 161)
"""Way [m] of the jaw's farthest point from one position to the next, and the least and largest number of positions."""
_FLOOR = 0.01
"""Height [m] above the robot's lowest point up to which a link stands on the floor."""
_FAR = 0.15
"""Distance [m] up to which distances are measured."""
_FINER = 4
"""How many times finer the grid around the best place is."""
_TRIED = 300
"""Number of balls, large ones with small wedges, that are compared further."""
_CLEARANCE = 2e-4
"""Distance [m] between hand and cube before the jaw closes."""
_SAMPLES = (-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75)
"""Positions on a face of the cube and around it, relative to its edge: in the middle of a face is the best place."""


class _Ball(Struct, frozen=True, eq=False):
    """A ball between hand and jaw."""

    centre: Array
    """(3,) [m], in the hand."""
    radius: float
    """[m]"""
    outwards: Array
    """Normal (3,) of the hand where the ball touches it."""
    order: range
    """Positions of the jaw, from open to closed."""
    at: int
    """Position in which the jaw touches the ball."""
    wedge: float
    """Angle [deg] between the two faces."""
    gaps: tuple[float, float]
    """Narrowest and widest distance [m] between the points that touch the ball."""

    @property
    def edge(self) -> float:
        """Edge [m] of a cube in the ball's place: whole millimetres."""
        return int(2e3 * self.radius) / 1e3

    @property
    def promise(self) -> float:
        """How well a cube could be gripped: between parallel faces, and rather a large one than a small one."""
        return float((1.0 - self.wedge / _FRICTION_ANGLE) ** 3 * sqrt(self.edge))


class _Place(Struct, frozen=True, eq=False):
    """A cube in a ball's place."""

    ball: _Ball
    lift: float
    """Distance [m] between the cube and where the ball touches the hand: its edges touch elsewhere."""
    cover: float
    """The smaller one of the shares of the gripped faces, and a quarter edge around them, that hand and jaw face."""


def find_jaw_grasp(file: str, mechanism: Mechanism, fingers: Fingers, mass: float) -> Grasp | str:
    """The grasp of a jaw and the link that carries it, or why they are none.

    Args:
        fingers: The jaw, and the hand as the other side.
        mass: Mass [kg] of the cube.
    """
    hand = _Hand(file, mechanism, fingers)
    if not hand.moves:
        return "a link without collision shapes, or a motor without limits"
    if hand.stands():
        return "the link stands on the floor"
    closing = [ball for ball in hand.balls() if _closes(ball)]
    if not closing:
        return "the link does not close on the one that carries it"
    strokes = [ball for ball in closing if ball.gaps[1] - ball.gaps[0] >= SHORTEST_STROKE]
    if not strokes:
        widest = max(ball.gaps[1] - ball.gaps[0] for ball in closing)
        return f"the gap changes by {1e3 * widest:.1f} mm, less than {1e3 * SHORTEST_STROKE:g} mm"
    parallel = [ball for ball in strokes if ball.wedge <= WIDEST_WEDGE]
    if not parallel:
        narrowest = min(ball.wedge for ball in strokes)
        return f"the faces that close are at {narrowest:.0f} degrees to each other, more than {WIDEST_WEDGE:g}"
    best = hand.ranked(parallel)
    if not best:
        return "the faces that close are not opposite each other"
    near = [ball for ball in hand.balls(best[0].ball.centre) if _closes(ball) and ball.wedge <= WIDEST_WEDGE]
    for place in hand.ranked([*near, *(place.ball for place in best)]):
        grasp = hand.grasp(place, mass)
        if not overlap(file, mechanism, grasp):
            return grasp
    return f"a cube of {1e3 * best[0].ball.edge:.0f} mm between them touches the open hand"


def _closes(ball: _Ball) -> bool:
    """Whether jaw and hand come closer than half a cube, which is at most half as wide as the widest gap."""
    return ball.gaps[0] <= 0.5 * ball.edge and ball.edge <= 0.5 * ball.gaps[1]


class _Hand:
    """Hand and jaw without a floor, to measure distances."""

    def __init__(self, file: str, mechanism: Mechanism, fingers: Fingers) -> None:
        self._mechanism, self._fingers = mechanism, fingers
        self._simulation = MujocoSimulation(file, mechanism, Setup(held=True, cube=Cube(NARROWEST, 1.0)))
        self._moving, self._fixed = (self._simulation.solids(side) for side in (fingers.one, fingers.other))
        self.joint = next(motor.joint for motor in mechanism.motors if motor.name in fingers.motors)
        self._jaw = mechanism.robot.joint_by_name[self.joint].child
        coarse = path_of(mechanism, fingers, _POSITIONS[0]) if self._moving and self._fixed else []
        self.moves = len(coarse) > 1
        if self.moves:
            way = float(np.linalg.norm(np.diff(self._swept(coarse), axis=0), axis=2).sum(axis=0).max())
            count = min(max(_POSITIONS[0], ceil(way / _STEP)), _POSITIONS[1])
            self._path = path_of(mechanism, fingers, count)
            points = self._swept(self._path).reshape(-1, 3)
            self._low, self._high = corners(points)
            self._X_HJ = [self._placed(q) for q in self._path]
            self._X_JH = [X_HJ.inverse() for X_HJ in self._X_HJ]
            box = np.array(list(product(*zip(self._low, self._high, strict=True))))
            seen = np.array([X_JH.apply(box) for X_JH in self._X_JH])
            self._step = float(np.linalg.norm(np.diff(seen, axis=0), axis=2).max()) + 1e-9
            self._X_WH, self._X_WJ = (self._simulation.pose(link) for link in (fingers.hand, self._jaw))
            self._X_HW, self._X_JW = self._X_WH.inverse(), self._X_WJ.inverse()
            self._R_HJ = np.array([X_HJ.R for X_HJ in self._X_HJ])
            self._p_HJ = np.array([X_HJ.p for X_HJ in self._X_HJ])

    def stands(self) -> bool:
        """Whether the jaw of a floating robot is its foot: at home it is as low as the robot."""
        if self._mechanism.robot.base is not Base.FLOATING:
            return False
        self._simulation.reset(self._mechanism.home)
        lowest = min(float(self._simulation.shape_points(geom)[:, 2].min()) for geom in self._moving)
        return lowest < self._simulation.lowest() + _FLOOR

    def _placed(self, q: Mapping[str, float]) -> Pose:
        self._simulation.reset(q)
        return self._simulation.pose(self._fingers.hand).inverse() @ self._simulation.pose(self._jaw)

    def _swept(self, path: list[dict[str, float]]) -> Array:
        """Corners of the jaw's shapes in the hand, at each position: (positions, corners, 3)."""
        poses = [self._placed(q) for q in path]
        X_JW = self._simulation.pose(self._jaw).inverse()
        points = X_JW.apply(np.vstack([self._simulation.shape_points(geom) for geom in self._moving]))
        return np.array([X_HJ.apply(points) for X_HJ in poses])

    def _to_hand(self, p_H: Array, most: float) -> tuple[float, Array]:
        """Distance [m] of a point in the hand to the hand's shapes, and the nearest point (3,) in the hand."""
        distance, near = self._simulation.nearest(self._X_WH.apply(p_H), self._fixed, most)
        return distance, self._X_HW.apply(near)

    def _to_jaw(self, p_H: Array, at: int) -> tuple[float, Array]:
        """Distance [m] of a point in the hand to the jaw at a position, and the nearest point (3,) in the jaw."""
        p_W = self._X_WJ.apply(self._X_JH[at].apply(p_H))
        distance, near = self._simulation.nearest(p_W, self._moving, _FAR)
        return distance, self._X_JW.apply(near)

    def balls(self, around: Array | None = None) -> Iterator[_Ball]:
        """Balls that touch the hand and that the jaw comes to, in the space that it sweeps, or finer around a point."""
        low, high = self._low, self._high
        spacing = max(_SPACING, float(np.prod(high - low + _SPACING) / _MOST_POINTS) ** (1.0 / 3.0))
        if around is not None:
            low, high, spacing = around - spacing, around + spacing, spacing / _FINER
        axes = [np.arange(start, end + 0.5 * spacing, spacing) for start, end in zip(low, high, strict=True)]
        for centre in (np.array(point) for point in product(*axes)):
            radius, touched = self._to_hand(centre, 0.5 * WIDEST + 1e-6)
            if 0.5 * NARROWEST <= radius <= 0.5 * WIDEST:
                yield from self._gripped(centre, radius, touched)

    def _gripped(self, centre: Array, radius: float, touched: Array) -> Iterator[_Ball]:
        """The ball around a point, for each end of the range from which the jaw comes to it."""
        outwards = unit(centre - touched)
        for order in (range(len(self._path)), range(len(self._path) - 1, -1, -1)):
            at, distance = self._reached(centre, radius, order)
            if at == order[0] or distance <= 0.5 * radius:  # in the way from the start, or leapt over
                continue
            p_J = self._to_jaw(centre, at)[1]
            ways = np.linalg.norm(rotated(self._R_HJ, p_J) + self._p_HJ - touched, axis=1)[:: order.step]
            inwards = unit(self._X_HJ[at].apply(p_J) - centre)
            wedge = degrees(acos(min(1.0, max(-1.0, float((inwards * outwards).sum())))))
            narrowest = float(ways[order.index(at) :].min())
            yield _Ball(centre, radius, outwards, order, at, wedge, (narrowest, float(ways[0])))

    def _reached(self, centre: Array, radius: float, order: range) -> tuple[int, float]:
        """The first position in which the jaw touches a ball, and its distance [m]; the open one if there is none."""
        i = 0
        while i < len(order):
            distance = self._to_jaw(centre, order[i])[0]
            if distance <= radius:
                return order[i], distance
            i += max(1, int((distance - radius) / self._step))  # no point of the jaw moves farther in one position
        return order[0], _FAR

    def ranked(self, balls: list[_Ball]) -> list[_Place]:
        """Cubes in the places of the most promising balls, the best one first, if faces cover them."""
        places = map(self._place, sorted(balls, key=lambda ball: -ball.promise)[:_TRIED])
        return sorted(
            (place for place in places if place.cover >= LEAST_COVER),
            key=lambda place: -(place.ball.promise * place.cover**2),
        )

    def _place(self, ball: _Ball) -> _Place:
        X_HC, half = self._cube_pose(ball), 0.5 * ball.edge
        grid = [(y * ball.edge, z * ball.edge) for y, z in product(_SAMPLES, _SAMPLES)]
        back = [self._to_hand(p_H, _FAR)[0] for p_H in X_HC.apply([(-half, y, z) for y, z in grid])]
        front = [self._to_jaw(p_H, ball.at)[0] for p_H in X_HC.apply([(half, y, z) for y, z in grid])]
        lift = max(0.0, *(-gap for gap, (y, z) in zip(back, grid, strict=True) if max(abs(y), abs(z)) <= half))
        near = min(FACE, _NEAR * ball.edge)
        slack = near + half * tan(radians(ball.wedge))
        covered = [np.count_nonzero(np.add(back, lift) <= near), np.count_nonzero(np.subtract(front, lift) <= slack)]
        return _Place(ball, lift, min(covered) / len(grid))

    def _cube_pose(self, ball: _Ball) -> Pose:
        """Pose of the cube in the hand: x from the hand to the jaw, z away from the jaw's joint."""
        x = ball.outwards
        z = ball.centre - self._X_HJ[0].p
        z = z - x * float((x * z).sum())
        z = unit(z) if float((z * z).sum()) > 1e-12 else unit(np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))]))
        return Pose.of(np.column_stack([x, np.cross(z, x), z]), ball.centre)

    def grasp(self, place: _Place, mass: float) -> Grasp:
        ball = place.ball
        opened, closed = self._path[ball.order[0]], self._path[ball.order[-1]][self.joint]
        X_HC = self._cube_pose(ball) @ Pose.of(position=(place.lift + _CLEARANCE, 0.0, 0.0))
        return Grasp(self._fingers, Cube(ball.edge, mass), X_HC, opened, closed, ball.gaps)
