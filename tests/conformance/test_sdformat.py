"""SDFormat: the content of the text, and PyBullet's reading of its tree."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.kinematics import configurations, initial_configuration, link_poses
from stepbot.robot.model import Base, JointKind, Limit, Mimic, Robot
from tests.conformance.conftest import Write
from tests.processes import call_isolated
from tests.robots import ROBOTS, every_robot, four_bar, four_bar_with_zeros

UNKNOWN_TO_PYBULLET = ("ball", "universal", "screw", "left_screw", "floating", "stewart", "delta")
"""Robots with joints that PyBullet does not read in SDFormat."""


def model_of(file: Path) -> Any:
    """The model element."""
    return etree.parse(str(file)).getroot().find("model")


def pose_of(element: Any) -> Pose:
    """The pose in an element; the identity if missing."""
    text = element.findtext("pose")
    return Pose.from_xyz_rpy(*np.reshape(list(map(float, text.split())), (2, 3))) if text else IDENTITY


def named(elements: Any, name: str) -> Any:
    """The element with a name."""
    (found,) = (element for element in elements if element.get("name") == name)
    return found


@every_robot
def test_links_say_mass_properties_and_poses(name: str, write: Write) -> None:
    """Mass, com and inertia are the link's to the last bit; poses are at q = 0, in the model's frame."""
    robot, file = write(name, "sdf")
    model = model_of(file)
    assert [link.get("name") for link in model.findall("link")] == [link.name for link in robot.links]
    X_WL = {robot.root.name: np.eye(4)}
    for joint in robot.joints:
        X_WL[joint.child] = X_WL[joint.parent] @ joint.X_PC.matrix
    for link in robot.links:
        xml, mass = named(model.findall("link"), link.name), link.mass_properties
        np.testing.assert_allclose(pose_of(xml).matrix, X_WL[link.name], atol=1e-12)
        inertial = xml.find("inertial")
        com = [float(x) for x in inertial.findtext("pose").split()]
        assert (float(inertial.findtext("mass")), *com) == (mass.mass, *mass.com, 0, 0, 0)
        # By the specification, missing values are zero.
        rows = [[float(inertial.findtext(f"inertia/i{min(a, b)}{max(a, b)}", "0")) for b in "xyz"] for a in "xyz"]
        np.testing.assert_array_equal(rows, mass.inertia)


@every_robot
def test_joints_say_axis_limits_and_dynamics(name: str, write: Write) -> None:
    """Every joint has its kind, links, axis and numbers; unlimited values are missing or ±1e16.

    A continuous joint is a revolute one whose limits are stated as ±1e16: DART's plugin of Gazebo fixes `continuous`.
    """
    robot, file = write(name, "sdf")
    model = model_of(file)
    for joint in robot.joints:
        continuous = joint.kind is JointKind.CONTINUOUS
        xml = named(model.findall("joint"), joint.name)
        ends = (xml.get("type"), xml.findtext("parent"), xml.findtext("child"))
        assert ends == ("revolute" if continuous else joint.kind.value, joint.parent, joint.child)
        assert xml.find("pose") is None
        axis = xml.find("axis")
        assert (axis is None) == (joint.kind in (JointKind.FIXED, JointKind.BALL))
        if axis is None:
            continue
        assert tuple(map(float, axis.findtext("xyz").split())) == joint.axis
        unlimited = {"lower": "-1e16", "upper": "1e16", "effort": "inf", "velocity": "inf"}
        if continuous:
            assert [float(axis.findtext(f"limit/{end}")) for end in ("lower", "upper")] == [-1e16, 1e16]
        numbers = {key: float(axis.findtext(f"limit/{key}") or value) for key, value in unlimited.items()}
        limit = joint.limit
        bounds = {"lower": max(limit.lower, -1e16), "upper": min(limit.upper, 1e16)}
        assert numbers == {**bounds, "effort": limit.effort, "velocity": limit.velocity}
        dynamics = joint.dynamics
        stated = {
            "damping": dynamics.damping,
            "friction": dynamics.friction,
            "spring_stiffness": dynamics.stiffness,
            "spring_reference": dynamics.spring_reference,
        }
        assert {key: float(axis.findtext(f"dynamics/{key}") or 0) for key in stated} == stated


@every_robot
def test_base_is_held_by_a_joint_to_the_world(name: str, write: Write) -> None:
    """A fixed base has one fixed joint to the world, a floating one has none; no model is static."""
    robot, file = write(name, "sdf")
    model = model_of(file)
    held = [joint for joint in model.findall("joint") if joint.findtext("parent") == "world"]
    assert [(joint.get("type"), joint.findtext("child")) for joint in held] == (
        [("fixed", robot.root.name)] if robot.base is Base.FIXED else []
    )
    assert next(model.iter("static"), None) is None


@every_robot
def test_names_are_unique_among_links_joints_and_frames(name: str, write: Write) -> None:
    """Links, joints and frames share one namespace."""
    _, file = write(name, "sdf")
    model = model_of(file)
    names = [element.get("name") for tag in ("link", "joint", "frame") for element in model.findall(tag)]
    assert len(names) == len(set(names))


def test_frames_are_attached_to_their_links(write: Write) -> None:
    """A frame has its pose in its link."""
    robot, file = write("two_link_arm", "sdf")
    for frame in robot.frames:
        xml = named(model_of(file).findall("frame"), frame.name)
        assert xml.get("attached_to") == frame.link
        assert pose_of(xml).distance_to(frame.X_LF) == pytest.approx((0, 0), abs=1e-12)


@pytest.mark.parametrize("build", [four_bar, four_bar_with_zeros])
def test_closing_joint_is_the_closure(build: Any, write: Write) -> None:
    """Both sides of the closing joint, by the poses in the file, are the robot's closure in the drawn pose."""
    original = build()
    closure = original.closures[0]
    _, file = write(original.name, "sdf")
    model = model_of(file)
    joint = named(model.findall("joint"), closure.name)
    assert model.findall("joint")[-1] is joint
    assert (joint.get("type"), joint.findtext("parent"), joint.findtext("child")) == ("revolute", "coupler", "rocker")
    X_MA, X_MB = (pose_of(named(model.findall("link"), link)) for link in (closure.link_a, closure.link_b))
    X_MF = X_MB @ pose_of(joint)
    assert (X_MA.inverse() @ X_MF).distance_to(closure.X_AF) == pytest.approx((0, 0), abs=1e-12)
    drawn = link_poses(original, initial_configuration(original))
    assert X_MF.distance_to(drawn[closure.link_b] @ closure.X_BF) == pytest.approx((0, 0), abs=1e-12)
    assert tuple(map(float, joint.findtext("axis/xyz").split())) == closure.axis


def test_root_is_never_the_child_of_a_closing_joint() -> None:
    """A closure to the base is written in reverse, so that the tree keeps one root."""
    robot = four_bar()
    closure = robot.closures[0]
    X_WA = link_poses(robot, {})[closure.link_a]
    to_ground = replace(closure, link_b="ground", X_BF=X_WA @ closure.X_AF)
    files = render(replace(robot, closures=(to_ground,)), "sdf", Diagnostics())
    joint = named(etree.fromstring(files["four_bar.sdf"]).iter("joint"), closure.name)
    assert (joint.findtext("parent"), joint.findtext("child")) == ("ground", "coupler")
    assert pose_of(joint).distance_to(closure.X_AF) == pytest.approx((0, 0), abs=1e-12)


def test_version_is_raised_for_what_needs_it_alone(write: Write) -> None:
    """The version is 1.9, 1.10 for the pitch of a screw, 1.11 for a mimic."""
    for name in ROBOTS:
        robot, file = write(name, "sdf")
        mimics = any(joint.mimic for joint in robot.joints)
        screws = any(joint.kind is JointKind.SCREW for joint in robot.joints)
        expected = "1.11" if mimics else "1.10" if screws else "1.9"
        assert etree.parse(str(file)).getroot().get("version") == expected


def test_mimics_refer_to_the_leader_of_their_chain(write: Write) -> None:
    """A mimic of a mimic is written relative to the first joint."""
    _, file = write("gripper_with_mimic", "sdf")
    mimic = named(model_of(file).findall("joint"), "thumb_pivot").find("axis/mimic")
    numbers = tuple(float(mimic.findtext(key, "0")) for key in ("multiplier", "offset", "reference"))
    assert (mimic.get("joint"), *numbers) == ("finger", -100 / 7, 0.1, 0.0)


def test_zeros_of_loops_move_with_limits_springs_and_mimics() -> None:
    """A loop drawn away from q = 0 is written with q counted from the drawn pose, as are limits, springs and mimics."""
    robot = four_bar_with_zeros()
    crank, coupler, ground = robot.joints
    crank = replace(crank, kind=JointKind.REVOLUTE, limit=Limit(-1.0, 2.0))
    follower = replace(ground, name="follower", child="dial", mimic=Mimic("crank_pin", 2.0, 0.5), drawn_position=0.0)
    dial = replace(robot.links[1], name="dial", visuals=(), collisions=())
    robot = replace(robot, links=(*robot.links, dial), joints=(crank, coupler, ground, follower))
    files = render(robot, "sdf", Diagnostics())
    joints = etree.fromstring(files["four_bar_with_zeros.sdf"]).iter("joint")
    by_name = {joint.get("name"): joint for joint in joints}
    drawn = crank.drawn_position
    limits = [float(by_name["crank_pin"].findtext(f"axis/limit/{key}")) for key in ("lower", "upper")]
    np.testing.assert_allclose(limits, [-1.0 - drawn, 2.0 - drawn], atol=1e-15)
    mimic = by_name["follower"].find("axis/mimic")
    np.testing.assert_allclose(float(mimic.findtext("offset")), 0.5 + 2.0 * drawn, atol=1e-15)


@pytest.mark.pybullet
@pytest.mark.parametrize("name", [name for name in ROBOTS if name not in UNKNOWN_TO_PYBULLET])
def test_pybullet_puts_the_tree_where_the_robot_has_it(name: str, write: Write) -> None:
    """From a copy without world and closing joints PyBullet reads every link at the robot's pose."""
    pytest.importorskip("pybullet")
    robot, file = write(name, "sdf")
    places = configurations(robot, 4)
    seen = call_isolated("tests.conformance.pybullet_numbers:read_tree", str(file), places, timeout=120)
    # PyBullet prints this for every cylinder and capsule of an SDFormat file, and reads them correctly.
    harmless = ("BulletUrdfImporter.cpp,126]:", "Couldn't parse vector3") if name == "primitives" else ()
    assert [line for line in seen["complaints"] if not line.endswith(harmless or ("\0",))] == []
    assert set(seen["links"]) == set(robot.link_by_name)
    for q, poses in zip(places, seen["poses"], strict=True):
        for link, X_WL in link_poses(robot, q).items():
            np.testing.assert_allclose(poses[link], X_WL.matrix, atol=1e-6)


def test_no_robot_has_transparency_that_strict_readers_refuse(write: Write) -> None:
    """Opacity is the alpha of the colour: strict Drake rejects `<transparency>`."""
    robot, file = write("four_bar", "sdf")
    model = model_of(file)
    assert next(model.iter("transparency"), None) is None
    rocker: Robot | Any = named(model.findall("link"), "rocker")
    alpha = {float(diffuse.text.split()[3]) for diffuse in rocker.iter("diffuse")}
    assert alpha == {robot.link_by_name["rocker"].visuals[0].rgba[3]}


@every_robot
def test_colors_are_the_same_in_the_shade(name: str, write: Write) -> None:
    """The ambient colour is set: Gazebo uses black if it is missing."""
    robot, file = write(name, "sdf")
    materials = list(etree.parse(str(file)).iter("material"))
    assert len(materials) == sum(len(link.visuals) for link in robot.links)
    for material in materials:
        assert material.findtext("ambient") == material.findtext("diffuse") is not None
