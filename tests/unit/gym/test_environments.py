"""Environments of robots with a closed form: spaces, names, motion, rewards, determinism, divergence."""

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.gym.models import ARM, BOX, FORE, HEIGHT, HOME, SPEED, UPPER, written

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install stepbot[learn]")

import mujoco  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

import stepbot.gym  # noqa: E402

Make = Callable[..., Any]
STEP = 0.04
"""Time [s] between two actions of `reach`."""


@pytest.fixture
def arm(tmp_path: Path) -> Make:
    """Makes `reach` with the planar arm, without its wrappers."""
    return lambda **options: stepbot.gym.make(written(tmp_path, ARM), **options).unwrapped


@pytest.fixture
def box(tmp_path: Path) -> Make:
    """Makes `stand` with the box, without its wrappers."""
    return lambda **options: stepbot.gym.make(written(tmp_path, BOX, "box.xml"), "stand", **options).unwrapped


def tip(q: Any) -> tuple[float, float, float]:
    """Place [m] of the planar arm's tip."""
    a, b = float(q[0]), float(q[0] + q[1])
    return UPPER * math.cos(a) + FORE * math.cos(b), UPPER * math.sin(a) + FORE * math.sin(b), HEIGHT


def named(env: Any, observation: Any) -> dict[str, float]:
    """An observation by name."""
    return dict(zip(env.observation_names, observation.tolist(), strict=True))


def test_checker_of_gymnasium_passes(arm: Make, box: Make) -> None:
    """gymnasium's checker accepts both tasks; it warns of nothing but unbounded observations."""
    for env in (arm(), arm(normalise=False), arm(action="target"), box(push=0.5)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            check_env(env, skip_render_check=True)
        others = [str(one.message) for one in caught if "infinity" not in str(one.message)]
        assert all("[-1, 1]" in text or "normalized" in text for text in others), others


def test_numbers_have_names_and_units(arm: Make, box: Make) -> None:
    """Every number of actions and observations has the name of its joint, sensor or actuator, and its SI unit."""
    env = arm()
    assert dict(zip(env.action_names, env.action_units, strict=True)) == {
        "shoulder_drive/rate": "rad/s",
        "elbow_drive/rate": "rad/s",
    }
    assert dict(zip(env.observation_names, env.observation_units, strict=True)) == {
        "shoulder/position": "rad",
        "elbow/position": "rad",
        "shoulder/velocity": "rad/s",
        "elbow/velocity": "rad/s",
        "wrist/x": "N",
        "wrist/y": "N",
        "wrist/z": "N",
        "shoulder_drive/target": "rad",
        "elbow_drive/target": "rad",
        **{f"{what}/{axis}": "m" for what in ("tip", "error") for axis in "xyz"},
    }
    measured = arm(observe="sensors", action="target")
    assert measured.observation_names[:4] == ("shoulder_encoder", "wrist/x", "wrist/y", "wrist/z")
    assert measured.action_names == ("shoulder_drive/position", "elbow_drive/position")
    standing = box()
    quaternion, rates = ("qw", "qx", "qy", "qz"), ("vx", "vy", "vz", "wx", "wy", "wz")
    assert standing.observation_names == (
        "trunk/z",
        *(f"trunk/{part}" for part in quaternion),
        "neck/cos",
        "neck/sin",
        *(f"trunk/{part}" for part in rates),
        "neck/velocity",
    )
    assert standing.action_names == ("neck_drive/effort",)
    assert standing.action_units == ("N*m",)


def test_targets_are_within_reach(arm: Make) -> None:
    """The tip is where the closed form puts it, and every target is the tip of a configuration within the limits."""
    env = arm()
    places = []
    for seed in range(40):
        observation, _ = env.reset(seed=seed)
        seen = named(env, observation)
        q = seen["shoulder/position"], seen["elbow/position"]
        assert np.allclose(q, HOME, atol=0.02 * 2.5)
        assert np.allclose(env.tip, tip(q), atol=1e-9)
        assert np.allclose([seen[f"error/{axis}"] for axis in "xyz"], env.target - tip(q), atol=1e-9)
        x, y, z = env.target
        assert z == pytest.approx(HEIGHT)
        elbow = math.acos(np.clip((x * x + y * y - UPPER**2 - FORE**2) / (2 * UPPER * FORE), -1, 1))
        possible = []
        for bend in (elbow, -elbow):
            turn = math.atan2(y, x) - math.atan2(FORE * math.sin(bend), UPPER + FORE * math.cos(bend))
            turn = math.remainder(turn, 2 * math.pi)
            possible.append(-1.5 - 1e-6 <= turn <= 2 + 1e-6 and abs(bend) <= 2 + 1e-6)
        assert any(possible), env.target
        places.append((x, y))
    assert np.ptp(places, axis=0).min() > 0.5  # all over the workspace
    near = arm(spread=0.01)
    near.reset(seed=0)
    assert np.linalg.norm(near.target - tip(HOME)) < 0.04


def test_rate_moves_the_target_of_an_actuator(arm: Make) -> None:
    """The action 1 moves an actuator's target at the joint's velocity limit up to its range; the joint follows."""
    env = arm()
    observation, _ = env.reset(seed=3)
    start = named(env, observation)
    for name in ("shoulder", "elbow"):
        assert start[f"{name}_drive/target"] == pytest.approx(start[f"{name}/position"])
    for count in range(1, 6):
        observation, *_ = env.step(np.array([1.0, -0.5]))
        seen = named(env, observation)
        assert seen["shoulder_drive/target"] == pytest.approx(start["shoulder_drive/target"] + count * STEP * SPEED)
        assert seen["elbow_drive/target"] == pytest.approx(start["elbow_drive/target"] - 0.5 * count * STEP * SPEED)
    for _ in range(60):
        observation, *_ = env.step(np.array([1.0, 0.0]))
    seen = named(env, observation)
    assert seen["shoulder_drive/target"] == 2.0
    assert seen["shoulder/position"] == pytest.approx(2.0, abs=0.01)


def test_target_sets_the_position_between_home_and_the_limits(arm: Make) -> None:
    """-1 and 1 are the ends of the control range, 0 is home; raw actions have the joint's unit."""
    env = arm(action="target")
    for action, control in (((0, 0), HOME), ((1, -1), (2.0, -2.0)), ((-0.5, 0.5), (-0.6, 0.75))):
        env.reset(seed=0)
        env.step(np.array(action, dtype=np.float32))
        assert np.allclose(env.data.ctrl, control)
    raw = arm(action="target", normalise=False)
    assert np.allclose(raw.action_space.low, (-1.5, -2.0))
    assert np.allclose(raw.action_space.high, (2.0, 2.0))
    raw.reset(seed=0)
    raw.step(np.array([0.7, 5.0]))
    assert np.allclose(raw.data.ctrl, (0.7, 2.0))
    moved = arm(normalise=False)
    assert np.allclose(moved.action_space.high, SPEED)


def test_reward_of_reach_is_its_formula(arm: Make) -> None:
    """The reward is 0.1 m / (0.1 m + distance) less 0.02 of the mean square action; 5 cm are a success."""
    env = arm()
    _, info = env.reset(seed=1, options={"target": (0.5, 0.2, 0.25)})
    here = env.tip
    assert info["distance"] == pytest.approx(math.dist(env.tip, (0.5, 0.2, 0.25)))
    _, reward, terminated, truncated, info = env.step(np.array([1.0, 0.0]))
    distance = math.dist(env.tip, (0.5, 0.2, 0.25))
    assert reward == pytest.approx(0.1 / (0.1 + distance) - 0.01)
    assert (terminated, truncated, info["is_success"]) == (False, False, distance <= 0.05)
    assert env.reset(seed=1, options={"target": here})[1]["is_success"]


def test_reward_of_stand_is_its_formula(box: Make) -> None:
    """Upright at rest the reward is 1; tilted by 45 degrees its cosine times the height; beyond 60 degrees it ends."""
    env = box(reset_noise=0.0)
    env.reset(seed=0)
    _, reward, terminated, _, info = env.step(np.zeros(1))
    assert reward == pytest.approx(1.0, abs=5e-3)
    assert info["is_success"]
    assert not terminated
    for degrees, fallen in ((45, False), (70, True)):
        env.reset(seed=0)
        half = math.radians(degrees) / 2
        env.data.qpos[2:7] = (0.5, math.cos(half), math.sin(half), 0, 0)  # in the air: no contact changes the tilt
        _, reward, terminated, _, info = env.step(np.zeros(1))
        assert terminated == fallen
        assert info["tilt"] == pytest.approx(math.radians(degrees), abs=1e-3)
        assert reward == pytest.approx(math.cos(math.radians(degrees)), abs=1e-3)


def test_pushes_change_the_velocity(box: Make) -> None:
    """A push gives the base up to the given horizontal speed, in every direction, again after the interval."""
    env = box(push=0.8, push_interval=0.1, reset_noise=0.0)
    speeds = []
    for seed in range(20):
        env.reset(seed=seed)
        speeds.append(env.data.qvel[:2].copy())
    sizes = np.linalg.norm(speeds, axis=1)
    assert 0.0 < sizes.min() < sizes.max() <= 0.8
    assert np.ptp(np.sign(speeds), axis=0).tolist() == [2.0, 2.0]
    env.reset(seed=0)
    jumps = []
    for _ in range(10):
        before = env.data.qvel[:2].copy()
        env.step(np.zeros(1))
        jumps.append(float(np.linalg.norm(env.data.qvel[:2] - before)))
    assert np.argmax(jumps) in (4, 9)


@pytest.mark.parametrize("observe", ["all", "state"])
def test_bounds_are_finite_and_beyond_the_limits(arm: Make, observe: str) -> None:
    """Positions of limited joints have twice their limits, the rest the bound of its unit; no state reaches them."""
    env = arm(observe=observe)
    space = env.observation_space
    assert np.isfinite(space.low).all()
    assert np.isfinite(space.high).all()
    high = named(env, space.high)
    assert (high["shoulder/position"], high["shoulder/velocity"]) == (4.0, 1e3)
    env.reset(seed=0)
    for _ in range(20):
        observation, *_ = env.step(env.action_space.sample())
        assert (np.abs(observation) < space.high).all()


def test_same_seed_same_trajectory(arm: Make) -> None:
    """A seed fixes the whole episode, whatever came before; another seed gives another one."""

    def episode(env: Any, seed: int) -> Any:
        observations = [env.reset(seed=seed)[0]]
        env.action_space.seed(seed)
        for _ in range(20):
            observation, reward, *_ = env.step(env.action_space.sample())
            observations.append(np.append(observation[: observation.size], reward)[: observation.size])
        return np.array(observations)

    one, other = arm(), arm()
    first = episode(one, 5)
    episode(other, 9)
    assert np.array_equal(first, episode(other, 5))
    assert np.array_equal(first, episode(one, 5))
    assert not np.array_equal(first, episode(one, 6))


def test_vectors_are_the_single_environments(tmp_path: Path, arm: Make) -> None:
    """Environments of `make_vec` from one compiled model step as single ones do; the given model stays as it was."""
    model = stepbot.gym.load(written(tmp_path, ARM))
    flags = int(model.opt.disableflags)
    vector = gymnasium.make_vec("stepbot/Reach-v0", num_envs=3, vectorization_mode="sync", model=model)
    observations, _ = vector.reset(seed=10)
    actions = np.linspace(-1, 1, 6, dtype=np.float32).reshape(3, 2)
    moved, rewards, *_ = vector.step(actions)
    for number in range(3):
        env = arm()
        assert np.array_equal(env.reset(seed=10 + number)[0], observations[number])
        observation, reward, *_ = env.step(actions[number])
        assert np.array_equal(observation, moved[number])
        assert reward == rewards[number]
    assert int(model.opt.disableflags) == flags
    vector.close()


@pytest.mark.parametrize("bad", [math.nan, 1e12])
def test_divergence_ends_the_episode(bad: float, arm: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A state that is not finite ends the episode with the last finite observation; no log is written here."""
    monkeypatch.chdir(tmp_path)
    env = arm()
    handler = mujoco.get_mju_user_warning()
    before, _ = env.reset(seed=0)
    env.data.qvel[0] = bad
    observation, reward, terminated, truncated, info = env.step(np.zeros(2))
    assert (reward, terminated, truncated, info["diverged"]) == (-1.0, True, False, True)
    assert any("QVEL" in text for text in info["warnings"])
    assert np.array_equal(observation, before)
    assert np.isfinite(env.reset(seed=0)[0]).all()
    assert env.step(np.zeros(2))[2] is False
    assert mujoco.get_mju_user_warning() is handler
    assert [path.name for path in tmp_path.iterdir()] == ["robot.xml"]


def test_scene_beside_the_robot_is_used(tmp_path: Path) -> None:
    """The scene that stepbot writes is loaded for the robot's file, unless the caller wants the robot alone."""
    path = written(tmp_path, ARM)
    floor = '<worldbody><geom name="floor" type="plane" size="1 1 1"/></worldbody>'
    written(tmp_path, f'<mujoco><include file="robot.xml"/>{floor}</mujoco>', "robot.scene.xml")
    assert stepbot.gym.load(path).ngeom == 3
    assert stepbot.gym.load(path, scene=False).ngeom == 2
    assert stepbot.gym.load(tmp_path / "robot.scene.xml").ngeom == 3
    env = stepbot.gym.make(path).unwrapped
    env.reset(seed=0)
    assert np.allclose(env.data.qpos, HOME, atol=0.1)


def test_home_can_be_changed(arm: Make) -> None:
    """`home` moves joints from the keyframe, with the controls that hold them."""
    env = arm(home={"elbow": 1.2}, action="target", reset_noise=0.0)
    env.reset(seed=0)
    assert np.allclose(env.data.qpos, (HOME[0], 1.2))
    assert np.allclose(env.data.ctrl, (HOME[0], 1.2))


def test_followers_follow(tmp_path: Path) -> None:
    """Joints that an equality ties to others start on its curve, followers of followers too."""
    chain = """<body name="a"><joint name="a" range="-1 1" limited="true"/><geom size="0.01" mass="1"/>
      <body name="b" pos="1 0 0"><joint name="b"/><geom size="0.01" mass="1"/>
      <body name="c" pos="1 0 0"><joint name="c"/><geom size="0.01" mass="1"/></body></body></body>"""
    text = f"""<mujoco><compiler angle="radian"/><worldbody>{chain}</worldbody>
      <equality><joint joint1="c" joint2="b" polycoef="0 2 0 0 0"/>
      <joint joint1="b" joint2="a" polycoef="0.1 -1 0.5 0 0"/></equality>
      <actuator><position name="a" joint="a" kp="10" ctrlrange="-1 1"/></actuator></mujoco>"""
    env = stepbot.gym.make(written(tmp_path, text), max_speed=1.0, reset_noise=0.5).unwrapped
    for seed in range(5):
        env.reset(seed=seed)
        a, b, c = env.data.qpos
        assert b == pytest.approx(0.1 - a + 0.5 * a * a)
        assert c == pytest.approx(2 * b)


def test_contacts_are_drawn_again(tmp_path: Path) -> None:
    """No target and no start is in contact: a wall in the workspace is avoided."""
    wall = '<geom name="wall" type="box" pos="0.3 0.35 0.2" size="0.05 0.05 0.1"/><body name="upper"'
    env = stepbot.gym.make(written(tmp_path, ARM.replace('<body name="upper"', wall))).unwrapped
    for seed in range(40):
        env.reset(seed=seed)
        assert np.abs(env.target[:2] - (0.3, 0.35)).max() > 0.0498


TWO_ARMS = """<mujoco><worldbody>
  <body name="left"><joint name="l"/><geom size="0.1"/></body>
  <body name="right" pos="1 0 0"><joint name="r"/><geom size="0.1"/></body>
</worldbody><actuator><motor joint="l" ctrlrange="-1 1"/></actuator></mujoco>"""


def test_the_frame_before_a_jaw_is_the_tip(tmp_path: Path) -> None:
    """A jaw at the end is no tip, but the frame or the origin of its hand is; a frame of the first links is a mount."""
    jaw = '<body name="jaw" pos="0.1 0 0"><joint name="bite" range="0 1" limited="true"/><geom size="0.01"/></body>'
    site = f'<site name="tool" pos="{FORE} 0 0"/>'
    hand = stepbot.gym.make(written(tmp_path, ARM.replace(site, site + jaw))).unwrapped
    assert hand.tip_name == "site 'tool'"
    mount = ARM.replace(site, jaw).replace('<body name="fore"', f'{site}<body name="fore"')
    assert stepbot.gym.make(written(tmp_path, mount)).unwrapped.tip_name == "body 'fore'"


@pytest.mark.parametrize(
    ("jaw", "tip"),
    [
        ('<body name="part"><joint name="bite" range="0 1" limited="true"/>{}</body>', "part"),
        ('<body name="part"><joint name="gripper" range="0 1" limited="true"/>{}</body>', "fore"),
        ('<body name="jaw"><joint name="bite" range="0 2.6" limited="true"/>{}</body>', "jaw"),
        ('<body name="jaw"><joint name="bite"/>{}</body>', "jaw"),
        ('<body name="jaw"><joint name="bite" range="0 1" limited="true"/>{}<body name="pad">{}</body></body>', "fore"),
        ('<body name="jaw"><joint range="0 1" limited="true"/><joint type="slide" range="0 1"/>{}</body>', "jaw"),
    ],
    ids=["other name", "joint's name", "wide", "unlimited", "pad", "two joints"],
)
def test_only_a_jaw_is_left_out(jaw: str, tip: str, tmp_path: Path) -> None:
    """The last link is the tip unless joint or link have the name of a jaw, and the joint its range."""
    geom = '<geom type="sphere" size="0.01" pos="0.05 0.01 0"/>'
    last = f'<site name="tool" pos="{FORE} 0 0"/>'
    text = ARM.replace(last, jaw.replace("{}", geom)).replace('<force name="wrist" site="tool"/>', "")
    text = text.replace('<key name="home" qpos="0.3 -0.5" ctrl="0.3 -0.5"/>', "")
    assert stepbot.gym.make(written(tmp_path, text)).unwrapped.tip_name == f"body '{tip}'"


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("", {}, "MuJoCo does not compile"),
        (ARM.partition("<actuator>")[0] + "</mujoco>", {}, "no actuators.*add `actuators` to the sidecar"),
        (ARM, {"tip": "tol"}, "no site or body 'tol'; sites: tool"),
        (ARM, {"tip": "upper"}, "no joint moves the tip, body 'upper'"),
        (TWO_ARMS, {}, "Pass tip=..., one of left, right"),
        (ARM, {"task": "stand"}, "needs a floating base"),
        (BOX.replace('<geom name="floor" type="plane" size="0 0 1"/>', ""), {"task": "stand"}, "no floor to stand on"),
        (ARM, {"task": "walk"}, "unknown task 'walk'; there are reach, stand"),
        (ARM, {"action": "torque"}, "unknown mode of actions 'torque'; there are target, rate"),
        (ARM, {"observe": "pixels"}, "unknown choice of observations 'pixels'"),
        (ARM, {"camera": "eye"}, "no camera 'eye'"),
        (ARM, {"home": {"wrist": 1.0}}, "no hinge or slide 'wrist'; there are shoulder, elbow"),
        (ARM, {"home": {"elbow": 2.1}}, "joint 'elbow' at 2.1 rad is beyond its limits, -2 to 2 rad"),
        (ARM, {"home": {"elbow": float("nan")}}, "joint 'elbow' at nan rad"),
        (ARM, {"spread": 0.0}, "spread must be in"),
        (ARM, {"frame_skip": 0}, "frame_skip must be at least 1"),
        (ARM.replace("shoulder::velocity", "else"), {}, "joint 'shoulder' has no velocity limit.*max_speed"),
        (
            BOX.replace(' ctrlrange="-0.01 0.01"', ""),
            {"task": "stand"},
            "'neck_drive' has no control range; add ctrlrange",
        ),
        (BOX, {"task": "stand", "observe": "sensors"}, "no sensors; add `sensors` to the sidecar"),
        (BOX, {"task": "stand", "push": -1.0}, "push must not be negative"),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 80 else "",
)
def test_wrong_input_is_a_value_error(text: str, options: dict[str, Any], message: str, tmp_path: Path) -> None:
    """What the robot or the caller lacks is a ValueError with the remedy."""
    with pytest.raises(ValueError, match=message):
        stepbot.gym.make(written(tmp_path, text), **options)


def test_a_sidecar_is_no_model(tmp_path: Path) -> None:
    """The message names the file and the command that writes its MJCF; an MJCF may have any suffix."""
    sidecar = tmp_path / "arm.robot.yaml"
    sidecar.write_text("version: 1\nrobot: arm\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"arm\.robot\.yaml is no MJCF; `stepbot convert arm\.robot\.yaml "):
        stepbot.gym.make(sidecar)
    other = tmp_path / "arm.mjcf"
    other.write_text(f"\ufeff\n{ARM}", encoding="utf-8")
    assert stepbot.gym.load(other).nu == 2


def test_missing_file_is_a_value_error(tmp_path: Path) -> None:
    """A missing file is a ValueError with its path and the command that writes one."""
    with pytest.raises(ValueError, match=r"no file .*absent.xml; `stepbot convert"):
        stepbot.gym.load(tmp_path / "absent.xml")


@pytest.mark.parametrize("action", [[0.0], [math.nan, 0.0], [[0.0, 0.0]]])
def test_wrong_action_is_a_value_error(action: list[Any], arm: Make) -> None:
    """An action of another shape, or with NaN, is rejected."""
    env = arm()
    env.reset(seed=0)
    with pytest.raises(ValueError, match="an action must be 2 finite numbers"):
        env.step(np.array(action))


def test_pictures_show_robot_and_target(arm: Make) -> None:
    """`rgb_array` draws the scene with the target, where there is OpenGL; else the error says what to install."""
    env = arm(render_mode="rgb_array", width=64, height=48)
    env.reset(seed=0)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # glfw warns of the missing screen
            picture = env.render()
    except gymnasium.error.DependencyNotInstalled as error:
        pytest.skip(f"NO PICTURE IS TESTED: {error}")
    assert picture.shape == (48, 64, 3)
    assert (picture[..., 0] > picture[..., 1].astype(int) + 30).any()  # the red target; the robot is grey
    env.close()


def test_window_needs_a_screen(arm: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a screen `human` raises an error; MuJoCo's viewer would end the process."""
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="needs a screen"):
        arm(render_mode="human").reset(seed=0)
