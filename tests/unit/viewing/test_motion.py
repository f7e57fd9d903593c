"""What the page needs to move a robot."""

from math import inf

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Limit, MeshRef, Robot
from stepbot.viewing.connections import motion_document
from tests.robots import ROBOTS


def diagonal(robot: Robot, links: tuple[str, ...]) -> float:
    """Of the box around the meshes of links, in the frame of the root."""
    poses = link_poses(robot, initial_configuration(robot))
    corners = []
    for name in links:
        for one in robot.link_by_name[name].visuals:
            assert isinstance(one.geometry, MeshRef)
            vertices = robot.mesh_by_name[one.geometry.name].mesh.vertices
            corners.append((poses[name] @ one.X_LG).apply(vertices))
    points = np.concatenate(corners)
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def ranges(robot: Robot) -> dict[str, list[float]]:
    """The ranges of all sliders."""
    return {one["name"]: one["range"] for one in motion_document(robot)["driven"]}


def test_a_slide_without_limits_goes_as_far_as_its_links_are_large() -> None:
    """A missing limit of a slide is the size of its two links away from the other limit or from the drawn position."""
    robot = ROBOTS["slider"]()
    both = diagonal(robot, ("rail", "carriage"))
    assert ranges(robot)["slide"] == pytest.approx([-both, 0.25])
    assert ranges(robot)["lift"] == [-0.02, 0.1]
    slide, lift = robot.joints
    free = replace(robot, joints=(slide, replace(lift, limit=Limit(-inf, inf))))
    ram = diagonal(robot, ("carriage", "ram"))
    assert ranges(free)["lift"] == pytest.approx([-ram, ram])
    assert ram < 0.25
