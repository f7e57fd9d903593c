"""URDF in Gazebo: libsdformat converts it to SDFormat, with the sensors and springs of its blocks."""

import shutil
import subprocess
from dataclasses import replace

import pytest
from lxml import etree

from stepbot.engines.observation import ObservedSensor
from stepbot.engines.sdformat_reader.frames import Frames
from stepbot.engines.sdformat_reader.sensors import model_sensors
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.robot.sensors import Sensor, SensorKind
from tests.devices import equipped
from tests.simulators.conftest import skip_without, write

ROUNDED = 1e-5
"""libsdformat writes sensor poses with six digits where it merges links."""
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
