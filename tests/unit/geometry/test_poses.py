"""Many poses at once, against one pose after the other."""

import numpy as np

from stepbot.geometry.inertia import Bodies, MassProperties, combined
from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import Pose, shift_inertia, tidy
from stepbot.robot.bounding_boxes import mesh_bounds


def some_poses(count: int) -> list[Pose]:
    """Poses at random, every third one of an earlier rotation."""
    random = np.random.default_rng(7)
    poses = [Pose.from_xyz_rpy(random.normal(size=3), random.normal(size=3)) for _ in range(count)]
    return [Pose(poses[i // 3].rotation, pose.position) if i % 3 == 0 else pose for i, pose in enumerate(poses)]


def test_every_pose_is_that_of_one_alone() -> None:
    """Products and tidy poses have the same bits as those of single poses."""
    poses = some_poses(50)
    X = poses[-1].inverse()
    assert Poses.of(poses).listed() == poses
    assert Poses.of(poses).seen_from(X).listed() == [X @ pose for pose in poses]
    assert Poses.of(poses).seen_from(X).tidy().listed() == [tidy(X @ pose) for pose in poses]


def test_points_of_each_frame() -> None:
    """A point of each frame has the same coordinates as with its pose alone."""
    poses, points = some_poses(20), np.random.default_rng(8).normal(size=(20, 3))
    moved = Poses.of(poses).apply(points)
    np.testing.assert_array_equal(moved, [pose.apply(point) for pose, point in zip(poses, points, strict=True)])


def test_bounds_at_each_pose() -> None:
    """The box of points at each pose is that of the moved points."""
    poses, points = some_poses(20), np.random.default_rng(9).normal(size=(100, 3))
    low, high = bounds_at(points, Poses.of(poses))
    expected = [mesh_bounds(points, pose) for pose in poses]
    np.testing.assert_array_equal(np.stack([low, high], axis=1), expected)


def test_distances_are_those_of_each_pair() -> None:
    """Positions and angles differ by the same bits, equal poses and opposite ones among them."""
    poses, about_x = some_poses(30), Pose.from_xyz_rpy((0.0, 0.0, 0.0), (np.pi, 0.0, 0.0))
    others = [poses[0], poses[1] @ about_x, *reversed(poses[2:])]
    expected = [pose.distance_to(other) for pose, other in zip(poses, others, strict=True)]
    assert Poses.of(poses).distances_to(Poses.of(others)) == expected


def test_no_pose() -> None:
    """There may be no pose at all."""
    assert Poses.of([]).distances_to(Poses.of([])) == []
    assert Poses.of([]).seen_from(some_poses(1)[0]).tidy().listed() == []


def test_bodies_are_those_moved_one_by_one() -> None:
    """Scaled and moved as arrays, bodies have the same bits, and their sum that of a sum in their order."""
    random = np.random.default_rng(10)
    poses = some_poses(40)
    bodies = []
    for _ in poses:
        root = random.normal(size=(3, 3))
        bodies.append(MassProperties.of(float(random.uniform(0.1, 2.0)), random.normal(size=3).tolist(), root @ root.T))
    factors = random.uniform(0.5, 2.0, size=len(poses))
    moved = [b.scaled(f).moved(X) for b, f, X in zip(bodies, factors.tolist(), poses, strict=True)]
    together = Bodies.of(bodies).scaled(factors).moved(Poses.of(poses))
    assert together.mass.tolist() == [body.mass for body in moved]
    assert together.com.tolist() == [list(body.com) for body in moved]
    assert together.inertia.tolist() == [[list(row) for row in body.inertia] for body in moved]
    whole = together.combined()
    assert combined(moved) == whole
    com, inertia = np.zeros(3), np.zeros((3, 3))
    for body in moved:
        com = com + body.mass * np.array(body.com)
    com = com / whole.mass
    for body in moved:
        inertia = inertia + shift_inertia(body.inertia, body.mass, np.array(body.com) - com)
    assert whole == MassProperties.of(whole.mass, com.tolist(), inertia)
