"""What MuJoCo and PyBullet read of modules of a composed robot, against the files of each module converted alone."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import dedent
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest

from stepbot.pipeline.conversion import Conversion, Options
from stepbot.pipeline.stages import convert
from stepbot.report.results import Status
from stepbot.runtime.cache import Cache

from .described import composing, joint, link, urdf

ARM, HAND = "stepbot_arm2/arm2", "robotiq_2f85/2f85"
WHOLE = """
    version: 1
    robot: both
    modules:
      arm: {file: "library:arm2", prefix: ""}
      hand: {file: "library:2f85", at: arm/tool0, offset: {xyz: [0, 0, 10 mm], rpy: [0, 0, 30 deg]}}
      other: {file: "library:2f85", home: {finger_joint: 0.2}}
    joints:
      slide:
        type: prismatic
        parent: arm/upper_arm
        child: other/robotiq_arg2f_base_link
        axis: [0.6, 0, 0.8]
        origin: {offset: {xyz: [0, 300 mm, 100 mm], rpy: [0, 0, 30 deg]}}
        limits: {lower: -1, upper: 1, effort: 100, velocity: 1}
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
        assert not {"SB166:part", "SB166:overlap"} & {one.code for one in made.diagnostics}, "no part is there twice"
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


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """The full mass matrix (nv, nv) in a configuration."""
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def of_module(
    whole: mujoco.MjModel, data: mujoco.MjData, file: Path, prefix: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass matrix and gravity of a module's own file, on a free joint where the whole has it; its rates by the whole's.

    All three are MuJoCo's.
    """
    spec = mujoco.MjSpec.from_file(str(file))
    root = spec.worldbody.first_body()
    body, free = whole.body(prefix + root.name), root.add_freejoint()
    own = spec.compile()
    state, joints = mujoco.MjData(own), [own.joint(i) for i in range(own.njnt) if i != free.id]
    same = [whole.joint(prefix + one.name) for one in joints]
    rates = np.array([one.dofadr[0] for one in joints]), np.array([one.dofadr[0] for one in same])
    for one, other in zip(joints, same, strict=True):
        state.qpos[one.qposadr[0]] = data.qpos[other.qposadr[0]]
    state.qpos[:7] = *data.xpos[body.id], *data.xquat[body.id]
    linear, angular = np.zeros((3, whole.nv)), np.zeros((3, whole.nv))
    mujoco.mj_jacBody(whole, data, linear, angular, body.id)
    T = np.zeros((own.nv, whole.nv))
    T[:3], T[3:6] = linear, data.xmat[body.id].reshape(3, 3).T @ angular  # a free joint turns in the body's frame
    T[rates] = 1.0
    return mass_matrix(own, state), state.qfrc_bias.copy(), T


@pytest.mark.slow
def test_mass_matrix_is_the_sum_of_the_modules(folder: Path) -> None:
    """M is the sum of T' M T over the modules, gravity that of T' g: of a hand on a weld and one on a slide, too."""
    whole = mjcf(folder, "both")
    data, random = mujoco.MjData(whole), np.random.default_rng(7)
    for _ in range(8):
        data.qpos[:] = random.uniform(-0.5, 0.5, whole.nq)
        M = mass_matrix(whole, data)
        parts = [
            of_module(whole, data, folder / alone / f"{alone}.xml", prefix)
            for alone, prefix in (("arm2", ""), ("2f85", "hand_"), ("2f85", "other_"))
        ]
        total = np.sum([T.T @ own @ T for own, _, T in parts], axis=0)
        gravity = np.sum([T.T @ force for _, force, T in parts], axis=0)
        assert np.allclose(M, total, rtol=0.0, atol=1e-12 * np.abs(M).max())
        assert np.allclose(data.qfrc_bias, gravity, rtol=0.0, atol=1e-12 * np.abs(gravity).max())
        assert abs(gravity[whole.joint("slide").dofadr[0]]) > 1.0


@pytest.mark.slow
def test_pinocchio_has_the_sum_of_the_modules(folder: Path) -> None:
    """The same by Pinocchio's mass matrices and Jacobians of the written URDF files."""
    pin = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
    whole = pin.buildModelFromUrdf(str(folder / "both/both.urdf"))
    data, random = whole.createData(), np.random.default_rng(7)

    def symmetric(model: Any, q: np.ndarray) -> np.ndarray:
        upper = np.triu(pin.crba(model, model.createData(), q))
        return upper + np.triu(upper, 1).T

    for _ in range(8):
        q = random.uniform(-0.5, 0.5, whole.nq)
        M, total = symmetric(whole, q), np.zeros((whole.nv, whole.nv))
        pin.framesForwardKinematics(whole, data, q)
        for alone, prefix in (("arm2", ""), ("2f85", "hand_"), ("2f85", "other_")):
            own = pin.buildModelFromUrdf(str(folder / alone / f"{alone}.urdf"), pin.JointModelFreeFlyer())
            root = whole.getFrameId(prefix + ("base" if alone == "arm2" else "robotiq_arg2f_base_link"))
            position, T = pin.neutral(own), np.zeros((own.nv, whole.nv))
            position[:7] = pin.SE3ToXYZQUAT(data.oMf[root])
            T[:6] = pin.computeFrameJacobian(whole, whole.createData(), q, root, pin.LOCAL)
            for name in list(own.names)[2:]:  # after the universe and the free joint
                here, there = own.joints[own.getJointId(name)], whole.joints[whole.getJointId(prefix + name)]
                position[here.idx_q], T[here.idx_v, there.idx_v] = q[there.idx_q], 1.0
            total += T.T @ symmetric(own, position) @ T
        assert np.allclose(M, total, rtol=0.0, atol=1e-12 * np.abs(M).max())


@contextmanager
def loaded(folder: Path, name: str) -> Iterator[tuple[int, int, dict[str, int]]]:
    """A URDF in PyBullet: client, body, and the index of each link, by its name."""
    pybullet = pytest.importorskip("pybullet")
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


FREE = """<mujoco model="free"><worldbody><body name="hull" pos="0 0 1"><freejoint/>
  <geom type="box" size="0.1 0.2 0.3" mass="4"/><body name="mast" pos="0.1 0 0.3"><joint name="sway" axis="0 1 0"/>
  <geom type="box" size="0.02 0.02 0.2" pos="0.05 0 0.2" mass="1"/></body></body></worldbody></mujoco>
"""
WORLD = (
    "arm: {file: 'library:arm2', at: world, offset: {xyz: [1, 0, 0.2], rpy: [0, 0, 50 deg]}}",
    "hand: {file: 'library:2f85', at: world, offset: {xyz: [0, 1, 0.4], rpy: [0, 0, -20 deg]}}",
    "boat: {file: boat/boat.xml, at: world, offset: {xyz: [0, -2, 0]}}",
)


@pytest.mark.slow
def test_robots_in_a_world_are_each_as_alone(folder: Path, tmp_path: Path, cache: Cache) -> None:
    """Mass matrices of MuJoCo and PyBullet are block-diagonal; each block, and gravity, is that of its own file."""
    (tmp_path / "boat").mkdir()
    (tmp_path / "boat/boat.xml").write_text(FREE, encoding="utf-8")
    (tmp_path / "r.robot.yaml").write_text(composing(*WORLD), encoding="utf-8")
    options = Options(tmp_path / "whole", ("urdf", "mjcf"), verify=False, cache=cache)
    assert not convert(tmp_path / "r.robot.yaml", options).diagnostics.has_errors
    whole, random = mjcf(tmp_path, "whole"), np.random.default_rng(3)
    alone = {"arm": (folder, "arm2"), "hand": (folder, "2f85"), "boat": (tmp_path, "boat")}
    data, owners = mujoco.MjData(whole), np.array([owner_of(whole.body(i).name) for i in whole.dof_bodyid])
    for _ in range(4):
        data.qpos[:] = random.uniform(-0.5, 0.5, whole.nq)
        M = mass_matrix(whole, data)
        assert not M[owners[:, None] != owners].any()
        for name, file in alone.items():
            model, rows = mjcf(*file), np.flatnonzero(owners == name)
            own = mujoco.MjData(model)
            own.qpos[:] = np.concatenate(
                [
                    data.joint(whole.joint(i).name).qpos
                    for i in range(whole.njnt)
                    if owner_of(whole.body(whole.jnt_bodyid[i]).name) == name
                ]
            )
            of_own = mass_matrix(model, own)
            assert np.allclose(M[np.ix_(rows, rows)], of_own, rtol=0.0, atol=1e-12 * np.abs(of_own).max()), name
            scale = np.abs(own.qfrc_bias).max()
            assert np.allclose(data.qfrc_bias[rows], own.qfrc_bias, rtol=0.0, atol=1e-12 * scale), name
    del alone["boat"]  # its free joint is a chain of six in URDF, with other coordinates
    joints, M = of_pybullet(tmp_path, "whole")
    owners = np.array([owner_of(name) for name in joints])
    assert set(owners) == {"arm", "hand", "boat"}
    assert not M[owners[:, None] != owners].any()
    for name, file in alone.items():
        rows = np.flatnonzero(owners == name)
        names, of_own = of_pybullet(*file)
        assert names == [joints[i].removeprefix(f"{name}_") for i in rows]
        assert np.allclose(M[np.ix_(rows, rows)], of_own, rtol=0.0, atol=1e-12 * np.abs(of_own).max()), name


def owner_of(name: str) -> str:
    """The robot of a world that an element belongs to."""
    return name.partition("_")[0]


def of_pybullet(folder: Path, name: str) -> tuple[list[str], np.ndarray]:
    """The joints that move in a URDF and the mass matrix, each joint at 0.1."""
    pybullet = pytest.importorskip("pybullet")
    with loaded(folder, name) as (client, body, links):
        infos = [pybullet.getJointInfo(body, i, physicsClientId=client) for i in links.values()]
        names = [info[1].decode() for info in infos if info[2] != pybullet.JOINT_FIXED]
        return names, np.array(pybullet.calculateMassMatrix(body, [0.1] * len(names), physicsClientId=client))


@pytest.mark.slow
@MODULES
def test_pybullet_reads_the_module(alone: str, prefix: str, folder: Path) -> None:
    """Mass, inertia, axis and limits of every link, and its pose in the joint's parent."""
    pybullet = pytest.importorskip("pybullet")
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


@pytest.mark.slow
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


@pytest.mark.slow
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


LEFT = urdf(
    "left",
    *(link(name) for name in ("base", "crank", "coupler", "end")),
    joint("crank", "base", "crank", xyz="0 0 0.1", lower="-2"),
    joint("coupler", "crank", "coupler", xyz="0.1 0.1 0", lower="-2"),
    joint("tip", "coupler", "end", "fixed", xyz="0.3 0 0"),
)
RIGHT = urdf(
    "right",
    *(link(name) for name in ("base", "rocker", "end")),
    joint("rocker", "base", "rocker", xyz="0 0 0.1", lower="-2"),
    joint("tip", "rocker", "end", "fixed", xyz="0.1 0.1 0"),
)


@pytest.mark.slow
@pytest.mark.parametrize("q", [0.0, 0.3])
def test_a_loop_between_modules_is_proven(q: float, tmp_path: Path, cache: Cache) -> None:
    """URDF has mimics for it, and SDFormat moves its zeros: neither is in the modules alone."""
    text = composing(
        f"left: {{file: left.urdf, home: {{crank: {q}, coupler: {-q}}}}}",
        f"right: {{file: right.urdf, at: left/base, offset: {{xyz: [0.3, 0, 0]}}, home: {{rocker: {q}}}}}",
        more="closures: {pin: {type: revolute, link_a: left/end, link_b: right/end}}\n"
        "actuators: {motor: {joint: left/crank, kind: motor}}\n",
    )
    for name, content in {"r.robot.yaml": text, "left.urdf": LEFT, "right.urdf": RIGHT}.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    made = convert(tmp_path / "r.robot.yaml", Options(tmp_path / "out", cache=cache))
    assert not made.diagnostics.has_errors, list(made.diagnostics)
    assert b"<mimic" in made.files["whole.urdf"]
    against = {one.against for one in made.report.checks if one.status is Status.PASSED} if made.report else set()
    assert {"module 'left' alone", "module 'right' alone"} <= against


FORWARD = "0 -0.3 0"
SIX_HINGES = urdf(
    "arm",
    *(link(name) for name in ("base", "shoulder", "upper", "fore", "wrist", "hand", "tip")),
    joint("yaw", "base", "shoulder", lower="-1.5", upper="1.5"),
    joint("lift", "shoulder", "upper", axis="1 0 0", lower="-1.5", upper="1.5"),
    joint("elbow", "upper", "fore", xyz=FORWARD, axis="1 0 0", lower="-2.5", upper="2.5"),
    joint("roll", "fore", "wrist", xyz=FORWARD, axis="0 1 0", lower="-1", upper="1"),
    joint("pitch", "wrist", "hand", axis="1 0 0", lower="-2", upper="2"),
    joint("twist", "hand", "tip", xyz=FORWARD, axis="0 1 0", lower="-3", upper="3"),
)


@pytest.mark.long
def test_two_arms_that_hold_each_other_pass_in_pybullet(tmp_path: Path) -> None:
    """At the usual speed, PyBullet's solver lets their loop open ten times as wide as its tolerance."""
    bend = 0.5  # [rad], up at the shoulder and twice down at the elbow, so that the hands are level
    place = float(0.3 * (2.0 * np.cos(bend) + 1.0))
    closed = f"""frames: {{place: {{link: bench, origin: {{xyz: [0, {place!r}, 0]}}}}}}
links: {{bench: {{inertial: {{mass: 50, com: [0, 0, 0], inertia: {{ixx: 5, iyy: 5, izz: 5}}}}}}}}
closures: {{grip: {{type: ball, link_a: left/tip, link_b: right/tip}}}}
"""
    left = f"left: {{file: arm.urdf, at: place, home: {{lift: {-bend}, elbow: {2 * bend}, pitch: {-bend}}}}}"
    (tmp_path / "whole.robot.yaml").write_text(
        composing(left, "right: {mirror_of: left}", more=closed), encoding="utf-8"
    )
    (tmp_path / "arm.urdf").write_text(SIX_HINGES, encoding="utf-8")
    options = Options(tmp_path / "out", ("urdf",), require=("pybullet",))
    made = convert(tmp_path / "whole.robot.yaml", options)
    assert [one.code for one in made.diagnostics if one.severity == "error"] == []
    assert made.report is not None
    (closures,) = [c for c in made.report.checks if (c.engine, c.quantity) == ("pybullet", "closures")]
    assert closures.status is Status.PASSED
