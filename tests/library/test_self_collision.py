"""Overlaps of robots of the library in sampled poses, against the contacts that MuJoCo finds in the same poses."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Array
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.describing import described_robot
from stepbot.robot.kinematics import Tree
from stepbot.robot.sampling import sampled
from stepbot.verification.self_collision.search import placed, separate_links
from tests.library.conftest import SHORT, Converted, name_of

pytestmark = pytest.mark.slow

LONG = ("rethink_sawyer", "stepbot_hexapod", "stepbot_slider_crank")
"""Further robots whose coordinates are those of MuJoCo: without ball joints."""
POSES = 200
CLEAR = 1e-4
"""Penetration [m] beyond which both must agree; MuJoCo's depth of convex meshes is accurate to about 1e-5 m."""


def penetrations(file: Path, joints: tuple[str, ...], q: Array) -> list[dict[frozenset[str], float]]:
    """For each configuration, the deepest penetration [m] of each pair of links in MuJoCo, negative for a distance."""
    model = mujoco.MjModel.from_xml_path(str(file))
    model.geom_margin[:] = CLEAR
    data = mujoco.MjData(model)
    columns = [model.joint(name).qposadr[0] for name in joints]
    found = []
    for configuration in q:
        data.qpos[columns] = configuration
        mujoco.mj_fwdPosition(model, data)
        pairs: dict[frozenset[str], float] = {}
        for contact in data.contact:
            links = frozenset(model.body(model.geom_bodyid[geom]).name for geom in contact.geom)
            pairs[links] = max(pairs.get(links, -np.inf), -float(contact.dist))
        found.append(pairs)
    return found


@pytest.mark.parametrize("robot", [*SHORT, *(pytest.param(robot, marks=pytest.mark.long) for robot in LONG)])
def test_overlaps_are_the_contacts_of_mujoco(robot: str, converted: Converted) -> None:
    """In each pose, the pairs that overlap are those that penetrate in MuJoCo; pairs within 0.1 mm of contact aside."""
    file = converted(robot).file(".xml")
    described = described_robot(file, Options(Path()), Diagnostics())
    assert described is not None
    layout, q = Tree(described), sampled(described, POSES)
    X = layout.frames(q)
    contacts = penetrations(file, layout.joints, q)
    pairs = list(separate_links(described))
    for pair in pairs:
        overlap = pair.overlapping(placed(layout, X, pair))
        for pose, (found, ours) in enumerate(zip(contacts, overlap, strict=True)):
            depth = found.get(frozenset((pair.a, pair.b)), -np.inf)
            if abs(depth) > CLEAR:
                assert bool(ours) == (depth > 0.0), (pair.a, pair.b, pose, depth)
    assert pairs
    assert name_of(robot) == described.name


NEVER = {
    "universal_robots_ur5e": (
        ("base_link_inertia", "upper_arm_link wrist_1_link"),
        ("shoulder_link", "wrist_1_link wrist_2_link"),
        ("wrist_1_link", "wrist_3_link"),
    ),
    "rethink_sawyer": (
        ("head", "pedestal right_arm_base_link"),
        ("pedestal", "right_l1 screen"),
        ("right_arm_base_link", "right_l1 right_l2 screen"),
        ("screen", "right_l0 right_l1 right_l2 right_l3"),
        ("right_l2", "right_l0 right_l4 right_l5"),
        ("right_l3", "right_l0 right_l1 right_l5 right_l6"),
        ("right_l4", "right_l1 right_l6"),
    ),
}
"""Links that never collide by the SRDF of the maker's description, without links that a joint connects:
ros-industrial/universal_robot, ur5e_moveit_config/config/ur5e.srdf at 7917d497fa4d; RethinkRobotics/sawyer_moveit,
sawyer_base.srdf.xacro at 7930eb6fd49f."""


@pytest.mark.parametrize("robot", ["universal_robots_ur5e", pytest.param("rethink_sawyer", marks=pytest.mark.long)])
def test_links_that_never_collide_by_the_maker_do_not(robot: str, converted: Converted) -> None:
    """In 10,000 random poses none of these pairs overlaps; the drawn pose and q = 0 have no contact in MuJoCo."""
    file = converted(robot).file(".xml")
    described = described_robot(file, Options(Path()), Diagnostics())
    assert described is not None
    never = {frozenset((one, other)) for one, others in NEVER[robot] for other in others.split()}
    layout, q = Tree(described), sampled(described, 10_000)
    X = layout.frames(q)
    pairs = {frozenset((pair.a, pair.b)): pair for pair in separate_links(described)}
    shapeless = {link.name for link in described.links if not link.collisions}
    assert {links for links in never if not links & shapeless} <= pairs.keys()
    overlaps = {
        links: pairs[links].overlapping(placed(layout, X, pairs[links])).sum() for links in never & pairs.keys()
    }
    assert {tuple(sorted(links)): int(count) for links, count in overlaps.items() if count} == {}
    at_zero = penetrations(file, layout.joints, np.zeros((1, len(layout.joints))))
    assert [depth for pairs in at_zero for depth in pairs.values() if depth > 0.0] == []
