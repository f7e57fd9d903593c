"""Boxes that overlap at many poses, with python-fcl's boxes as the oracle."""

import fcl
import numpy as np

from stepbot.geometry.solids.box_pairs import boxes_meet
from stepbot.geometry.spatial import Array, Pose, rotation_from_rpy

IDENTITY = (np.eye(3)[None], np.zeros((1, 3)))


def box(*size: float, at: tuple[float, float, float] = (0, 0, 0)) -> tuple[Array, Array]:
    """Corners of a box around a point."""
    half = np.array(size) / 2
    return np.array(at) - half, np.array(at) + half


def test_as_python_fcl() -> None:
    """At random poses of random boxes, around half of which overlap, the answer is that of python-fcl."""
    rng = np.random.default_rng(5)
    answers = []
    for _ in range(40):
        sizes, at = rng.uniform(0.1, 1.0, (2, 3)), rng.uniform(-0.3, 0.3, (2, 3))
        poses = [Pose.of(rotation_from_rpy(rng.uniform(-3, 3, 3)), rng.uniform(-0.8, 0.8, 3)) for _ in range(25)]
        R, p = np.array([X.R for X in poses]), np.array([X.p for X in poses])
        met = boxes_meet(box(*sizes[0], at=tuple(at[0])), box(*sizes[1], at=tuple(at[1])), R, p)
        a = fcl.CollisionObject(fcl.Box(*sizes[0]), fcl.Transform(at[0]))
        for X, answer in zip(poses, met, strict=True):
            b = fcl.CollisionObject(fcl.Box(*sizes[1]), fcl.Transform(X.R, X.apply(at[1])))
            expected = bool(fcl.collide(a, b, fcl.CollisionRequest(), fcl.CollisionResult()))
            assert bool(answer) == expected
            answers.append(expected)
    assert 0.3 < np.mean(answers) < 0.7


def test_parallel_edges_separate_nothing() -> None:
    """Boxes with parallel edges overlap as intervals do: the cross product of their edges is no axis."""
    R, _ = IDENTITY
    for x, expected in ((0.999, True), (1.001, False)):
        assert boxes_meet(box(1, 1, 1), box(1, 1, 1), R, np.array([[x, 0.3, -0.2]])).tolist() == [expected]
