"""Robots drawn as machines: frames and masses from their scripts, motions in closed form."""

import importlib
import json
from typing import Any

import numpy as np
import pytest

from tests.library.conftest import LIBRARY, ROBOTS, SHORT, Converted
from tests.processes import call_isolated
from tests.rigid import deviations

MACHINES = tuple(
    robot for robot in ROBOTS if "..machine import" in (LIBRARY / robot / "build.py").read_text(encoding="utf-8")
)
every_machine = pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in MACHINES]
)


def expected(robot: str) -> dict[str, Any]:
    """The expected.json of a robot."""
    content: dict[str, Any] = json.loads((LIBRARY / robot / "expected.json").read_text(encoding="utf-8"))
    return content


def closed_form(robot: str) -> Any:
    """The module of closed forms of a robot."""
    return importlib.import_module(f"robot_library.{robot}.closed_form")


@every_machine
def test_links_are_as_drawn(robot: str, converted: Converted) -> None:
    """Mass, com and inertia of every link in its frame, to the accuracy of its meshes."""
    links = {link["name"]: link for link in converted(robot).report["robot"]["links"]}
    drawn = expected(robot)["links"]
    assert links.keys() == drawn.keys()
    for name, link in links.items():
        body = (link["mass"], link["com"], link["inertia"])
        assert max(deviations(body, drawn[name]["in_link_frame"])) < 2e-3, name


@pytest.mark.mujoco
@every_machine
def test_frames_are_as_drawn(robot: str, converted: Converted) -> None:
    """Frames of links and axes of joints in the drawn pose, by MuJoCo, to 1e-9 m."""
    conversion = converted(robot)
    seen = call_isolated("tests.engines:mujoco_at_home", str(conversion.file(".xml")))
    drawn, root = expected(robot), conversion.report["robot"]["root"]
    X_WM = _pose(drawn["links"][root]["frame"]) @ np.linalg.inv(seen["bodies"][root])
    for name, link in drawn["links"].items():
        np.testing.assert_allclose(X_WM @ seen["bodies"][name], _pose(link["frame"]), atol=1e-9, err_msg=name)
    # A ball joint has no axis.
    joints = [joint for joint in conversion.report["robot"]["joints"] if joint["kind"] != "ball"]
    axes = [joint["name"] for joint in joints if joint["name"] in seen["axes"]]
    assert axes
    for name in axes:
        axis = X_WM[:3, :3] @ seen["axes"][name]
        np.testing.assert_allclose(axis, drawn["joints"][name]["axis"], atol=1e-9, err_msg=name)


def _pose(frame: dict[str, Any]) -> np.ndarray:
    X = np.eye(4)
    X[:3, 3], X[:3, :3] = frame["position"], frame["rotation"]
    return X


@pytest.mark.slow
@pytest.mark.mujoco
def test_slider_crank_follows_its_formula(converted: Converted) -> None:
    """Positions of piston and rod over a full turn of the shaft equal the closed form to 1e-9."""
    robot = "stepbot_slider_crank"
    motion = expected(robot)["linkage"]["motion"]
    given = [{"shaft": q["shaft"]} for q in motion]
    seen = call_isolated("tests.engines:solved_by_newton", str(converted(robot).file(".xml")), given, ["piston"])
    for q, state in zip(motion, seen, strict=True):
        assert state["joints"] == pytest.approx(q, abs=1e-9)
        assert state["poses"]["piston"][0][3] == pytest.approx(closed_form(robot).piston_at(q["shaft"]), abs=1e-9)


@pytest.mark.long
@pytest.mark.mujoco
def test_scara_equals_its_closed_form(converted: Converted) -> None:
    """The tool at random joint positions, turns of the screw included; the inverse kinematics returns the positions."""
    robot = "stepbot_scara"
    formulas, known = closed_form(robot), expected(robot)
    assert known["lead"] == pytest.approx(0.02 / (2 * np.pi), rel=1e-12)
    states = [state["joints"] for state in known["tool"]]
    seen = call_isolated("tests.engines:solved_by_newton", str(converted(robot).file(".xml")), states, ["flange"])
    for state, found in zip(known["tool"], seen, strict=True):
        np.testing.assert_allclose(found["poses"]["flange"], _pose(state["pose"]), atol=1e-9)
        X = _pose(state["pose"])
        for elbow_left in (False, True):
            q = formulas.inverse(tuple(X[:3, 3]), float(np.arctan2(X[1, 0], X[0, 0])), elbow_left)
            np.testing.assert_allclose(formulas.tool(q), X, atol=1e-12)


@pytest.mark.long
@pytest.mark.mujoco
def test_stewart_platform_equals_its_closed_form(converted: Converted) -> None:
    """The leg lengths of the inverse kinematics move the platform to the given pose."""
    robot = "stepbot_stewart"
    formulas, poses = closed_form(robot), expected(robot)["poses"]
    X_WP0 = formulas.platform(0, 0, 0, 0, 0, 0)
    X_PB = np.linalg.inv(X_WP0) @ _pose(expected(robot)["links"]["platform"]["frame"])
    given = [state["legs"] for state in poses]
    assert given[0] == pytest.approx(dict.fromkeys(given[0], 0.0), abs=1e-12)
    seen = call_isolated("tests.engines:solved_by_newton", str(converted(robot).file(".xml")), given, ["platform"])
    for state, found in zip(poses, seen, strict=True):
        np.testing.assert_allclose(found["poses"]["platform"], _pose(state["platform"]) @ X_PB, atol=1e-9)
    assert converted(robot).report["robot"]["degrees_of_freedom"] == 6


@pytest.mark.long
@pytest.mark.mujoco
def test_delta_equals_its_closed_form(converted: Converted) -> None:
    """The shoulder angles of the inverse kinematics move the platform to the given position, and it stays level."""
    robot = "stepbot_delta"
    formulas, places = closed_form(robot), expected(robot)["places"]
    links = expected(robot)["links"]
    first = np.linalg.inv(_pose(links["base"]["frame"])) @ _pose(links["platform"]["frame"])
    given = [state["shoulders"] for state in places]
    assert given[0] == pytest.approx(dict.fromkeys(given[0], 0.0), abs=1e-12)
    seen = call_isolated("tests.engines:solved_by_newton", str(converted(robot).file(".xml")), given, ["platform"])
    for state, found in zip(places, seen, strict=True):
        X = np.array(found["poses"]["platform"])
        np.testing.assert_allclose(X[:3, :3], np.eye(3), atol=1e-9)
        np.testing.assert_allclose(
            X[:3, 3] - first[:3, 3], np.subtract(state["centre"], places[0]["centre"]), atol=1e-9
        )
        angles = [formulas.d.DRAWN + state["shoulders"][f"shoulder_{arm}"] for arm in (1, 2, 3)]
        np.testing.assert_allclose(formulas.centre_at(tuple(angles)), state["centre"], atol=1e-12)
    assert converted(robot).report["robot"]["degrees_of_freedom"] == 3


@pytest.mark.long
@pytest.mark.mujoco
def test_diff_drive_follows_its_odometry(converted: Converted) -> None:
    """Driven on a floor, the base follows its odometry to 2 % of the distance and 2 degrees, since wide wheels slip."""
    robot = "stepbot_diff_drive"
    formulas = closed_form(robot)
    for drive in expected(robot)["drives"]:
        wanted = {"left_motor": drive["left"], "right_motor": drive["right"]}
        file = str(converted(robot).file(".xml"))
        seen = call_isolated("tests.engines:driven_on_a_floor", file, "base_link", wanted, drive["time"])
        for name, speed in wanted.items():
            assert seen["speeds"][name] == pytest.approx(speed, rel=0.1), name  # friction keeps its motors at rest
        x, y, heading = formulas.place(*seen["speeds"].values(), drive["time"])
        way = max(np.hypot(x, y), 0.1)
        np.testing.assert_allclose(seen["place"][:2], (x, y), atol=0.02 * way)
        assert seen["place"][2] == pytest.approx(heading, abs=np.radians(2))


def test_wheels_and_twist_are_inverse() -> None:
    """Base speed and wheel speeds are inverse functions; the arc is half the track width times the yaw."""
    formulas = closed_form("stepbot_diff_drive")
    for left, right in ((2.0, 3.0), (-1.0, 4.0)):
        assert formulas.wheels(*formulas.twist(left, right)) == pytest.approx((left, right), rel=1e-12)
    assert formulas.place(2.0, 2.0 + 1e-7, 1.0)[:2] == pytest.approx(formulas.place(2.0, 2.0, 1.0)[:2], abs=1e-6)
