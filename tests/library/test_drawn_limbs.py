"""Robots with legs and arms: feet and hands are where closed forms predict, and inverse kinematics round-trips."""

import importlib
import json
from typing import Any

import numpy as np
import pytest

from robot_library.moments import inverse
from tests.library.conftest import LIBRARY, ROBOTS, SHORT, Converted
from tests.processes import call_isolated


def expected(robot: str) -> dict[str, Any]:
    """The expected.json of a robot."""
    content: dict[str, Any] = json.loads((LIBRARY / robot / "expected.json").read_text(encoding="utf-8"))
    return content


LIMBED = tuple(robot for robot in ROBOTS if "motions" in expected(robot))
"""Robots whose expected.json has ``motions``: positions of all joints, and frames in the frame of the root."""
every_limbed_robot = pytest.mark.parametrize("robot", LIMBED)
every_converted_limbed_robot = pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in LIMBED]
)


def pose(frame: dict[str, Any]) -> np.ndarray:
    """X of a frame in expected.json."""
    X = np.eye(4)
    X[:3, 3], X[:3, :3] = frame["position"], frame["rotation"]
    return X


def test_there_are_robots_with_limbs() -> None:
    """The library has robots with limbs."""
    assert {"stepbot_quadruped", "stepbot_hexapod", "stepbot_desk_arm", "stepbot_upper_body"} <= set(LIMBED)


@pytest.mark.mujoco
@every_converted_limbed_robot
@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
def test_feet_and_hands_equal_the_closed_forms(robot: str, suffix: str, converted: Converted) -> None:
    """Feet and hands in the written files, as drawn and at 20 random positions, equal the closed forms to 1e-9."""
    motions, root = expected(robot)["motions"], converted(robot).report["robot"]["root"]
    engine = {".urdf": "poses_in_yourdfpy", ".xml": "poses_in_mujoco"}[suffix]
    positions = [motion["joints"] for motion in motions]
    seen = call_isolated(f"tests.library.test_reference:{engine}", str(converted(robot).file(suffix)), positions)
    for motion, poses in zip(motions, seen, strict=True):
        for name, frame in motion["frames"].items():
            X_BF = inverse(np.array(poses[root])) @ np.array(poses[name])
            np.testing.assert_allclose(X_BF, pose(frame), atol=1e-9, err_msg=f"{name} at {motion['joints']}")


@every_limbed_robot
def test_the_formula_is_what_was_drawn(robot: str) -> None:
    """The first of the motions is the drawn pose, and expected.json is that of the current closed forms."""
    formulas = importlib.import_module(f"robot_library.{robot}.closed_form")
    for kept, fresh in zip(expected(robot)["motions"], formulas.known()["motions"], strict=True):
        assert kept["joints"] == pytest.approx(fresh["joints"], abs=1e-11)
        for name, frame in fresh["frames"].items():
            np.testing.assert_allclose(pose(kept["frames"][name]), pose(frame), atol=1e-11)


@pytest.mark.parametrize("robot", [robot for robot in LIMBED if robot in ("stepbot_quadruped", "stepbot_hexapod")])
def test_legs_are_their_formula_and_its_inverse(robot: str) -> None:
    """Closed forms of legs equal a chain of frames, and the inverse kinematics returns the positions."""
    formulas = importlib.import_module(f"robot_library.{robot}.closed_form")
    generator = np.random.default_rng(1)
    for name, leg in formulas.d.LEGS.items():
        for _ in range(20):
            q = generator.uniform(formulas.LOWEST, formulas.HIGHEST).tolist()
            X_BF = formulas.foot(name, *q)
            chained = leg.places(q)[3]
            chained[:3, 3] /= 1000
            np.testing.assert_allclose(chained, X_BF, atol=1e-12)
            found = leg.reaching(1000 * X_BF[:3, 3])
            if reaches_outwards(leg, q):
                np.testing.assert_allclose(found, q, atol=1e-9)
            np.testing.assert_allclose(formulas.foot(name, *found)[:3, 3], X_BF[:3, 3], atol=1e-12)


def reaches_outwards(leg: Any, q: list[float]) -> bool:
    """Whether a foot is on the leg's side of its first axis; otherwise that joint has a second solution."""
    foot = inverse(leg.places(q)[0]) @ leg.places(q)[3]
    return bool(foot[:3, 3] @ np.array(leg.straight) > 0)


def test_the_desk_arm_finds_its_positions_back() -> None:
    """Inverse kinematics of the tip returns the positions within its quarter turns."""
    formulas = importlib.import_module("robot_library.stepbot_desk_arm.closed_form")
    generator = np.random.default_rng(2)
    found = 0
    for _ in range(50):
        q = formulas.Positions(*generator.uniform((-1.9, -0.5, -1.5, -1.6, -2.7), (1.9, 1.5, 1.5, 1.6, 2.7)).tolist())
        X_WT = formulas.tip(q)
        pitch = q.shoulder_lift + q.elbow_flex + q.wrist_flex
        if np.cos(q.shoulder_pan) * X_WT[0, 3] + np.sin(q.shoulder_pan) * X_WT[1, 3] > 0:
            back = formulas.reaching(X_WT[:3, 3], pitch, q.wrist_roll)
            assert np.array(tuple(vars(back).values())) == pytest.approx(tuple(vars(q).values()), abs=1e-9)
            found += 1
    assert found > 25


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_upper_bodys_arms_find_their_positions_back(side: str) -> None:
    """Inverse kinematics returns seven positions from the pose of the palm and the swivel of the elbow."""
    formulas = importlib.import_module("robot_library.stepbot_upper_body.closed_form")
    generator = np.random.default_rng(4)
    for _ in range(50):
        q = formulas.random_arm(side, generator)
        back = formulas.reaching(side, formulas.palm(side, q), formulas.swivel(q))
        assert np.array(tuple(vars(back).values())) == pytest.approx(tuple(vars(q).values()), abs=1e-9)
