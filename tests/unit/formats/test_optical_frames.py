"""Optical frames of cameras, and the frames and topics that Gazebo names with measurements."""

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.formats.urdf.ros2.launch import bridged
from stepbot.geometry.spatial import Pose, rotation_from_rpy
from stepbot.robot.model import Frame, Robot
from stepbot.robot.sensors import OPTICAL
from tests.devices import equipped
from tests.unit.assemble.workshop import Workshop, at, built


def written(robot: Robot, format_: str, suffix: str) -> ET.Element:
    """The main file of a robot."""
    return ET.fromstring(render(robot, format_, Diagnostics())[f"{robot.name}{suffix}"])


def test_optical_axes_are_those_of_rep_103() -> None:
    """In the optical frame z is forward and x right, where a body has x forward, y left and z up."""
    forward, right, down = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)
    np.testing.assert_array_equal(OPTICAL.R, np.column_stack([right, down, forward]))
    np.testing.assert_allclose(rotation_from_rpy((-np.pi / 2, 0.0, -np.pi / 2)), OPTICAL.R, atol=1e-15)


def test_urdf_has_a_link_for_each_camera() -> None:
    """It is fixed to the camera's link, looks where the camera looks, and its images have its name."""
    robot = equipped()
    top = written(robot, "urdf", ".urdf")
    for camera in ("camera", "tool_camera"):
        frame = f"{camera}_optical_frame"
        sensor = next(one for one in robot.sensors if one.name == camera)
        joint = next(one for one in top.findall("joint") if one.find("child").get("link") == frame)  # type: ignore[union-attr]
        assert joint.get("type") == "fixed"
        origin = joint.find("origin")
        assert origin is not None
        xyz, rpy = ([float(part) for part in origin.get(name, "0 0 0").split()] for name in ("xyz", "rpy"))
        np.testing.assert_allclose(Pose.from_xyz_rpy(xyz, rpy).matrix, (sensor.X_LS @ OPTICAL).matrix, atol=1e-12)
        assert top.findtext(f".//sensor[@name='{camera}']/gz_frame_id") == frame
        assert top.findtext(f".//sensor[@name='{camera}']/topic") == f"{camera}/image"
    links = {link.get("name") for link in top.findall("link")}
    named = [one.text for one in top.findall(".//sensor/gz_frame_id")]
    assert len(named) == 5  # the IMU and both lidars, too
    assert set(named) <= links


def test_images_are_in_a_frame_that_is_renamed() -> None:
    """A frame with the name of a joint has another one in SDFormat, which images in it name."""
    robot = equipped()
    taken = robot.joints[0].name
    sensors = tuple(replace(one, frame=taken) if one.name == "camera" else one for one in robot.sensors)
    top = written(replace(robot, frames=(Frame(taken, "eye", OPTICAL),), sensors=sensors), "sdf", ".sdf")
    assert f"{taken}_frame" in [frame.get("name") for frame in top.findall("model/frame")]
    assert top.findtext(".//sensor[@name='camera']/gz_frame_id") == f"{taken}_frame"


def test_sdformat_has_a_frame_for_each_camera() -> None:
    """A frame of the format, attached to the camera's link."""
    top = written(equipped(), "sdf", ".sdf")
    frames = {frame.get("name"): frame.get("attached_to") for frame in top.findall("model/frame")}
    assert {"camera_optical_frame": "eye", "tool_camera_optical_frame": "tool"}.items() <= frames.items()
    assert top.findtext(".//sensor[@name='camera']/gz_frame_id") == "camera_optical_frame"


@pytest.mark.parametrize("origin", ["{xyz: [10 mm, 0, 0]}", "{component: base}", "{center: base}"])
def test_a_camera_of_a_sidecar_gets_its_frame(origin: str, tmp_path: Path) -> None:
    """However its place is stated: how it was found is for messages, and names no frame."""
    shop = Workshop()
    shop.box("base", (10, 20, 30), at(20, 0, 0))
    text = "defaults: {density: 1000}\nlinks:\n  base: {rest: true}\n"
    robot = built(shop, tmp_path, f"{text}sensors:\n  eye: {{type: camera, link: base, origin: {origin}}}\n")
    assert robot.sensors[0].source
    assert written(robot, "urdf", ".urdf").findtext(".//sensor[@name='eye']/gz_frame_id") == "eye_optical_frame"
    assert written(robot, "sdf", ".sdf").findtext(".//sensor[@name='eye']/gz_frame_id") == "eye_optical_frame"


@pytest.mark.parametrize(("turned", "name"), [(OPTICAL, "camera_optical_frame"), (Pose(), "camera_optical_frame_2")])
def test_a_frame_of_the_user_is_kept(turned: Pose, name: str) -> None:
    """A frame of the name is used where it is the optical one; another one keeps its name, and is not the camera's."""
    robot = equipped()
    camera = next(one for one in robot.sensors if one.name == "camera")
    own = Frame("camera_optical_frame", camera.link, camera.X_LS @ turned)
    top = written(replace(robot, frames=(*robot.frames, own)), "sdf", ".sdf")
    assert top.findtext(".//sensor[@name='camera']/gz_frame_id") == name
    assert len([one for one in top.findall("model/frame") if one.get("name") == name]) == 1


def test_the_bridge_hands_on_what_gazebo_publishes() -> None:
    """Each topic of the launch file is one of the description, with the image's calibration beside it."""
    robot = equipped()
    published = {f"/{one.text}" for one in written(robot, "urdf", ".urdf").findall(".//sensor/topic")}
    topics = {one.partition("@")[0] for one in bridged(robot)}
    calibrations = {"/camera/camera_info", "/tool_camera/camera_info"}
    assert topics == published | calibrations | {"/clock"}
    odd = replace(robot, sensors=tuple(replace(one, name=f"{one.name} 1") for one in robot.sensors))
    assert bridged(odd) == bridged(replace(robot, sensors=()))
