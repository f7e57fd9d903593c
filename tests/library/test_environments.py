"""Every robot of the library as a learner finds it: `stand` where it floats, else `reach`."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.library.conftest import Converted, every_converted_robot

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install stepbot[learn]")

import mujoco  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

import stepbot.gym  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]

OPTIONS: dict[str, dict[str, Any]] = {
    "abb_yumi": {"tip": "gripper_r_base"},
    "franka_hand": {"tip": "fr3_leftfinger"},
    "robotiq_2f85": {"tip": "left_inner_finger_pad"},
    "stepbot_upper_body": {"tip": "right_palm"},
}
"""Tips of robots with several arms or fingers, which have no other end."""
STANDING = ("stepbot_diff_drive", "stepbot_hexapod", "stepbot_quadruped")


LARGEST_GAP = 1e-3
"""Gap [m] of a closed loop."""


def gaps_of_loops(env: Any) -> list[float]:
    """Distances [m] between the two sites, or anchors, of each closure."""
    model, data = env.model, env.data
    gaps = []
    for closure in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_CONNECT):
        one, other = int(model.eq_obj1id[closure]), int(model.eq_obj2id[closure])
        if model.eq_objtype[closure] == mujoco.mjtObj.mjOBJ_SITE:
            places = data.site_xpos[one], data.site_xpos[other]
        else:
            anchors = model.eq_data[closure].reshape(-1)[:6].reshape(2, 3)
            bodies = zip((one, other), anchors, strict=True)
            places = [data.xpos[body] + data.xmat[body].reshape(3, 3) @ anchor for body, anchor in bodies]
        gaps.append(float(np.linalg.norm(places[0] - places[1])))
    return gaps


@every_converted_robot
def test_robot_is_an_environment(robot: str, converted: Converted) -> None:
    """gymnasium's checker accepts it; zero actions for a second neither diverge nor tip it over; loops stay closed."""
    task = "stand" if robot in STANDING else "reach"
    model = stepbot.gym.load(converted(robot).file(".xml"))
    env = stepbot.gym.make(model, task, **OPTIONS.get(robot, {})).unwrapped
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*infinity.*")
        check_env(env, skip_render_check=True)
    env.reset(seed=0)
    for _ in range(round(1.0 / env.dt)):
        _, _, terminated, _, info = env.step(np.zeros(env.action_space.shape))
        assert not terminated, info
    if task == "stand":
        assert info["is_success"]
        return
    targets, gaps = [], []
    for seed in range(4):
        env.reset(seed=seed)
        targets.append(env.target)
        gaps += gaps_of_loops(env)
    assert np.ptp(targets, axis=0).max() > 0.01
    assert max(gaps, default=0.0) < LARGEST_GAP
