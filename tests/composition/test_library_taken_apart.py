"""Robots of the library, taken apart into modules, compose back to themselves; mirrored limbs are the drawn ones."""

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.compose.mirroring import NORMALS, mirrored
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.stages import convert, produce
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import MeshRef, Robot
from stepbot.runtime.cache import Cache

from . import described


@pytest.fixture
def of_library(robot_library: Path, cache: Cache, tmp_path: Path) -> Callable[[str], Robot]:
    """A robot of the library, by its sidecar, as it is converted without verification."""

    def made(sidecar: str) -> Robot:
        options = Options(tmp_path, ("mjcf",), verify=False, cache=cache)
        robot = produce(robot_library / f"{sidecar}.robot.yaml", options).robot
        assert robot is not None
        return robot

    return made


def same_robot(composed: Robot, drawn: Robot, *, com: float, inertia: float) -> None:
    """Every link and joint of the composed robot is that of the drawn one: place, mass properties, axis, limits."""
    poses = link_poses(composed, initial_configuration(composed)), link_poses(drawn, initial_configuration(drawn))
    for link in composed.links:
        theirs = drawn.link_by_name[link.name].mass_properties
        distance, angle = poses[0][link.name].distance_to(poses[1][link.name])
        assert distance < 1e-11, link.name
        assert angle < 1e-11, link.name
        assert link.mass_properties.mass == pytest.approx(theirs.mass, rel=1e-7), link.name
        assert np.allclose(link.mass_properties.com, theirs.com, rtol=0.0, atol=com), link.name
        assert np.allclose(link.mass_properties.inertia, theirs.inertia, rtol=0.0, atol=inertia), link.name
    for joint in composed.joints:
        there = drawn.joint_by_name[joint.name]
        assert (joint.kind, joint.parent, joint.child) == (there.kind, there.parent, there.child)
        assert joint.axis == pytest.approx(there.axis, abs=1e-12), joint.name
        assert (joint.limit.lower, joint.limit.upper) == pytest.approx((there.limit.lower, there.limit.upper)), (
            joint.name
        )
        assert (joint.limit.effort, joint.limit.velocity) == (there.limit.effort, there.limit.velocity)
        assert joint.dynamics == there.dynamics
        assert joint.drawn_position == pytest.approx(there.drawn_position, abs=1e-12), joint.name
        assert joint.mimic == there.mimic


@pytest.mark.slow
def test_quadruped_of_one_leg_is_the_drawn_one(of_library: Callable[[str], Robot]) -> None:
    """A leg and its mirror image, twice, on joints of the composing file: all is as drawn, and stands as high."""
    dog, drawn = of_library("composed/dog"), of_library("stepbot_quadruped/quadruped")
    same_robot(dog, drawn, com=1e-7, inertia=1e-8)
    assert {one.name: (one.kp, one.kv) for one in dog.actuators} == {
        one.name: (one.kp, one.kv) for one in drawn.actuators
    }
    feet = []
    for robot in (dog, drawn):
        poses = link_poses(robot, initial_configuration(robot))
        places = {one.name: poses[one.link] @ one.X_LF for one in robot.frames if one.name.endswith("_foot")}
        feet.append({name: pose.position for name, pose in sorted(places.items())})
    assert list(feet[0]) == list(feet[1])
    assert np.allclose(list(feet[0].values()), list(feet[1].values()), rtol=0.0, atol=1e-9)
    assert np.ptp([place[2] for place in feet[0].values()]) < 1e-9
    heights = [standing_height(robot, initial_configuration(robot)) for robot in (dog, drawn)]
    assert heights[0] == pytest.approx(heights[1], abs=1e-9)
    assert [(one.name, one.mirror, one.at) for one in dog.modules] == [
        ("front_left", "", "trunk"),
        ("front_right", "y", "trunk"),
        ("rear_left", "", "trunk"),
        ("rear_right", "y", "trunk"),
    ]


@pytest.mark.slow
def test_meshes_of_a_mirrored_leg(of_library: Callable[[str], Robot]) -> None:
    """Symmetric parts share their meshes; the others have new ones that enclose their volume from outside."""
    dog = of_library("composed/dog")
    left, right = (
        {
            one.geometry.name
            for link in dog.links
            if link.name.startswith(leg)
            for one in link.visuals
            if isinstance(one.geometry, MeshRef)
        }
        for leg in ("front_left", "front_right")
    )
    assert {"knee_pin", "cap", "lid", "knee_drive"} <= left & right
    images = [asset for asset in dog.meshes if asset.name in right - left]
    assert {asset.name for asset in images} == {f"{name}_mirrored" for name in left - right}
    for asset in images:
        a, b, c = asset.mesh.vertices[asset.mesh.faces].transpose(1, 0, 2)
        assert np.einsum("ni,ni->", a, np.cross(b, c)) > 0.0, asset.name


@pytest.mark.slow
def test_mirrored_arm_is_the_drawn_one(of_library: Callable[[str], Robot]) -> None:
    """An arm of nine joints with a mimic and one-sided limits, its image against the right arm drawn in the CAD."""
    body, drawn = of_library("composed/body"), of_library("stepbot_upper_body/upper_body")
    same_robot(_at_zero(body), _at_zero(drawn), com=3e-9, inertia=1e-7)


def _at_zero(robot: Robot) -> Robot:
    return replace(robot, joints=tuple(replace(joint, drawn_position=0.0) for joint in robot.joints))


@pytest.mark.slow
@pytest.mark.parametrize("normal", NORMALS)
def test_mirrored_twice_is_the_robot(normal: str, of_library: Callable[[str], Robot]) -> None:
    """Links and joints bit for bit; places of shared meshes within rounding."""
    robot = of_library("stepbot_quadruped/quadruped")
    twice = mirrored(mirrored(robot, normal), normal)
    assert twice.joints == robot.joints
    assert twice.frames == robot.frames
    assert [asset.name for asset in twice.meshes] == [asset.name for asset in robot.meshes]
    for ours, theirs in zip(twice.meshes, robot.meshes, strict=True):
        assert np.array_equal(ours.mesh.vertices, theirs.mesh.vertices)
        assert np.array_equal(ours.mesh.faces, theirs.mesh.faces)
    for link, former in zip(twice.links, robot.links, strict=True):
        assert link.mass_properties == former.mass_properties
        for shape, before in zip(link.shapes, former.shapes, strict=True):
            assert shape.geometry == before.geometry
            assert np.allclose(shape.X_LG.matrix, before.X_LG.matrix, rtol=0.0, atol=1e-12)


INERTIAL = "inertial: {mass: 1, com: [0.01, 0.02, 0.03], inertia: {ixx: 0.01, iyy: 0.02, izz: 0.025, ixy: 0.003}}"
ORIGIN = "origin: {xyz: [0.1, 0.2, 0.3], rpy: [0.3, 0.2, 0.1], relative_to: %s}"
KINDS = {
    "ball": "",
    "universal": ", axis: [0.6, 0, 0.8], axis2: [0, 1, 0]",
    "cylindrical": ", axis: [0.6, 0, 0.8]",
    "planar": ", axis: [0.48, 0.6, 0.64]",
    "screw": ", axis: [0.6, 0, 0.8], pitch: 10 mm/rev, limits: {lower: -3, upper: 3, effort: 1, velocity: 1}",
}


@pytest.fixture(scope="module")
def mirrored_pair(tmp_path_factory: pytest.TempPathFactory) -> Conversion:
    """A chain of joints of all kinds and its mirror image, proven in all engines that are installed."""
    folder = tmp_path_factory.mktemp("kinds")
    (folder / "palm.urdf").write_text(described.urdf("palm", described.link("palm")), encoding="utf-8")
    links = "".join(f"  {kind}_link: {{{INERTIAL}}}\n" for kind in KINDS)
    joints, above = "", "palm/palm"
    for kind, settings in KINDS.items():
        origin = f", {ORIGIN % above}" if "/" not in above else ""
        joints += f"  {kind}: {{type: {kind}, parent: {above}, child: {kind}_link{origin}{settings}}}\n"
        above = f"{kind}_link"
    hand = described.composing("palm: {file: palm.urdf, prefix: ''}", more=f"links:\n{links}joints:\n{joints}")
    (folder / "hand.robot.yaml").write_text(hand, encoding="utf-8")
    pair = described.composing(
        "left: {file: hand.robot.yaml}", "right: {mirror_of: left, at: left/palm, flip: [screw]}"
    )
    (folder / "pair.robot.yaml").write_text(pair, encoding="utf-8")
    made = convert(folder / "pair.robot.yaml", Options(folder / "out", ("urdf", "sdf", "mjcf")))
    assert not made.diagnostics.has_errors, [str(one) for one in made.diagnostics if one.severity == "error"]
    return made


@pytest.mark.slow
def test_joints_of_several_degrees_of_freedom_are_mirrored(mirrored_pair: Conversion) -> None:
    """Every engine that reads their types, or what they are written as, has the image at the image, mimics included."""
    assert mirrored_pair.report is not None
    of_image = [one for one in mirrored_pair.report.checks if one.against == "module 'right' alone"]
    passed = {(one.engine, one.format) for one in of_image if one.quantity == "poses" and one.status == "passed"}
    assert passed >= {("mujoco", "urdf"), ("mujoco", "mjcf"), ("pybullet", "urdf"), ("reader", "sdf"), ("stepbot", "")}
    assert ("mujoco", "mimic") in {(one.engine, one.quantity) for one in of_image if one.status == "passed"}
    assert {one.status for one in of_image} == {"passed"}


@pytest.mark.slow
def test_mujoco_mirrors_a_ball_joint(mirrored_pair: Conversion) -> None:
    """The rotation of a ball about any axis has the reflected pseudovector as its image's, by MuJoCo alone."""
    model = mujoco.MjModel.from_xml_string(mirrored_pair.files["whole.xml"].decode())
    data, random = mujoco.MjData(model), np.random.default_rng(5)
    quaternion = random.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    for side, signs in (("left", (1, 1, 1, 1)), ("right", (1, -1, 1, -1))):
        at = int(model.joint(f"{side}_ball").qposadr[0])
        data.qpos[at : at + 4] = quaternion * signs
    for name in ("universal_1", "universal_2"):
        for side in ("left", "right"):
            data.qpos[model.joint(f"{side}_{name}").qposadr[0]] = 0.7
    mujoco.mj_kinematics(model, data)
    M = np.diag([1.0, -1.0, 1.0])
    for name in ("ball_link", "universal_link", "screw_link"):
        left, right = (data.body(f"{side}_{name}") for side in ("left", "right"))
        assert np.allclose(right.xpos, M @ left.xpos, rtol=0.0, atol=1e-12), name
        assert np.allclose(right.xmat.reshape(3, 3), M @ left.xmat.reshape(3, 3) @ M, rtol=0.0, atol=1e-12), name
