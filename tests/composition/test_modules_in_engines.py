"""What MuJoCo and PyBullet read of modules of a composed robot, against the files of each module converted alone."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import dedent
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pybullet
import pytest

from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.stages import convert
from stepbot.runtime.cache import Cache

from .described import composing, link, urdf

ARM, HAND = "stepbot_arm2/arm2", "robotiq_2f85/2f85"
WHOLE = """
    version: 1
    robot: both
    modules:
      arm: {file: "library:arm2", prefix: ""}
      hand: {file: "library:2f85", at: arm/tool0, offset: {xyz: [0, 0, 10 mm], rpy: [0, 0, 30 deg]}}
      other: {file: "library:2f85", at: arm/base, offset: {xyz: [0, 300 mm, 100 mm]}, home: {finger_joint: 0.2}}
    sensors: {imu: {type: imu, link: hand/robotiq_arg2f_base_link}}
    """


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, cache: Cache, robot_library: Path) -> Path:
    """The composed robot in ``both``, and its modules in ``arm2`` and ``2f85``."""
    folder = tmp_path_factory.mktemp("engines")
    (folder / "both.robot.yaml").write_text(dedent(WHOLE), encoding="utf-8")
    for name in (ARM, HAND, ""):
        sidecar = robot_library / f"{name}.robot.yaml" if name else folder / "both.robot.yaml"
        output = folder / (Path(name).name if name else "both")
        made: Conversion = convert(sidecar, Options(output, ("urdf", "sdf", "mjcf"), verify=False, cache=cache))
        assert not made.diagnostics.has_errors
    return folder


def mjcf(folder: Path, name: str) -> mujoco.MjModel:
    """A robot as MuJoCo loads it."""
    return mujoco.MjModel.from_xml_path(str(folder / name / f"{name}.xml"))


MODULES = pytest.mark.parametrize(("alone", "prefix"), [("arm2", ""), ("2f85", "hand_"), ("2f85", "other_")])


@pytest.mark.slow
@MODULES
def test_mujoco_reads_the_module(alone: str, prefix: str, folder: Path) -> None:
    """Masses, inertias, ranges, passive forces and drives are equal; poses between its links, whatever else moves."""
    whole, module = mjcf(folder, "both"), mjcf(folder, alone)
    bodies = [module.body(i).name for i in range(1, module.nbody)]
    ours, theirs = [whole.body(prefix + name).id for name in bodies], [module.body(name).id for name in bodies]
    for field in ("body_mass", "body_ipos", "body_inertia"):
        assert np.allclose(getattr(whole, field)[ours], getattr(module, field)[theirs], rtol=1e-12, atol=1e-15), field
    joints = [module.joint(i).name for i in range(module.njnt)]
    here, there = [whole.joint(prefix + name).id for name in joints], list(range(module.njnt))
    for field in ("jnt_range", "jnt_axis", "jnt_limited", "jnt_stiffness", "jnt_actfrcrange"):
        assert np.array_equal(getattr(whole, field)[here], getattr(module, field)[there]), field
    for field in ("dof_damping", "dof_armature", "dof_frictionloss"):
        at = whole.jnt_dofadr[here], module.jnt_dofadr[there]
        assert np.array_equal(getattr(whole, field)[at[0]], getattr(module, field)[at[1]]), field
    random = np.random.default_rng(3)
    states = mujoco.MjData(whole), mujoco.MjData(module)
    for _ in range(8):
        states[0].qpos[:] = random.uniform(-0.6, 0.6, whole.nq)
        states[1].qpos[module.jnt_qposadr[there]] = states[0].qpos[whole.jnt_qposadr[here]]
        mujoco.mj_forward(whole, states[0])
        mujoco.mj_forward(module, states[1])
        frames = []
        for state, ids in zip(states, (ours, theirs), strict=True):
            R, p = state.xmat[ids].reshape(-1, 3, 3), state.xpos[ids]
            frames.append((R[0].T @ R, (p - p[0]) @ R[0]))
        assert np.allclose(frames[0][0], frames[1][0], rtol=0.0, atol=1e-12)
        assert np.allclose(frames[0][1], frames[1][1], rtol=0.0, atol=1e-12)
        if prefix:  # nothing is attached to a hand, so its part of the mass matrix is its own, whatever carries it
            matrices = [np.zeros((model.nv, model.nv)) for model in (whole, module)]
            for model, state, matrix in zip((whole, module), states, matrices, strict=True):
                mujoco.mj_fullM(model, state, matrix)
            rows = whole.jnt_dofadr[here]
            scale = np.abs(matrices[1]).max()
            assert np.allclose(matrices[0][np.ix_(rows, rows)], matrices[1], rtol=0.0, atol=1e-12 * scale)


@contextmanager
def loaded(folder: Path, name: str) -> Iterator[tuple[int, int, dict[str, int]]]:
    """A URDF in PyBullet: client, body, and the index of each link, by its name."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        path = str(folder / name / f"{name}.urdf")
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        body = pybullet.loadURDF(path, useFixedBase=True, flags=flags, physicsClientId=client)
        count = pybullet.getNumJoints(body, physicsClientId=client)
        infos = [pybullet.getJointInfo(body, i, physicsClientId=client) for i in range(count)]
        yield client, body, {info[12].decode(): info[0] for info in infos}
    finally:
        pybullet.disconnect(client)


@MODULES
def test_pybullet_reads_the_module(alone: str, prefix: str, folder: Path) -> None:
    """Mass, inertia, axis and limits of every link, and its pose in the joint's parent."""
    seen: list[dict[str, np.ndarray]] = []
    for name, start in ((alone, ""), ("both", prefix)):
        with loaded(folder, name) as (client, body, links):
            of_module = {}
            for link in seen[0] if seen else links:
                info = pybullet.getJointInfo(body, links[start + link], physicsClientId=client)
                dynamics = pybullet.getDynamicsInfo(body, links[start + link], physicsClientId=client)
                numbers = [info[2], *info[6:12], *info[13], dynamics[0], *dynamics[2], *dynamics[3], *dynamics[4]]
                of_module[link] = np.array(numbers)
            seen.append(of_module)
    assert len(seen[0]) > 2
    for link, expected in seen[0].items():
        assert np.allclose(seen[1][link], expected, rtol=1e-9, atol=1e-12), link


def owner(name: str) -> str:
    """The module that an element is of, by its prefix; empty for the arm."""
    return next((one for one in ("hand", "other") if name.startswith(f"{one}_")), "")


def test_one_home_and_the_drives_of_all(folder: Path) -> None:
    """`home` has all coordinates and controls, within their ranges, each module as in its own file or as stated."""
    whole, hand = mjcf(folder, "both"), mjcf(folder, "2f85")
    assert whole.nkey == 1
    assert whole.key(0).name == "home"
    assert (len(whole.key_qpos[0]), len(whole.key_ctrl[0])) == (whole.nq, whole.nu)
    limited = whole.actuator_ctrllimited.astype(bool)
    assert (whole.key_ctrl[0] >= whole.actuator_ctrlrange[:, 0])[limited].all()
    assert (whole.key_ctrl[0] <= whole.actuator_ctrlrange[:, 1])[limited].all()
    drawn = hand.key_qpos[0][hand.joint("finger_joint").qposadr[0]]
    positions = [whole.key_qpos[0][whole.joint(f"{name}_finger_joint").qposadr[0]] for name in ("hand", "other")]
    assert positions == pytest.approx([drawn, 0.2], abs=1e-9)
    for i in range(whole.nu):
        assert owner(whole.actuator(i).name) == owner(whole.joint(whole.actuator(i).trnid[0]).name)
    assert whole.opt.timestep == min(mjcf(folder, name).opt.timestep for name in ("arm2", "2f85"))


def test_followers_follow_their_own_leader(folder: Path) -> None:
    """In URDF, SDFormat and MJCF; loops and excluded contacts stay within their module, too."""
    for path in ("both.urdf", "both.sdf"):
        joints = ET.parse(folder / "both" / path).getroot().iter("joint")
        pairs = [(joint.get("name", ""), one.get("joint", "")) for joint in joints for one in joint.iter("mimic")]
        assert len(pairs) > 2
        assert all(owner(follower) == owner(leader) for follower, leader in pairs)
    whole = mjcf(folder, "both")
    coupled = np.flatnonzero(whole.eq_type == mujoco.mjtEq.mjEQ_JOINT)
    assert len(coupled) > 2
    for i in coupled:
        a, b = (whole.joint(int(ids[i])).name for ids in (whole.eq_obj1id, whole.eq_obj2id))
        assert owner(a) == owner(b)
    loops = json.loads((folder / "both/report.json").read_text(encoding="utf-8"))["robot"]["closures"]
    assert len(loops) == 4
    for loop in loops:
        assert owner(loop["link_a"]) == owner(loop["link_b"]) == owner(loop["name"]) != ""


def test_nothing_touches_at_home(folder: Path) -> None:
    """Both sides of a mount do not collide, and the composed robot has no contact that a module has not alone."""
    whole = mjcf(folder, "both")
    data = mujoco.MjData(whole)
    mujoco.mj_resetDataKeyframe(whole, data, 0)
    mujoco.mj_forward(whole, data)
    assert data.ncon == 0


def gap_of_loops(model: mujoco.MjModel, data: mujoco.MjData, prefix: str) -> float:
    """The largest distance [m] of the two ends of a closure, of those with a prefix."""
    gaps = []
    for i in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_CONNECT):
        assert model.eq_objtype[i] == mujoco.mjtObj.mjOBJ_SITE
        sites = [data.site(int(ids[i])) for ids in (model.eq_obj1id, model.eq_obj2id)]
        if sites[0].name.startswith(prefix):
            gaps.append(float(np.linalg.norm(sites[0].xpos - sites[1].xpos)))
    assert len(gaps) >= 2
    return max(gaps)


def test_a_gripper_on_an_arm_closes_as_alone(folder: Path) -> None:
    """Opening and closing in a second: what follows the drive is at most as far off it as in the gripper's own file.

    So are its loops, within 5 um of alone.
    """
    errors, gaps = [], []
    for name, prefix in (("2f85", ""), ("both", "hand_")):
        model = mjcf(folder, name)
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        drive = model.actuator(f"{prefix}{mjcf(folder, '2f85').actuator(0).name}").id
        leader, follower = (
            model.joint(f"{prefix}{joint}").qposadr[0] for joint in ("finger_joint", "right_outer_knuckle_joint")
        )
        worst = widest = 0.0
        while data.time < 1.0:
            data.ctrl[drive] = 0.4 - 0.3 * np.cos(2.0 * np.pi * data.time)
            mujoco.mj_step(model, data)
            worst = max(worst, abs(abs(data.qpos[leader]) - abs(data.qpos[follower])))
            widest = max(widest, gap_of_loops(model, data, prefix))
        errors.append(worst)
        gaps.append(widest)
    assert errors[1] < max(1.5 * errors[0], 1e-4)
    assert 0.0 < gaps[1] < gaps[0] + 5e-6


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
    (folder / "palm.urdf").write_text(urdf("palm", link("palm")), encoding="utf-8")
    links = "".join(f"  {kind}_link: {{{INERTIAL}}}\n" for kind in KINDS)
    joints, above = "", "palm/palm"
    for kind, settings in KINDS.items():
        origin = f", {ORIGIN % above}" if "/" not in above else ""
        joints += f"  {kind}: {{type: {kind}, parent: {above}, child: {kind}_link{origin}{settings}}}\n"
        above = f"{kind}_link"
    hand = composing("palm: {file: palm.urdf, prefix: ''}", more=f"links:\n{links}joints:\n{joints}")
    (folder / "hand.robot.yaml").write_text(hand, encoding="utf-8")
    pair = composing("left: {file: hand.robot.yaml}", "right: {mirror_of: left, at: left/palm, flip: [screw]}")
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
def test_loops_start_where_home_is(tmp_path: Path) -> None:
    """Two modules with loops that begin elsewhere than drawn: PyBullet and SDFormat, whose zeros move, have them so."""
    modules = (
        "left: {file: 'library:slider_crank', home: {shaft: 0.4}}",
        "right: {mirror_of: left, flip: [shaft], at: left/frame, offset: {xyz: [0.5, 0, 0]}}",
        "bar: {file: 'library:four_bar', at: left/frame, home: {crank_turn: 0.3}}",
    )
    (tmp_path / "r.robot.yaml").write_text(composing(*modules), encoding="utf-8")
    made = convert(tmp_path / "r.robot.yaml", Options(tmp_path / "out", ("urdf", "sdf")))
    assert not made.diagnostics.has_errors, [str(one) for one in made.diagnostics if one.severity == "error"]
    assert made.report is not None
    closed = [one for one in made.report.checks if one.quantity == "closures" and one.status == "passed"]
    assert {("pybullet", "urdf"), ("reader", "sdf")} <= {(one.engine, one.format) for one in closed}
    against = {one.against for one in made.report.checks if one.format == "sdf" and one.quantity == "limits"}
    assert against == {"model", *(f"module '{name}' alone" for name in ("left", "right", "bar"))}


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
