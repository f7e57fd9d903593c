"""URDF files read by yourdfpy and PyBullet, against the written robot."""

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.kinematics import configurations, link_poses
from stepbot.robot.model import JointKind
from stepbot.robot.sensors import SensorKind
from tests.conformance.conftest import Write
from tests.devices import equipped
from tests.processes import call_isolated
from tests.robots import ROBOTS, every_robot


@every_robot
def test_yourdfpy_reads_links_and_joints(name: str, write: Write) -> None:
    """yourdfpy reads mass, centre of mass, inertia, kinds, limits, dynamics and mimics to the last bit."""
    import yourdfpy

    robot, file = write(name, "urdf")
    read = yourdfpy.URDF.load(str(file))
    assert list(read.link_map) == [link.name for link in robot.links]
    for link in robot.links:
        inertial, mass = read.link_map[link.name].inertial, link.mass_properties
        origin = np.eye(4) if inertial.origin is None else inertial.origin
        assert (inertial.mass, *origin[:3, 3]) == (mass.mass, *mass.com)
        np.testing.assert_array_equal(origin[:3, :3], np.eye(3))
        np.testing.assert_array_equal(inertial.inertia, mass.inertia)
        colors = [tuple(visual.material.color.rgba) for visual in read.link_map[link.name].visuals]
        assert colors == [visual.rgba for visual in link.visuals]
    assert list(read.joint_map) == [joint.name for joint in robot.joints]
    for joint in robot.joints:
        seen = read.joint_map[joint.name]
        assert (seen.type, seen.parent, seen.child) == (joint.kind.value, joint.parent, joint.child)
        if joint.kind in (JointKind.REVOLUTE, JointKind.PRISMATIC):
            limit = joint.limit
            numbers = (seen.limit.lower, seen.limit.upper, seen.limit.effort, seen.limit.velocity)
            assert numbers == (limit.lower, limit.upper, limit.effort, limit.velocity)
            assert np.isfinite(numbers).all()
        if joint.dynamics.damping:
            # yourdfpy keeps them as text, and omits missing ones
            numbers = (float(seen.dynamics.damping or 0.0), float(seen.dynamics.friction or 0.0))
            assert numbers == (joint.dynamics.damping, joint.dynamics.friction)
        if joint.mimic:
            mimic = (seen.mimic.joint, seen.mimic.multiplier, seen.mimic.offset)
            assert mimic == (joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset)


@every_robot
def test_yourdfpy_puts_links_where_the_robot_has_them(name: str, write: Write) -> None:
    """Poses of all links, with mimics, agree at random configurations."""
    import yourdfpy

    robot, file = write(name, "urdf")
    read = yourdfpy.URDF.load(str(file), load_meshes=False)
    for q in configurations(robot, 8):
        read.update_cfg({joint: q[joint] for joint in read.actuated_joint_names})
        for link, X_WL in link_poses(robot, q).items():
            np.testing.assert_allclose(read.get_transform(link, robot.root.name), X_WL.matrix, atol=1e-9)


@pytest.mark.pybullet
@every_robot
def test_pybullet_reads_the_file(name: str, write: Write) -> None:
    """PyBullet finds every mesh and agrees on mass, inertia and poses to its precision."""
    pytest.importorskip("pybullet")
    robot, file = write(name, "urdf")
    places = configurations(robot, 4)
    seen = call_isolated("tests.conformance.pybullet_numbers:read", str(file), places, timeout=120)
    assert seen["complaints"] == []
    assert set(seen["links"]) == set(robot.link_by_name)
    for link, (mass, com, inertia) in seen["links"].items():
        expected = robot.link_by_name[link].mass_properties
        assert mass == pytest.approx(expected.mass, rel=1e-9)
        np.testing.assert_allclose(com, expected.com, atol=1e-6)
        scale = np.abs(expected.inertia).max() or 1.0
        np.testing.assert_allclose(inertia, expected.inertia, atol=1e-6 * scale)
    for q, poses in zip(places, seen["poses"], strict=True):
        for link, X_WL in link_poses(robot, q).items():
            np.testing.assert_allclose(poses[link], X_WL.matrix, atol=1e-6)


def test_frames_weigh_nothing(write: Write) -> None:
    """A frame is a link with zero inertia on a fixed joint, at its pose."""
    robot, file = write("two_link_arm", "urdf")
    tool = robot.link_by_name["tool0"]
    assert tool.mass_properties == MassProperties()
    top = etree.parse(str(file)).getroot()
    joint = next(joint for joint in top.findall("joint") if joint.find("child").get("link") == "tool0")
    assert joint.get("type") == "fixed"
    origin = joint.find("origin")
    X = Pose.from_xyz_rpy(*(list(map(float, origin.get(key).split())) for key in ("xyz", "rpy")))
    assert X.distance_to(ROBOTS["two_link_arm"]().frames[0].X_LF) == pytest.approx((0, 0), abs=1e-12)
    inertial = next(link for link in top.findall("link") if link.get("name") == "tool0").find("inertial")
    assert inertial.find("mass").get("value") == "0"
    assert set(inertial.find("inertia").attrib.values()) == {"0"}


@pytest.mark.slow
def test_every_material_has_a_name_of_its_own(write: Write) -> None:
    """No two visuals share a material name, for which readers would use the first colour."""
    for name in ROBOTS:
        _, file = write(name, "urdf")
        materials = [material.get("name") for material in etree.parse(str(file)).iter("material")]
        assert len(materials) == len(set(materials))


@pytest.mark.slow
def test_no_link_is_the_world(write: Write) -> None:
    """The root link is the robot's root, not a link named world."""
    for name in ROBOTS:
        robot, file = write(name, "urdf")
        top = etree.parse(str(file)).getroot()
        children = {child.get("link") for child in top.iter("child")}
        roots = [link.get("name") for link in top.findall("link") if link.get("name") not in children]
        assert roots == [robot.root.name]


@pytest.mark.parametrize("kind", [SensorKind.FORCE_TORQUE, SensorKind.CONTACT, SensorKind.IMU])
def test_gazebo_keeps_fixed_joints_with_sensors(kind: SensorKind) -> None:
    """It merges others: a cell measures at its joint, and a contact sensor names shapes of the link below."""
    robot = equipped()
    robot = replace(robot, sensors=tuple(sensor for sensor in robot.sensors if sensor.kind is kind))
    top = etree.fromstring(render(robot, "urdf", Diagnostics())["equipped.urdf"])
    kept = [block.get("reference") for block in top.findall("gazebo") if block.findtext("preserveFixedJoint") == "true"]
    assert [name for name in kept if name in robot.joint_by_name] == ["flange"] * (kind is not SensorKind.IMU)
    springs = [block.get("reference") for block in top.findall("gazebo") if block.find("springStiffness") is not None]
    assert springs == ["shoulder"]
