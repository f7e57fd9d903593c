"""Heights of robots on floors, against closed forms."""

import math

import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import extent, floor_height, standing_height
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import (
    Base,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Geometry,
    Joint,
    JointKind,
    Link,
    Robot,
    Sphere,
    Visual,
)
from tests.robots import floating_biped, one_link

TILT = 0.4
TILTED = Pose.from_xyz_rpy((0.1, 0.2, 0.3), (TILT, 0.0, 0.0))


def alone(geometry: Geometry, base: Base = Base.FLOATING) -> Robot:
    """A link with one tilted collision shape, and a visual below it that nothing touches."""
    seen = Visual("seen", Box((1.0, 1.0, 9.0)))
    return Robot(
        "alone", (Link("body", collisions=(Collision("shape", geometry, TILTED),), visuals=(seen,)),), base=base
    )


@pytest.mark.parametrize(
    ("geometry", "half"),
    [
        (Box((0.2, 0.4, 0.6)), 0.5 * (0.4 * math.sin(TILT) + 0.6 * math.cos(TILT))),
        (Cylinder(0.1, 0.6), 0.3 * math.cos(TILT) + 0.1 * math.sin(TILT)),
        (Capsule(0.1, 0.6), 0.3 * math.cos(TILT) + 0.1),
        (Sphere(0.25), 0.25),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_floating_shape_touches_the_floor(geometry: Geometry, half: float) -> None:
    """The base's height is that of the lowest point of a tilted collision shape; visuals do not count."""
    assert standing_height(alone(geometry), {}) == pytest.approx(half - 0.3, abs=1e-9)


def test_a_floating_robot_stands_on_its_lowest_vertex_in_each_pose() -> None:
    """The height follows the joints: that of the lowest vertex of all collision meshes, moved by hand."""
    robot = floating_biped()
    heights = set()
    for q in ({}, {joint.name: 0.3 for joint in robot.joints if joint.kind is JointKind.REVOLUTE and not joint.mimic}):
        lowest = min(
            (X @ shape.X_LG).apply(robot.mesh_by_name[shape.geometry.name].mesh.vertices)[:, 2].min()  # type: ignore[union-attr]
            for name, X in link_poses(robot, q).items()
            for shape in robot.link_by_name[name].collisions
        )
        heights.add(standing_height(robot, q))
        assert standing_height(robot, q) == pytest.approx(-lowest, abs=1e-9)
    assert len(heights) == 2


def test_without_collisions_visuals_stand_and_without_shapes_nothing_does() -> None:
    """A robot of visuals stands on them; a fixed base, and a robot without shapes, are at 0."""
    robot = alone(Sphere(0.25))
    assert standing_height(replace(robot, links=(replace(robot.links[0], collisions=()),)), {}) == 4.5
    assert standing_height(Robot("empty", (Link("body"),), base=Base.FLOATING), {}) == 0.0
    assert standing_height(one_link(), {}) == 0.0


def test_the_floor_is_below_the_base_or_below_a_robot_that_hangs() -> None:
    """A fixed robot stands on its fixed links; if a moving link is lower, the floor is its height below it."""
    base = Link("base", collisions=(Collision("foot", Box((0.2, 0.2, 0.2))),))
    arm = Link("arm", collisions=(Collision("rod", Box((0.1, 0.1, 0.4))),))
    up, down = (
        Joint("turn", JointKind.CONTINUOUS, "base", "arm", Pose.of(position=(0, 0, z)), axis=(1.0, 0.0, 0.0))
        for z in (0.3, -0.3)
    )
    standing, hanging = (Robot("arm", (base, arm), (joint,)) for joint in (up, down))
    assert floor_height(standing) == -0.1
    assert floor_height(hanging) == pytest.approx(-0.5 - 0.6)
    assert floor_height(replace(hanging, base=Base.FLOATING)) == 0.0
    center, size = extent(standing)
    assert center == pytest.approx((0.0, 0.0, 0.2))
    assert size == pytest.approx(0.5 * math.sqrt(0.2**2 + 0.2**2 + 0.6**2))
