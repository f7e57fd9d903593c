"""Scenes and worlds beside the written files: they load, with the same robot, which stands on the floor."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.robot.model import Base, Robot
from stepbot.robot.simulation_settings import settings_of
from tests.robots import ROBOTS
from tests.simulators.conftest import failures, look, skip_without, write

STANDING = ("floating_biped", "pendulum", "equipped", "four_bar", "two_link_arm", "primitives")
MARGIN = 0.001
"""PyBullet's collision margin [m] around the hulls of meshes."""
every_robot = pytest.mark.parametrize("name", STANDING)


def scene_of(name: str, folder: Path) -> tuple[Robot, Any, Any]:
    """A robot, the model of its scene, and the model of its own file."""
    skip_without("mujoco")
    import mujoco

    written = write(ROBOTS[name](), folder)
    file = written.written["mjcf"].path
    alone = mujoco.MjModel.from_xml_path(str(file))
    scene = mujoco.MjModel.from_xml_path(str(file.with_name(f"{file.stem}.scene.xml")))
    return written.robot, scene, alone


@pytest.mark.mujoco
@every_robot
def test_a_scene_has_the_robot_and_a_floor(name: str, tmp_path: Path) -> None:
    """The scene is the robot's file with a plane, a light and a camera; masses, coordinates and keyframes are equal."""
    import mujoco

    robot, scene, alone = scene_of(name, tmp_path)
    assert (scene.ngeom, scene.nlight, scene.ncam) == (alone.ngeom + 1, 1, alone.ncam + 1)
    for field in ("body_mass", "body_inertia", "body_pos", "jnt_range", "qpos0", "key_qpos", "actuator_gainprm"):
        np.testing.assert_array_equal(getattr(scene, field), getattr(alone, field))
    assert scene.opt.timestep == settings_of(robot).timestep
    data = mujoco.MjData(scene)
    mujoco.mj_forward(scene, data)
    camera = next(c for c in range(scene.ncam) if scene.cam_bodyid[c] == 0)
    seen = (data.geom_xpos[1:] - data.cam_xpos[camera]) @ data.cam_xmat[camera].reshape(3, 3)
    robots = seen[scene.geom_bodyid[1:] != 0]
    half = np.tan(np.radians(0.5 * scene.cam_fovy[camera]))
    assert (robots[:, 2] < 0.0).all()
    assert (np.abs(robots[:, :2]) < -half * robots[:, 2:]).all()


@pytest.mark.mujoco
@every_robot
def test_the_robot_touches_the_floor_and_does_not_pierce_it(name: str, tmp_path: Path) -> None:
    """MuJoCo's distance between floor and robot at home is 0 if its base floats or stands, else positive."""
    import mujoco

    robot, scene, _ = scene_of(name, tmp_path)
    data = mujoco.MjData(scene)
    starts = [-1, *range(scene.nkey)]
    for start in starts:
        mujoco.mj_resetData(scene, data) if start < 0 else mujoco.mj_resetDataKeyframe(scene, data, start)
        mujoco.mj_forward(scene, data)
        touching = [g for g in range(scene.ngeom) if scene.geom_contype[g] and scene.geom_bodyid[g]]
        floor = next(g for g in range(scene.ngeom) if scene.geom_bodyid[g] == 0 and scene.geom_type[g] == 0)
        distances = [mujoco.mj_geomDistance(scene, data, floor, g, 10.0, None) for g in touching]
        if robot.base is Base.FLOATING:
            assert min(distances) == pytest.approx(0.0, abs=2e-8)
        elif start == starts[-1]:
            assert min(distances) > -1e-8


@pytest.mark.mujoco
def test_marks_of_closures_and_sensors_are_not_drawn(tmp_path: Path) -> None:
    """Sites of closures, IMUs, force-torque sensors and rays are in a group that viewers hide; named frames are not."""
    for name in ("four_bar", "equipped"):
        robot, _, model = scene_of(name, tmp_path / name)
        frames = {frame.name for frame in robot.frames}
        for s in range(model.nsite):
            assert (model.site_group[s] < 3) == (model.site(s).name in frames), model.site(s).name


@pytest.mark.slow
@every_robot
def test_a_world_has_the_robot_and_a_floor(name: str, tmp_path: Path) -> None:
    """The robot of the world is that of the SDFormat, as stepbot's parser reads both; time step and systems fit it."""
    folder = write(ROBOTS[name](), tmp_path)
    file = folder.written["sdf"].path
    world = file.with_name(f"{file.stem}.world.sdf")
    asked = folder.request("sdf")
    observed = look("reader", replace(asked, file=str(world)))
    assert failures(folder.expected("sdf", asked), replace(observed, gravity=())) == set()
    top = etree.parse(world).getroot()
    assert float(top.findtext("world/physics/max_step_size")) == settings_of(folder.robot).timestep
    assert [model.get("name") for model in top.findall("world/model")] == ["floor", folder.robot.name]
    needed = {"imu", "camera", "gpu_lidar", "contact", "force_torque"} & {s.get("type") for s in top.iter("sensor")}
    systems = " ".join(plugin.get("filename") for plugin in top.findall("world/plugin"))
    for kind in needed:
        system = {"camera": "sensors", "gpu_lidar": "sensors", "force_torque": "forcetorque"}.get(kind, kind)
        assert f"gz-sim-{system}-system" in systems


@pytest.mark.pybullet
def test_pybullet_loads_a_world_and_the_robot_stands_on_its_floor(tmp_path: Path) -> None:
    """PyBullet's distance between the floor and a floating robot is that of its margin around hulls."""
    skip_without("pybullet")
    import pybullet

    robot = ROBOTS["floating_biped"]()
    file = write(robot, tmp_path).written["sdf"].path
    client = pybullet.connect(pybullet.DIRECT)
    try:
        floor, body = pybullet.loadSDF(str(file.with_name(f"{file.stem}.world.sdf")), physicsClientId=client)
        assert pybullet.getBodyInfo(body, physicsClientId=client)[1].decode() == robot.name
        close = pybullet.getClosestPoints(floor, body, 1.0, physicsClientId=client)
        assert min(point[8] for point in close) == pytest.approx(-MARGIN, abs=1e-6)
    finally:
        pybullet.disconnect(client)
