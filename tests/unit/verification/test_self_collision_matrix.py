"""Classes of pairs of links, against shares of ranges in closed form."""

from math import acos, asin, atan2, hypot, pi, sqrt

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import (
    Box,
    Capsule,
    Collision,
    Geometry,
    Joint,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Mimic,
    Robot,
    Sphere,
)
from stepbot.robot.self_collision import PairClass, PairContact
from stepbot.verification.self_collision.search import LinkPair, matrix
from stepbot.verification.self_collision.shapes import Pair, shapes_of

SAMPLES = 10_000
SIGMAS = 4.0
"""Standard deviations of a share that random poses may deviate by: one seed in 16,000 does."""
TURN = Limit(-pi, pi)


def robot(
    fixed: Geometry | TriMesh,
    moving: Geometry | TriMesh,
    *,
    at: tuple[float, float, float] = (0, 0, 0),
    kind: JointKind = JointKind.REVOLUTE,
    axis: tuple[float, float, float] = (0, 0, 1),
    limit: Limit = TURN,
) -> Robot:
    """A base with a shape at ``at``, and a bar that moves about or along ``axis``, with an empty link in between."""
    meshes = []

    def collision(name: str, shape: Geometry | TriMesh, X: Pose) -> Collision:
        if isinstance(shape, TriMesh):
            meshes.append(MeshAsset(name, shape))
            return Collision(name, MeshRef(name), X)
        return Collision(name, shape, X)

    links = (
        Link("base", collisions=(collision("wall", fixed, Pose.of(position=at)),)),
        Link("between"),
        Link("bar", collisions=(collision("bar", moving, IDENTITY),)),
    )
    joints = (
        Joint("still", JointKind.REVOLUTE, "base", "between", limit=Limit(0.0, 0.0)),
        Joint("turn", kind, "between", "bar", axis=axis, limit=limit),
    )
    return Robot("pair", links, joints, meshes=tuple(meshes))


def mesh(*size: float) -> TriMesh:
    """A box as a mesh."""
    box = trimesh.creation.box(extents=size)
    return TriMesh.of(box.vertices, box.faces)


def the_pair(robot: Robot, samples: int = SAMPLES) -> PairContact:
    """The one pair of a robot."""
    (pair,) = matrix(robot, samples).pairs
    return pair


def assert_share(pair: PairContact, share: float) -> None:
    """The contacts are as many as a share of the range gives."""
    deviation = SIGMAS * sqrt(share * (1.0 - share) / SAMPLES)
    assert pair.kind is PairClass.SOMETIMES
    assert pair.contacts / SAMPLES == pytest.approx(share, abs=deviation)


def test_a_capsule_that_turns_past_a_sphere() -> None:
    """A capsule around the origin meets a sphere at distance d while d |sin q| < r + R, at both of its ends."""
    d, radius, tip = 0.5, 0.05, 0.1
    capsule = robot(Sphere(radius), Box((1, 1, 1)), at=(d, 0, 0))
    along_x = Collision("bar", Capsule(tip, 1.0), Pose.from_xyz_rpy((0, 0, 0), (0, pi / 2, 0)))
    capsule = replace(capsule, links=(*capsule.links[:2], Link("bar", collisions=(along_x,))))
    assert_share(the_pair(capsule), 4.0 * asin((radius + tip) / d) / (2.0 * pi))


@pytest.mark.parametrize("as_mesh", [False, True])
def test_a_bar_that_turns_into_a_wall(*, as_mesh: bool) -> None:
    """A bar 2 h by w meets a wall at x = d while one of its corners is beyond: |q| < atan(w / 2 h) + acos(d / R)."""
    h, w, d = 0.5, 0.1, 0.45
    bar: Geometry | TriMesh = mesh(2 * h, w, 0.1) if as_mesh else Box((2 * h, w, 0.1))
    wall: Geometry | TriMesh = mesh(0.2, 4.0, 1.0) if as_mesh else Box((0.2, 4.0, 1.0))
    widest = atan2(w / 2, h) + acos(d / hypot(h, w / 2))
    assert_share(the_pair(robot(wall, bar, at=(d + 0.1, 0, 0))), 4.0 * widest / (2.0 * pi))


@pytest.mark.slow
def test_a_hollow_mesh_is_no_solid() -> None:
    """A cube that slides through a cage of two plates overlaps the plates only: surfaces, whose hull is always met."""
    plates = trimesh.util.concatenate(
        [trimesh.creation.box(extents=(0.1, 1, 1)).apply_translation((x, 0, 0)) for x in (-0.5, 0.5)]
    )
    cage = TriMesh.of(plates.vertices, plates.faces)
    slider = robot(cage, Box((0.1, 0.1, 0.1)), kind=JointKind.PRISMATIC, axis=(1, 0, 0), limit=Limit(-0.5, 0.5))
    assert_share(the_pair(slider), 2 * 0.1 / 1.0)  # from where the faces meet, 0.1 m before a limit, to the limit


def test_the_first_pose_and_its_depth_are_the_evidence() -> None:
    """A block that slides into another overlaps as deep as its position says, in the pose that is named."""
    slider = robot(Box((1, 1, 1)), Box((1, 1, 1)), kind=JointKind.PRISMATIC, axis=(1, 0, 0), limit=Limit(0.8, 1.2))
    pair = the_pair(slider)
    position = dict(pair.pose)["turn"]
    assert pair.first is not None
    assert position < 1.0
    assert pair.depth == pytest.approx(1.0 - position, abs=1e-6)
    drawn = replace(slider.joints[1], drawn_position=0.9)
    pair = the_pair(replace(slider, joints=(slider.joints[0], drawn)))
    assert (pair.first, dict(pair.pose)) == (0, {"still": 0.0, "turn": 0.9})
    assert pair.depth == pytest.approx(0.1, abs=1e-6)


@pytest.mark.slow
def test_always_and_never() -> None:
    """Coaxial bars overlap in every pose; bars on different levels in none, nor do bars that only touch."""
    bar = Box((1.0, 0.1, 0.1))
    assert the_pair(robot(bar, bar)).kind is PairClass.ALWAYS
    assert the_pair(robot(bar, bar)).contacts == SAMPLES
    assert the_pair(robot(bar, bar, at=(0, 0, 0.2))) == PairContact("base", "bar", PairClass.NEVER)
    assert the_pair(robot(bar, bar, at=(0, 0, 0.1))).kind is PairClass.NEVER


def test_a_solid_inside_a_surface_overlaps() -> None:
    """A block inside a part of a non-convex mesh overlaps, without a depth."""
    boxes = [trimesh.creation.box(extents=(1, 1, 1)).apply_translation((x, 0, 0)) for x in (0, 3)]
    two = trimesh.util.concatenate(boxes)
    pair = the_pair(robot(TriMesh.of(two.vertices, two.faces), Box((0.2, 0.2, 0.2))), 50)
    assert (pair.kind, pair.depth) == (PairClass.ALWAYS, None)


def test_adjacent_links_are_not_compared() -> None:
    """Links that a joint or a closure connects are adjacent, however often they overlap."""
    bar = Box((1.0, 0.1, 0.1))
    direct = robot(bar, bar)
    joints = (direct.joints[0], replace(direct.joints[1], parent="base"))
    assert the_pair(replace(direct, joints=joints)) == PairContact("base", "bar", PairClass.ADJACENT)
    pin = LoopClosure("pin", JointKind.REVOLUTE, "base", IDENTITY, "bar", IDENTITY)
    assert the_pair(replace(direct, closures=(pin,)), 10).kind is PairClass.ADJACENT


def test_mimics_follow() -> None:
    """Two jaws that mimic each other never meet, although each alone reaches where the other has been."""
    block = Box((0.1, 0.1, 0.1))
    limit, axis = Limit(0.06, 0.2), (1.0, 0.0, 0.0)
    links = (
        Link("palm"),
        Link("left", collisions=(Collision("left", block),)),
        Link("right", collisions=(Collision("right", block),)),
    )
    joints = (
        Joint("left", JointKind.PRISMATIC, "palm", "left", axis=axis, limit=limit, drawn_position=0.1),
        Joint("right", JointKind.PRISMATIC, "palm", "right", axis=axis, limit=Limit(-0.2, -0.06)),
    )
    mirrored = replace(joints[1], mimic=Mimic("left", -1.0), drawn_position=-0.1)
    jaws = Robot("jaws", links, (joints[0], mirrored))
    assert the_pair(jaws).kind is PairClass.NEVER
    alone = replace(jaws, joints=(joints[0], replace(joints[1], limit=limit, drawn_position=0.2)))
    share = 1.0 - (1.0 - 0.1 / 0.14) ** 2  # |a - b| < 0.1 for both uniform over 0.14
    assert_share(the_pair(alone), share)


@pytest.mark.slow
def test_many_shapes_are_as_one() -> None:
    """A bar of ten pieces has the contacts of the bar in one piece, in the same poses."""
    wall, one = Box((0.2, 4.0, 1.0)), robot(Box((0.2, 4.0, 1.0)), Box((1.0, 0.1, 0.1)), at=(0.55, 0, 0))
    pieces = tuple(
        Collision(f"bar {i}", Box((0.1, 0.1, 0.1)), Pose.of(position=(x, 0, 0)))
        for i, x in enumerate(np.linspace(-0.45, 0.45, 10))
    )
    parts = robot(wall, Sphere(0.1), at=(0.55, 0, 0))
    parts = replace(parts, links=(*parts.links[:2], Link("bar", collisions=pieces)))
    a, b = the_pair(one), the_pair(parts)
    assert (a.contacts, a.first, a.pose) == (b.contacts, b.first, b.pose)


def test_many_shapes_at_many_poses_overlap_as_each_pair_does() -> None:
    """Spheres and boxes around shapes exclude nothing that python-fcl finds when it compares every pair of shapes."""
    ball, brick = Sphere(0.02), mesh(0.03, 0.02, 0.05)
    places = [Pose.from_xyz_rpy((0.03 * i, 0.01 * (i % 3), 0.0), (0.3 * i, 0.2, 0.1)) for i in range(6)]
    mixed = [ball, Box((0.02, 0.03, 0.04)), MeshRef("brick"), Capsule(0.01, 0.04), ball, ball]
    given = {"a": [ball] * 6, "b": [ball] * 6, "c": mixed}
    links = tuple(
        Link(name, collisions=tuple(Collision(f"{name}{X.p}", one, X) for one, X in zip(those, places, strict=True)))
        for name, those in given.items()
    )
    shapes = shapes_of(Robot("r", links, meshes=(MeshAsset("brick", brick),)))
    random = np.random.default_rng(5)
    R = np.array([Pose.from_xyz_rpy((0, 0, 0), rpy).R for rpy in random.uniform(-pi, pi, (200, 3))])
    p = random.uniform(-0.08, 0.12, (200, 3))
    for a, b in (("a", "b"), ("a", "c"), ("c", "b")):
        pair = LinkPair(a, b, shapes[a], shapes[b])
        one_by_one = [Pair(x, y) for x in shapes[a] for y in shapes[b]]
        expected = [any(one.deepest(*X) is not None for one in one_by_one) for X in zip(R, p, strict=True)]
        assert pair.overlapping((R, p)).tolist() == expected
        assert 20 < expected.count(True) < 180
        for X in zip(R[:40], p[:40], strict=True):
            depths = [found[0] for one in one_by_one if (found := one.deepest(*X)) is not None]
            assert pair.depth(*X) == max(depths, default=None)
