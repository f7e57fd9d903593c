"""Drawn links of commercial robots against published dimensions, to 10 mm; joint distances are in test_reference.py."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from lxml import etree

from stepbot.geometry.spatial import Array, Pose
from tests.library.conftest import Converted

TOLERANCE = 0.010
"""[m]"""
FRANKA = "franka_description, robots/common/franka_arm.xacro and end_effectors/common/franka_hand.xacro"
MENAGERIE = "mujoco_menagerie, rethink_robotics_sawyer/sawyer.xml: capsules around the maker's meshes"
SAWYER = "sawyer_description/urdf/sawyer_base.urdf.xacro: collision shapes and visuals"
ABB = "data sheet IRB 14000: footprint"

# Lowest and highest coordinate [m] in the link's frame; infinite where nothing is published.
FREE = np.inf
PUBLISHED = (
    ("franka_hand", "fr3_hand", (-0.0315, -0.102, -FREE), (0.0315, 0.102, FREE), "204 mm x 63 mm by the maker"),
    ("franka_hand", "fr3_leftfinger", (-0.011, 0.0, 0.0003), (0.011, 0.026, 0.0545), FRANKA),
    ("franka_panda", "fer_link5", (-0.060, -0.060, -FREE), (0.060, 0.105, FREE), FRANKA),
    ("franka_panda", "fer_link6", (-0.050, -0.050, -FREE), (FREE, 0.050, FREE), FRANKA),
    ("franka_panda", "fer_link7", (-0.040, -0.040, -FREE), (0.076, 0.076, 0.107), FRANKA),
    ("rethink_sawyer", "right_l1", (-0.068, -FREE, -FREE), (0.068, 0.068, 0.198), MENAGERIE),
    ("rethink_sawyer", "right_l2", (-0.055, -0.055, -FREE), (0.055, 0.055, 0.315), MENAGERIE),
    ("rethink_sawyer", "right_l3", (-0.055, -FREE, -0.170), (0.055, 0.055, FREE), MENAGERIE),
    ("rethink_sawyer", "right_l4", (-0.045, -0.045, -FREE), (0.045, 0.045, 0.315), MENAGERIE),
    ("rethink_sawyer", "right_l5", (-0.045, -FREE, -FREE), (0.045, 0.045, 0.145), MENAGERIE),
    ("rethink_sawyer", "right_l6", (-0.045, -0.045, -0.020), (0.045, 0.045, 0.020), MENAGERIE),
    ("rethink_sawyer", "head", (-FREE, -0.130, -FREE), (FREE, 0.130, FREE), MENAGERIE),
    ("rethink_sawyer", "screen", (-0.120, -0.070, -FREE), (0.120, 0.070, FREE), SAWYER),
    ("rethink_sawyer", "pedestal", (-0.5075, -0.350, -0.913), (0.2625, 0.350, FREE), SAWYER),
    ("abb_yumi", "yumi_body", (-0.2295, -0.2485, 0.0), (0.1695, 0.2485, FREE), ABB),
)


@pytest.mark.long
@pytest.mark.parametrize(
    ("robot", "link", "low", "high", "source"), [pytest.param(*row, id=f"{row[0]}/{row[1]}") for row in PUBLISHED]
)
def test_bounding_boxes_are_the_published_ones(
    robot: str,
    link: str,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    source: str,
    converted: Converted,
) -> None:
    """The bounding box of the meshes of a link, in its frame, is the published one to 10 mm, where one is published."""
    points = _points(converted(robot).file(".urdf"), link)
    for found, published in ((points.min(axis=0), np.array(low)), (points.max(axis=0), np.array(high))):
        known = np.isfinite(published)
        np.testing.assert_allclose(found[known], published[known], atol=TOLERANCE, err_msg=source)


def _points(urdf: Path, link: str) -> Array:
    """Vertices (n, 3) [m] of the visual meshes of a link, in its frame."""
    found = []
    for visual in etree.parse(urdf).getroot().findall(f"link[@name='{link}']/visual"):
        mesh, origin = visual.find("geometry/mesh"), visual.find("origin")
        assert mesh is not None
        given = {} if origin is None else origin.attrib
        xyz, rpy = ([float(word) for word in given.get(name, "0 0 0").split()] for name in ("xyz", "rpy"))
        file = urdf.parent / "meshes" / mesh.attrib["filename"].rpartition("/")[2]
        found.append(Pose.from_xyz_rpy(xyz, rpy).apply(trimesh.load_mesh(file, process=False).vertices))
    return np.concatenate(found)
