"""Readings of sensors of the written MJCF in MuJoCo, against closed forms."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.engines.observation import Quantity
from stepbot.geometry.spatial import Pose
from stepbot.robot.kinematics import complete, link_poses
from stepbot.robot.model import Robot
from stepbot.robot.sensors import Sensor, SensorKind, View
from tests.devices import equipped
from tests.robots import ROBOTS
from tests.simulators.conftest import failures, look, skip_without, write
from tests.workshop import at

pytestmark = pytest.mark.mujoco
G = 9.81


def _at_rest(robot: Robot, folder: Path, wall: str = "") -> Any:
    """MuJoCo's state of a robot held still at q = 0, optionally in front of a wall."""
    skip_without("mujoco")
    import mujoco

    file = write(robot, folder).written["mjcf"].path
    text = file.read_text(encoding="utf-8").replace("<worldbody>", f"<worldbody>{wall}", 1)
    # Contacts, actuators and springs are disabled; weights and reactions remain.
    held = text.replace("</mujoco>", '<option><flag contact="disable" actuation="disable"/></option></mujoco>')
    file.write_text(held.replace('stiffness="0.7"', ""), encoding="utf-8")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_inverse(model, data)
    data.qfrc_applied[:] = data.qfrc_inverse
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qacc, 0.0, atol=1e-9)
    return data


def _below(robot: Robot, link: str) -> list[str]:
    names = [link]
    for name in names:
        names += [joint.child for joint in robot.joints if joint.parent == name]
    return names


def test_an_imu_at_rest_feels_the_ground_push_up(tmp_path: Path) -> None:
    """The accelerometer at rest measures 1 g upwards in its own frame, the gyro 0."""
    data = _at_rest(equipped(), tmp_path)
    (imu,) = (sensor for sensor in equipped().sensors if sensor.name == "imu")
    up = imu.X_LS.R.T @ np.array([0.0, 0.0, G])
    np.testing.assert_allclose(data.sensor("imu::accelerometer").data, up, atol=1e-9)
    np.testing.assert_allclose(data.sensor("imu::gyro").data, 0.0, atol=1e-12)
    np.testing.assert_allclose(data.sensor("imu::orientation").data, imu.X_LS.quaternion, atol=1e-12)


@pytest.mark.parametrize("name", ["shoulder_cell", "wrist_cell"])
def test_a_cell_bears_the_weight_of_what_hangs_from_it(name: str, tmp_path: Path) -> None:
    """A force sensor measures the weight of the child, about the sensor's origin, in the sensor's axes."""
    robot = equipped()
    data = _at_rest(robot, tmp_path)
    (cell,) = (sensor for sensor in robot.sensors if sensor.name == name)
    X_W = link_poses(robot, complete(robot, {}))
    X_WS = X_W[cell.link] @ cell.X_LS
    force, torque = np.zeros(3), np.zeros(3)
    for link in _below(robot, cell.link):
        body = robot.link_by_name[link].mass_properties
        weight = np.array([0.0, 0.0, -G * body.mass])
        force += weight
        torque += np.cross(X_W[link].apply(body.com) - X_WS.p, weight)
    np.testing.assert_allclose(data.sensor(f"{name}::force").data, -X_WS.R.T @ force, atol=1e-9)
    np.testing.assert_allclose(data.sensor(f"{name}::torque").data, -X_WS.R.T @ torque, atol=1e-9)


@pytest.mark.parametrize("place", [at(0.1, 0.2, 0.3), at(rpy=(0, 0, 0.5)), at(0.1, rpy=(0, 0, 0.5))])
def test_a_cell_away_from_its_joint_is_at_its_place_in_every_file(place: Pose, tmp_path: Path) -> None:
    """SDFormat and URDF state the sensor's pose, and that it measures in these axes, however little it is moved."""
    cell = Sensor("cell", SensorKind.FORCE_TORQUE, "arm", place, joint="shoulder")
    folder = write(replace(equipped(), sensors=(cell,)), tmp_path)
    for written_in, engine in (("mjcf", "mujoco"), ("urdf", "extensions"), ("sdf", "reader")):
        request = replace(folder.request(written_in), simulate=0.0)
        assert failures(folder.expected(written_in), look(engine, request)) == set()


def test_rays_of_a_lidar_meet_a_wall_ahead(tmp_path: Path) -> None:
    """Each ray to a wall 2 m away, perpendicular to x, measures 2 m over its cosine; the first is on the right."""
    lidar = Sensor("lidar", SensorKind.LIDAR, "base", at(x=0.5, z=0.3), view=View(math.pi / 2, 5, 1))
    robot = replace(equipped(), sensors=(lidar,))
    data = _at_rest(robot, tmp_path, '<geom type="box" size="0.1 9 9" pos="2.6 0 0"/>')
    seen = [float(data.sensor(f"lidar::range::{i}").data[0]) for i in range(5)]
    angles = np.linspace(-math.pi / 4, math.pi / 4, 5)
    np.testing.assert_allclose(seen, 2.0 / np.cos(angles), rtol=1e-6)
    data = _at_rest(robot, tmp_path, '<geom type="box" size="9 0.1 9" pos="0.5 -1.1 0"/>')
    assert data.sensor("lidar::range::0").data[0] == pytest.approx(math.sqrt(2.0), rel=1e-6)
    assert data.sensor("lidar::range::4").data[0] == -1.0


def test_many_rays_are_in_order(tmp_path: Path) -> None:
    """The 90 rays of a lidar go from right to left without a gap."""
    lidar = Sensor("lidar", SensorKind.LIDAR, "base", at(x=0.5, z=0.3), view=View(math.pi / 2, 90, 1))
    data = _at_rest(replace(equipped(), sensors=(lidar,)), tmp_path, '<geom type="box" size="0.1 9 9" pos="2.6 0 0"/>')
    seen = data.sensordata[: data.model.nsensor]
    assert [data.model.sensor(ray).name for ray in (0, 1, 89)] == [
        "lidar::range::00",
        "lidar::range::01",
        "lidar::range::89",
    ]
    angles = np.linspace(-math.pi / 4, math.pi / 4, 90)
    np.testing.assert_allclose(seen, 2.0 / np.cos(angles), rtol=1e-6)


def test_a_camera_looks_along_x_with_z_up(tmp_path: Path) -> None:
    """MuJoCo's camera looks along its -z, with y up; its image has the sensor's field of view."""
    robot = equipped()
    data = _at_rest(robot, tmp_path)
    (camera,) = (sensor for sensor in robot.sensors if sensor.name == "camera")
    X_WS = link_poses(robot, complete(robot, {}))[camera.link] @ camera.X_LS
    R_WC = data.camera("camera").xmat.reshape(3, 3)
    np.testing.assert_allclose(-R_WC[:, 2], X_WS.R[:, 0], atol=1e-12)
    np.testing.assert_allclose(R_WC[:, 1], X_WS.R[:, 2], atol=1e-12)
    up = math.radians(float(data.model.camera("camera").fovy[0]))
    wide = camera.view.columns / camera.view.rows
    assert 2 * math.atan(wide * math.tan(up / 2)) == pytest.approx(camera.view.fov, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [name for name in ("ball", "universal", "screw", "floating", "planar") if name in ROBOTS]
)
def test_joints_of_every_kind_can_be_measured(name: str, tmp_path: Path) -> None:
    """A sensor on a multi-dof joint is read back as one sensor on that joint."""
    robot = ROBOTS[name]()
    moving = [joint for joint in robot.joints if joint.kind.value == name]
    sensors = tuple(Sensor(f"encoder_{i}", SensorKind.JOINT, j.child, Pose(), j.name) for i, j in enumerate(moving))
    folder = write(replace(robot, sensors=sensors), tmp_path)
    for written_in, engine in (("mjcf", "mujoco"), ("urdf", "extensions"), ("sdf", "reader")):
        request = replace(folder.request(written_in), simulate=0.0)
        assert failures(folder.expected(written_in), look(engine, request)) == set()
    assert moving
    top = etree.parse(str(folder.written["mjcf"].path)).getroot()
    assert len(list(top.find("sensor"))) >= 2 * len(moving)


def test_sensors_measure_at_their_rate_and_hold_their_reading(tmp_path: Path) -> None:
    """An encoder of 100 Hz reads the position of every tenth millisecond, and holds it in between; rays do the same."""
    skip_without("mujoco")
    import mujoco

    robot = equipped()
    file = write(robot, tmp_path).written["mjcf"].path
    wall = '<worldbody><geom type="box" pos="1 0 0.06" size="0.01 0.5 0.5"/>'
    file.write_text(file.read_text(encoding="utf-8").replace("<worldbody>", wall, 1), encoding="utf-8")
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    data.joint("shoulder").qvel = 1.0
    read, moved, ahead = [], [], []
    for _ in range(100):
        moved.append(float(data.joint("shoulder").qpos[0]))
        model.geom_pos[0][0] += 1e-3  # the wall moves away from the lidar in every step
        mujoco.mj_step(model, data)
        read.append(float(data.sensor("shoulder_encoder::position").data[0]))
        ahead.append(max(float(data.sensor(s).data[0]) for s in _rays_of(model)))
    encoder, lidar = (round(period / model.opt.timestep) for period in (0.01, 0.1))
    assert read == [moved[step - step % encoder] for step in range(100)]
    assert len(set(moved)) == 100
    assert [step for step in range(1, 100) if ahead[step] != ahead[step - 1]] == list(range(lidar, 100, lidar))


@pytest.mark.slow
def test_a_sensor_without_a_buffer_measures_in_every_step(tmp_path: Path) -> None:
    """MuJoCo ignores its interval, also where the number of samples is negative."""
    skip_without("mujoco")
    written = write(equipped(), tmp_path)
    path, request = written.written["mjcf"].path, written.request("mjcf")
    text = path.read_text(encoding="utf-8")
    for samples, differs in (("2", False), ("0", True), ("-1", True)):
        path.write_text(text.replace('nsample="1"', f'nsample="{samples}"'), encoding="utf-8")
        assert (Quantity.SENSORS in failures(written.expected("mjcf"), look("mujoco", request))) == differs, samples


def _rays_of(model: Any) -> list[int]:
    """The sensors of the rays of the lidar with several rays."""
    return [s for s in range(model.nsensor) if model.sensor(s).name.startswith("lidar::range")]
