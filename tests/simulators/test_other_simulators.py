"""The eight robots of the library that are others' in MJX, MuJoCo Warp and SAPIEN: masses and poses are the model's.

These simulators are no engines of stepbot: they have single precision. Each loads all robots in a process of its own.
"""

import importlib.util
import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import main_file
from stepbot.geometry.spatial import Pose
from stepbot.jobs.library import library_robot
from stepbot.pipeline.conversion import Options, write
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import MOVING, link_poses
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache, default_folder

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("other simulators")]

NAMES = ("ur5e", "gen3", "panda", "sawyer", "yumi", "2f85", "hand", "youbot")
SINGLE = 2e-5
"""Deviation [m] of poses in single precision, over a chain of up to nine joints."""

MJX = """
import json, sys, warnings
warnings.simplefilter("ignore")
import mujoco
from mujoco import mjx

def seen(file, q):
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    for name, position in q.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    theirs = mjx.put_model(model)
    moved = mjx.kinematics(theirs, mjx.put_data(model, data))
    return {
        model.body(i).name: [float(theirs.body_mass[i]), moved.xpos[i].tolist(), moved.xquat[i].tolist()]
        for i in range(1, model.nbody)
    }
"""
WARP = """
import json, sys
import mujoco
import mujoco_warp

def seen(file, q):
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    for name, position in q.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    theirs, moved = mujoco_warp.put_model(model), mujoco_warp.put_data(model, data)
    mujoco_warp.kinematics(theirs, moved)
    masses, places, turns = theirs.body_mass.numpy()[0], moved.xpos.numpy()[0], moved.xquat.numpy()[0]
    return {
        model.body(i).name: [float(masses[i]), places[i].tolist(), turns[i].tolist()] for i in range(1, model.nbody)
    }
"""
SAPIEN = """
import json, re, sys
from pathlib import Path
import sapien

def seen(file, q):
    # Materials of visuals need a graphics card, or a driver that stands in for one.
    bare = Path(file).with_suffix(".bare.urdf")
    bare.write_text(re.sub(r"<visual.*?</visual>", "", Path(file).read_text(), flags=re.DOTALL))
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load(str(bare))
    robot.set_qpos([q[joint.name] for joint in robot.active_joints])
    return {
        link.name: [float(link.mass), link.entity_pose.p.tolist(), link.entity_pose.q.tolist()] for link in robot.links
    }
"""
ALL = """
jobs = json.loads(sys.stdin.read())
print("\\n" + json.dumps({name: seen(file, q) for name, (file, q) in jobs.items()}))
"""


@dataclass(frozen=True, eq=False)
class Written:
    """A robot and its folder."""

    robot: Robot
    folder: Path


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Written]:
    """The robots, converted."""
    found = {}
    for name in NAMES:
        folder = tmp_path_factory.mktemp(f"{name}_out")
        options = Options(folder, formats=("urdf", "mjcf"), verify=False, cache=Cache(default_folder()))
        sidecar = library_robot(name).sidecar
        conversion = produce(sidecar, options)
        conversion.diagnostics.raise_if_errors()
        assert conversion.robot is not None
        write(conversion, folder, sidecar)
        found[name] = Written(conversion.robot, folder)
    return found


def pose_within_limits(robot: Robot) -> dict[str, float]:
    """A position of each joint within its limits; mimics follow."""
    random, q = np.random.default_rng(7), dict[str, float]()
    for joint in robot.joints:
        if joint.kind in MOVING and joint.mimic is None:
            low, high = joint.limit.lower, joint.limit.upper
            bounded = isfinite(low) and isfinite(high) and high - low < 1e3
            q[joint.name] = float(random.uniform(low, high) if bounded else random.uniform(-1.0, 1.0))
    for joint in robot.joints:
        if joint.mimic is not None:
            q[joint.name] = joint.mimic.multiplier * q[joint.mimic.joint] + joint.mimic.offset
    return q


@pytest.mark.parametrize(
    ("module", "format_", "program"),
    [("mujoco.mjx", "mjcf", MJX), ("mujoco_warp", "mjcf", WARP), ("sapien", "urdf", SAPIEN)],
    ids=["mjx", "warp", "sapien"],
)
def test_masses_and_poses_are_the_models(
    module: str, format_: str, program: str, written: Mapping[str, Written]
) -> None:
    """Every link of every robot has its mass, and is where the model has it, at a random pose within the limits."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")
    one = format_named(format_)
    lowered = {name: lower(each.robot, one, Diagnostics()) for name, each in written.items()}
    poses = {name: pose_within_limits(robot) for name, robot in lowered.items()}
    jobs = {name: (str(written[name].folder / main_file(robot, one)), poses[name]) for name, robot in lowered.items()}
    run = subprocess.run(
        [sys.executable, "-c", program + ALL],
        input=json.dumps(jobs),
        capture_output=True,
        text=True,
        check=False,
        timeout=1200,
    )
    assert run.returncode == 0, run.stderr[-2000:]
    seen: dict[str, dict[str, Any]] = json.loads(run.stdout.rstrip().rpartition("\n")[2])
    for name, robot in lowered.items():
        expected = link_poses(robot, poses[name])
        root = seen[name][robot.root.name]
        X_WR = Pose.from_quaternion(root[2], root[1])
        for link in robot.links:
            mass, place, turn = seen[name][link.name]
            assert mass == pytest.approx(link.mass_properties.mass, rel=1e-6, abs=1.1e-6), (name, link.name)
            X_RL = X_WR.inverse() @ Pose.from_quaternion(turn, place)
            distance, angle = X_RL.distance_to(expected[link.name])
            assert distance < SINGLE, (name, link.name)
            assert angle < 10.0 * SINGLE, (name, link.name)
