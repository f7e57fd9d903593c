"""URDF in Gazebo: libsdformat converts it to SDFormat, with the sensors and springs of its blocks."""

import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of
from stepbot.engines.observation import ObservedSensor, Request
from stepbot.engines.sdformat_reader.frames import Frames
from stepbot.engines.sdformat_reader.sensors import model_sensors
from stepbot.formats.lowering import lower
from stepbot.formats.urdf import FORMAT as URDF
from stepbot.geometry.inertia import combined
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.conversion import write as write_all
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import MOVING, link_poses
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.robot.sensors import Sensor, SensorKind
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.robot_library import library_robot, library_robots
from tests.devices import equipped
from tests.simulators.conftest import skip_without, write

ROUNDED = 1e-5
"""libsdformat writes sensor poses with six digits where it merges links."""
IN_CI = ("stepbot_delta", "stepbot_diff_drive", "rethink_sawyer", "ur5e_2f85")
"""Robots of which Gazebo loses links, or that it rejects, in a plain URDF, and one with a hand; others are long."""
SPRING = ("spring_stiffness", "spring_reference")


def _robot() -> Robot:
    """The equipped robot, with a contact sensor on a link with a fixed joint."""
    robot = equipped()
    fixed = replace(robot.joint_by_name["neck"], kind=JointKind.FIXED)
    joints: tuple[Joint, ...] = tuple(fixed if joint.name == "neck" else joint for joint in robot.joints)
    sensors = [sensor for sensor in robot.sensors if sensor.name != "neck_encoder"]
    return replace(robot, joints=joints, sensors=(*sensors, Sensor("bumper_2", SensorKind.CONTACT, "eye")))


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> etree._Element:
    """libsdformat's conversion of the robot's URDF."""
    skip_without("libsdformat")
    file = write(_robot(), tmp_path_factory.mktemp("gazebo")).written["urdf"].path
    return _by_gazebo(file)


def _by_gazebo(file: Path) -> etree._Element:
    program = shutil.which("gz") or shutil.which("ign")
    assert program is not None
    text = subprocess.run([program, "sdf", "-p", file.name], cwd=file.parent, capture_output=True, check=True).stdout
    model = etree.fromstring(text[text.index(b"<sdf") :]).find("model")
    assert model is not None
    return model


def test_every_sensor_is_in_gazebo(converted: etree._Element) -> None:
    """Kind, pose and settings of each sensor are the robot's; a contact sensor refers to existing shapes."""
    seen = {sensor.name: sensor for sensor in model_sensors(converted, Frames(converted))}
    robot = _robot()
    expected = [sensor for sensor in robot.sensors if sensor.kind is not SensorKind.JOINT]
    assert sorted(seen) == sorted(sensor.name for sensor in expected)
    for sensor in expected:
        _check(sensor, seen[sensor.name])


def _check(sensor: Sensor, found: ObservedSensor) -> None:
    assert (found.kind, found.link, found.rate) == (sensor.kind.value, sensor.link, sensor.rate), sensor.name
    if sensor.joint:
        assert found.joint == sensor.joint
    if found.X_LS is not None:
        assert max(found.X_LS.distance_to(sensor.X_LS)) < ROUNDED, sensor.name
    if found.fov is not None:
        assert found.fov == pytest.approx(sensor.view.fov)
        assert (found.columns, found.rows) == (sensor.view.columns, sensor.view.rows)


def test_springs_are_in_gazebo(converted: etree._Element) -> None:
    """The spring of a joint has its rest position; other joints have none."""
    reported = {
        joint.get("name"): tuple(float(joint.findtext(f"axis/dynamics/{name}") or 0.0) for name in SPRING)
        for joint in converted.findall("joint")
    }
    dynamics = {joint.name: joint.dynamics for joint in _robot().joints if joint.kind is not JointKind.FIXED}
    assert {name: reported[name] for name in dynamics} == {
        name: (one.stiffness, one.spring_reference) for name, one in dynamics.items()
    }


def _spawned(name: str, folder: Path) -> tuple[Robot, Path]:
    """A robot of the library as URDF has it, and the URDF that the launch file of its package gives to Gazebo."""
    cache = Cache(default_folder())
    options = Options(folder, formats=("urdf",), verify=False, package=f"{name}_description", ros2=True, cache=cache)
    conversion = produce(library_robot(name).sidecar, options)
    conversion.diagnostics.raise_if_errors()
    assert conversion.robot is not None
    write_all(conversion, options.output, library_robot(name).sidecar)
    robot = lower(conversion.robot, URDF, Diagnostics())
    launch = (folder / "launch" / "gazebo.launch.py").read_text(encoding="utf-8")
    program = "import xml.parsers.expat, xacro; xacro.main()"  # 2.1.1 forgets to import what it catches
    file = folder / "urdf" / f"{robot.name}.urdf.xacro"
    command = [sys.executable, "-c", program, str(file), *re.findall(r"least_mass:=[0-9.e-]+", launch)]
    spawned = folder / "spawned.urdf"
    spawned.write_text(subprocess.run(command, capture_output=True, text=True, check=True).stdout, encoding="utf-8")
    return robot, spawned


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(robot.name, marks=pytest.mark.slow if robot.name in IN_CI else pytest.mark.long)
        for robot in library_robots()
    ],
)
def test_gazebo_has_every_link_of_the_library(name: str, tmp_path: Path) -> None:
    """libsdformat's conversion of what is spawned has each link, with what is fixed to it, and the joints' limits."""
    skip_without("libsdformat")
    robot, spawned = _spawned(name, tmp_path / "out")
    converted = tmp_path / "converted.sdf"
    top = etree.Element("sdf", {"version": "1.9"})
    top.append(_by_gazebo(spawned))
    converted.write_bytes(etree.tostring(top))
    random = np.random.default_rng(7)
    q = {joint.name: float(random.uniform(-1.0, 1.0)) for joint in robot.joints if joint.kind in MOVING}
    for joint in robot.joints:
        if joint.mimic is not None:
            q[joint.name] = joint.mimic.multiplier * q[joint.mimic.joint] + joint.mimic.offset
    seen = engine_of("reader").observer.observe(Request(str(converted), "sdf", configurations=(q,), simulate=0.0))
    links = {link.name: link for link in seen.links}
    X_WL, at_zero = link_poses(robot, q), link_poses(robot, dict.fromkeys(q, 0.0))
    fixed = {joint.child: joint.parent for joint in robot.joints if joint.kind is JointKind.FIXED}
    groups: dict[str, list[str]] = defaultdict(list)
    for link in robot.links:
        head = link.name
        while head in fixed:
            head = fixed[head]
        groups[head].append(link.name)
    assert set(links) == set(groups)
    bodies = {link.name: link.mass_properties for link in robot.links}
    root = seen.poses[0][robot.root.name].inverse()
    for head, members in groups.items():
        X_HW = at_zero[head].inverse()
        whole = combined(bodies[one].moved(X_HW @ at_zero[one]) for one in members)
        found = links[head]
        assert found.mass == pytest.approx(whole.mass, abs=1.1e-5 * len(members), rel=1e-9), head
        if whole.mass > 0.01:
            np.testing.assert_allclose(found.com, whole.com, atol=1e-5, err_msg=head)
            scale = max(float(np.trace(np.array(whole.inertia))), 1e-6)
            np.testing.assert_allclose(found.inertia, whole.inertia, atol=1e-4 * scale, err_msg=head)
        distance, angle = (root @ seen.poses[0][head]).distance_to(X_WL[robot.root.name].inverse() @ X_WL[head])
        assert max(distance, angle) < 1e-5, head
    joints = {joint.name: joint for joint in seen.joints}
    moving = {joint.name: joint for joint in robot.joints if joint.kind is not JointKind.FIXED}
    assert set(joints) == set(moving)
    for joint_name, joint in moving.items():
        limit = joints[joint_name].limit
        assert limit is not None
        stated = (limit.lower, limit.upper, limit.effort, limit.velocity)
        expected = (joint.limit.lower, joint.limit.upper, joint.limit.effort, joint.limit.velocity)
        assert stated == pytest.approx(expected, rel=1e-5), joint_name
