"""The eight robots of the library that are others' in MJX, MuJoCo Warp, Genesis and SAPIEN.

Masses and poses are the model's. These simulators are no engines of stepbot: they have single precision. Each loads
all robots in a process of its own.
"""

import importlib.util
import json
import re
import subprocess
import sys
from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import main_file
from stepbot.geometry.spatial import Pose
from stepbot.pipeline.conversion import Options, write
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import MOVING, link_poses
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.robot_library import library_robot
from tests.library.conftest import LIBRARY, ROBOTS

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("other simulators")]

NAMES = ("ur5e", "gen3", "panda", "sawyer", "yumi", "2f85", "hand", "youbot")
SINGLE = 2e-5
"""Deviation [m] of poses in single precision, over a chain of up to nine joints."""

POSED = """
import mujoco
import numpy as np

def posed(model, q):
    data = mujoco.MjData(model)
    for name, position in q.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    # The slide of a screw follows its hinge.
    for i in range(model.neq):
        if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT and model.eq_obj2id[i] >= 0:
            follower, leader = model.jnt_qposadr[[model.eq_obj1id[i], model.eq_obj2id[i]]]
            moved = data.qpos[leader] - model.qpos0[leader]
            powers = moved ** np.arange(5)
            data.qpos[follower] = model.qpos0[follower] + model.eq_data[i, :5] @ powers
    return data
"""
MJX = """
import json, sys, warnings
warnings.simplefilter("ignore")
import jax
import mujoco
from mujoco import mjx

def seen(file, q):
    model = mujoco.MjModel.from_xml_path(file)
    data = posed(model, q)
    theirs = mjx.put_model(model)
    jax.eval_shape(mjx.step, theirs, mjx.make_data(theirs))
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
    data = posed(model, q)
    theirs, moved = mujoco_warp.put_model(model), mujoco_warp.put_data(model, data)
    mujoco_warp.kinematics(theirs, moved)
    masses, places, turns = theirs.body_mass.numpy()[0], moved.xpos.numpy()[0], moved.xquat.numpy()[0]
    return {
        model.body(i).name: [float(masses[i]), places[i].tolist(), turns[i].tolist()] for i in range(1, model.nbody)
    }
"""
WARP_STEPS = """
import mujoco
import mujoco_warp
import numpy as np

def seen(file, q):
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    theirs, moved = mujoco_warp.put_model(model), mujoco_warp.put_data(model, data, nconmax=512, njmax=2048)
    for _ in range(10):
        mujoco_warp.step(theirs, moved)
        mujoco.mj_step(model, data)
    return float(np.abs(moved.qpos.numpy()[0] - data.qpos).max())
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
EACH = """
jobs = json.loads(sys.stdin.read())
print("\\n" + json.dumps({name: seen(file, q) for name, (file, q) in jobs.items()}))
"""
GENESIS = """
import json, sys
import genesis as gs

jobs = json.loads(sys.stdin.read())
gs.init(backend=gs.cpu, logging_level="error")
# One scene, which compiles once, and moves by kinematics alone.
scene = gs.Scene(
    show_viewer=False, rigid_options=gs.options.RigidOptions(enable_collision=False, disable_constraint=True)
)

def added(file):
    if file.endswith(".urdf"):
        morph = gs.morphs.URDF(file=file, fixed=True, merge_fixed_links=False, visualization=False)
    else:
        morph = gs.morphs.MJCF(file=file, visualization=False)
    return scene.add_entity(morph)

robots = {name: added(file) for name, (file, _) in jobs.items()}
scene.build()

def seen(robot, q):
    for joint in robot.joints:
        if joint.name in q:
            robot.set_qpos([q[joint.name]], qs_idx_local=joint.qs_idx_local)
    return {
        link.name: [float(link.get_mass()), link.get_pos().tolist(), link.get_quat().tolist()] for link in robot.links
    }

print("\\n" + json.dumps({name: seen(robots[name], q) for name, (_, q) in jobs.items()}))
"""


class Written(Struct, frozen=True, eq=False):
    """A robot and its folder."""

    robot: Robot
    folder: Path


def converted(sidecar: Path, folder: Path, step: Path | None = None) -> Written:
    """The robot of a sidecar."""
    options = Options(folder, formats=("urdf", "mjcf"), step=step, verify=False, cache=Cache(default_folder()))
    conversion = produce(sidecar, options)
    conversion.diagnostics.raise_if_errors()
    assert conversion.robot is not None
    write(conversion, folder, sidecar)
    return Written(conversion.robot, folder)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Written]:
    """The robots, converted."""
    return {name: converted(library_robot(name).sidecar, tmp_path_factory.mktemp(f"{name}_out")) for name in NAMES}


@pytest.fixture(scope="module")
def for_mjx(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Written]:
    """All robots of the library, with shapes that MJX accepts."""
    found = {}
    for name in ROBOTS:
        (given,), (step,) = ((LIBRARY / name).glob(kind) for kind in ("*.robot.yaml", "*.step"))
        text = given.read_text(encoding="utf-8").replace("collision: auto}", "collision: {for: mjx}}")
        if "for: mjx" not in text:
            text = re.sub(r"(?m)^defaults: \{", "defaults: {collision: {for: mjx}, ", text)
        if "for: mjx" not in text:
            text += "\ndefaults: {collision: {for: mjx}}\n"
        folder = tmp_path_factory.mktemp(f"{name}_mjx")
        sidecar = folder / given.name
        sidecar.write_text(text, encoding="utf-8")
        found[step.stem] = converted(sidecar, folder, step)
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


def compare(module: str, format_: str, program: str, written: Mapping[str, Written]) -> None:
    """Every link of every robot has its mass, and is where the model has it, at a random pose within the limits."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")
    one = format_named(format_)
    lowered = {name: lower(each.robot, one, Diagnostics()) for name, each in written.items()}
    poses = {name: pose_within_limits(robot) for name, robot in lowered.items()}
    jobs = {name: (str(written[name].folder / main_file(robot, one)), poses[name]) for name, robot in lowered.items()}
    run = subprocess.run(
        [sys.executable, "-c", program],
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


def test_mjx(for_mjx: Mapping[str, Written]) -> None:
    """MJX accepts every robot of the library: `put_model`, a traced `step`, and masses and poses of the MJCF."""
    compare("mujoco.mjx", "mjcf", POSED + MJX + EACH, for_mjx)


def test_mjx_has_no_contacts_of_cylinders(written: Mapping[str, Written]) -> None:
    """MJX refuses a cylinder that can touch a mesh: with a release that does not, the advice in the docs is void."""
    if importlib.util.find_spec("mujoco.mjx") is None:
        pytest.skip("mujoco.mjx is not installed")
    job = {"ur5e": (str(written["ur5e"].folder / "ur5e.xml"), {})}
    command = [sys.executable, "-c", POSED + MJX + EACH]
    run = subprocess.run(command, input=json.dumps(job), capture_output=True, text=True, check=False, timeout=600)
    assert run.returncode != 0
    assert "(mjtGeom.mjGEOM_CYLINDER, mjtGeom.mjGEOM_MESH) collisions not implemented" in run.stderr


def test_mujoco_warp(written: Mapping[str, Written]) -> None:
    """MuJoCo Warp: masses and poses of the MJCF."""
    compare("mujoco_warp", "mjcf", POSED + WARP + EACH, written)


def test_mujoco_warp_steps(for_mjx: Mapping[str, Written]) -> None:
    """Ten steps from home take every robot of the library, with shapes for MJX, where MuJoCo's take it.

    The youBot is 0.0011 apart: the hull of its body reaches over its rollers (SB810), in 148 contacts.
    """
    if importlib.util.find_spec("mujoco_warp") is None:
        pytest.skip("mujoco_warp is not installed")
    jobs = {name: (str(one.folder / f"{one.robot.name}.xml"), {}) for name, one in for_mjx.items()}
    program = "import json, sys" + WARP_STEPS + EACH
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, input=json.dumps(jobs), capture_output=True, text=True, check=False, timeout=1200)
    assert run.returncode == 0, run.stderr[-2000:]
    apart: dict[str, float] = json.loads(run.stdout.rstrip().rpartition("\n")[2])
    assert {name for name, off in apart.items() if not off < (2e-3 if name == "youbot" else SINGLE)} == set()
    assert apart.keys() == for_mjx.keys()


def test_mujoco_warp_says_which_contacts_it_drops(for_mjx: Mapping[str, Written]) -> None:
    """Its default reservation is too small for the youBot: if it were not, the advice in the docs would be void."""
    if importlib.util.find_spec("mujoco_warp") is None:
        pytest.skip("mujoco_warp is not installed")
    program = "import json, sys" + WARP_STEPS.replace(", nconmax=512, njmax=2048", "") + EACH
    job = {"youbot": (str(for_mjx["youbot"].folder / "youbot.xml"), {})}
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, input=json.dumps(job), capture_output=True, text=True, check=False, timeout=1200)
    assert run.returncode == 0, run.stderr[-2000:]
    assert "please increase nconmax" in run.stdout
    assert json.loads(run.stdout.rstrip().rpartition("\n")[2])["youbot"] > 2e-3


def test_sapien(written: Mapping[str, Written]) -> None:
    """SAPIEN: masses and poses of the URDF."""
    compare("sapien", "urdf", SAPIEN + EACH, written)


@pytest.mark.parametrize("format_", ["mjcf", "urdf"])
def test_genesis(format_: str, written: Mapping[str, Written]) -> None:
    """Genesis, on the processor: masses and poses of the MJCF and of the URDF."""
    compare("genesis", format_, GENESIS, written)


GRIPPER = """
import json, sys
import genesis as gs

gs.init(backend=gs.cpu, logging_level="error")
scene = gs.Scene(show_viewer=False, rigid_options=gs.options.RigidOptions(enable_collision=False))
robot = scene.add_entity(gs.morphs.MJCF(file=sys.argv[1], visualization=False))
scene.build()
driven = robot.get_joint("finger_joint").dofs_idx_local
start = robot.get_qpos().tolist()
robot.control_dofs_position([0.4], dofs_idx_local=driven)
for _ in range(300):
    scene.step()
print("\\n" + json.dumps([start, robot.get_qpos().tolist(), robot.get_dofs_kp(driven).tolist()]))
"""


def test_genesis_holds_loops(written: Mapping[str, Written]) -> None:
    """The driven joint reaches its target with the gain of the MJCF, and those of the parallelograms follow it."""
    if importlib.util.find_spec("genesis") is None:
        pytest.skip("genesis is not installed")
    command = [sys.executable, "-c", GRIPPER, str(written["2f85"].folder / "2f85.xml")]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1200)
    assert run.returncode == 0, run.stderr[-2000:]
    start, end, gains = json.loads(run.stdout.rstrip().rpartition("\n")[2])
    assert start == [0.0] * 6
    (drive,) = [one for one in written["2f85"].robot.actuators if one.joint == "finger_joint"]
    assert gains == pytest.approx([drive.kp], rel=1e-6)
    assert np.abs(end) == pytest.approx(np.full(6, 0.4), abs=0.01)
