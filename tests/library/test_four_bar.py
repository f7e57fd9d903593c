"""The four-bar linkage from STEP to a moving loop: in MuJoCo, in PyBullet, and in the text of the files."""

import json
from collections.abc import Mapping
from functools import cache
from importlib.util import find_spec
from math import atan2, cos, pi, remainder, sin, sqrt
from typing import Any

import numpy as np
import pytest
from lxml import etree

from tests.command_line import Conversion
from tests.library.conftest import LIBRARY, Converted
from tests.processes import call_isolated
from tests.rigid import deviations, numbers, pose, reported_pose, sdf_pose, urdf_links

FOLDER = "stepbot_four_bar"
TURN = tuple(2 * pi * i / 72 for i in range(73))
"""Positions of the crank [rad] over a full turn."""


@cache
def expected() -> dict[str, Any]:
    """Closed forms, without CAD."""
    content: dict[str, Any] = json.loads((LIBRARY / FOLDER / "expected.json").read_text(encoding="utf-8"))
    return content


@pytest.fixture
def four_bar(converted: Converted) -> Conversion:
    """The four-bar in all formats."""
    return converted(FOLDER)


def _angles(crank: float) -> tuple[float, float]:
    """Angles [rad] of coupler and rocker at an angle of the crank, all from the ground bar: Freudenstein's equation.

    K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker), solved for the tangent of half the rocker's angle, on the
    branch where the bars do not cross.
    """
    ground, bar_a, bar_b, bar_c = (
        expected()["linkage"]["lengths"][n] for n in ("ground", "crank", "coupler", "rocker")
    )
    k1, k2 = ground / bar_a, ground / bar_c
    k3 = (bar_a**2 - bar_b**2 + bar_c**2 + ground**2) / (2 * bar_a * bar_c)
    a = cos(crank) - k1 - k2 * cos(crank) + k3
    b = -2 * sin(crank)
    c = k1 - (k2 + 1) * cos(crank) + k3
    rocker = 2 * atan2(-b - sqrt(b * b - 4 * a * c), 2 * a)
    x = ground + bar_c * cos(rocker) - bar_a * cos(crank)
    z = bar_c * sin(rocker) - bar_a * sin(crank)
    return atan2(z, x), rocker


def closed_form(turn: float) -> dict[str, float]:
    """Joint positions [rad] after a rotation of the crank from its drawn position."""
    drawn = expected()["linkage"]["drawn"]
    coupler, rocker = _angles(drawn["crank"] + turn)
    return {
        "crank_turn": turn,
        "coupler_turn": coupler - drawn["coupler"] - turn,
        "rocker_swing": rocker - drawn["rocker"],
    }


def _error(found: Mapping[str, float]) -> float:
    """Deviation of joint positions from the closed form at the same crank position [rad], modulo full turns."""
    true = closed_form(found["crank_turn"])
    return max(abs(remainder(found[name] - true[name], 2 * pi)) for name in true)


def test_the_two_closed_forms_agree() -> None:
    """Freudenstein's equation here and the law of cosines in the robot's folder agree."""
    motion = expected()["linkage"]["motion"]
    assert len(motion) == len(TURN)
    for turn, stated in zip(TURN, motion, strict=True):
        true = closed_form(turn)
        assert max(abs(remainder(stated[name] - true[name], 2 * pi)) for name in true) < 1e-10


@pytest.mark.mujoco
def test_newton_over_the_equality_rows_follows_the_four_bar_equation(four_bar: Conversion) -> None:
    """The loop in the MJCF gives every joint angle to 1e-6 rad over a full turn, with one degree of freedom."""
    file = str(four_bar.file(".xml"))
    found, freedom = call_isolated("tests.engines:closed_by_newton", file, "crank_turn", TURN)
    assert freedom == 1
    assert len(found) == len(TURN)
    assert max(map(_error, found)) < 1e-6
    swing = [q["rocker_swing"] for q in found]
    assert max(swing) - min(swing) == pytest.approx(1.0872, abs=1e-3)  # 62 degrees


@pytest.mark.slow
@pytest.mark.mujoco
def test_the_loop_holds_while_mujoco_drives_the_crank(four_bar: Conversion) -> None:
    """The crank's actuator makes a full turn; the pin stays in its bore, and the rocker follows the closed form."""
    file = str(four_bar.file(".xml"))
    found, gap, warnings = call_isolated("tests.engines:driven_in_mujoco", file, "crank_drive", 1.0)
    assert not any(warnings)
    assert found[-1]["crank_turn"] == pytest.approx(2 * pi, abs=0.1)
    assert gap < 2e-4  # MuJoCo's soft constraints sag under the weight of the bars
    assert max(map(_error, found)) < 5e-3


def test_sdformat_closing_joint_is_the_models_closure(four_bar: Conversion) -> None:
    """Both frames and the axis of the rocker's second joint in the text are the closure's, to 1e-9."""
    root = etree.parse(four_bar.file(".sdf")).getroot()
    model = root.find("model")
    (closing,) = (joint for joint in model.iter("joint") if joint.get("name") == "rocker_pin")
    assert closing.get("type") == "revolute"
    link_a, link_b = closing.findtext("parent"), closing.findtext("child")
    X_ML = {link.get("name"): sdf_pose(link) for link in model.iter("link")}
    X_BF = sdf_pose(closing)  # a joint's pose is relative to its child
    X_AF = np.linalg.inv(X_ML[link_a]) @ X_ML[link_b] @ X_BF
    (closure,) = four_bar.report["robot"]["closures"]
    assert (link_a, link_b) == (closure["link_a"], closure["link_b"]) == ("coupler", "rocker")
    np.testing.assert_allclose(X_AF, reported_pose(closure["pose_a"]), atol=1e-9)
    np.testing.assert_allclose(X_BF, reported_pose(closure["pose_b"]), atol=1e-9)
    axis = closing.find("axis/xyz")
    assert not axis.attrib
    np.testing.assert_allclose(numbers(axis.text), closure["axis"], atol=1e-9)
    # The model could be wrong, too: position and direction of the pin in closed form.
    pin = expected()["joints"]["rocker_pin"]
    X_MF = X_ML[link_b] @ X_BF
    np.testing.assert_allclose(X_MF[:3, 3], pin["frame"]["position"], atol=1e-9)
    np.testing.assert_allclose(X_MF[:3, :3] @ numbers(axis.text), pin["axis"], atol=1e-9)


def test_sdformat_holds_the_loop_and_fixes_the_base(four_bar: Conversion) -> None:
    """Of the rocker's two joints one closes the loop; the base is fixed by a joint and is not static."""
    model = etree.parse(four_bar.file(".sdf")).getroot().find("model")
    children = [joint.findtext("child") for joint in model.iter("joint")]
    assert sorted(children) == ["coupler", "crank", "ground", "rocker", "rocker"]
    (world,) = (joint for joint in model.iter("joint") if joint.findtext("parent") == "world")
    assert (world.get("type"), world.findtext("child")) == ("fixed", "ground")
    assert model.find("static") is None


def test_urdf_is_the_spanning_tree_and_reports_the_omitted_closure(four_bar: Conversion) -> None:
    """Each link has one parent joint; the omitted closure is named on the terminal and in the report."""
    root = etree.parse(four_bar.file(".urdf")).getroot()
    joints = {joint.get("name"): joint for joint in root.findall("joint") if joint.get("type") != "fixed"}
    assert set(joints) == {"crank_turn", "coupler_turn", "rocker_swing"}
    top, X_TL = urdf_links(root)
    assert top == "ground"
    carried = {"crank": "crank_turn", "coupler": "coupler_turn", "rocker": "rocker_swing"}
    for link, joint in carried.items():
        frame = expected()["joints"][joint]["frame"]
        np.testing.assert_allclose(X_TL[link], _pose_of(frame), atol=1e-9)
        axis = X_TL[link][:3, :3] @ numbers(joints[joint].find("axis").get("xyz"))
        np.testing.assert_allclose(axis, expected()["joints"][joint]["axis"], atol=1e-9)
    (stated,) = (entry for entry in four_bar.report["diagnostics"] if entry["code"] == "SB760:closure")
    assert stated["file"] == "four_bar.urdf"
    assert "'rocker_pin'" in stated["message"]
    assert "warning[SB760:closure]" in four_bar.run.err
    reported = {
        (check["file"], check["engine"]): (check["status"], check["why"])
        for check in four_bar.report["checks"]
        if check["quantity"] == "closures"
    }
    assert reported["four_bar.urdf", "mujoco"] == ("not run", "URDF cannot represent closed loops")


def _pose_of(frame: Mapping[str, Any]) -> np.ndarray:
    X = pose(frame["position"], (0, 0, 0))
    X[:3, :3] = frame["rotation"]
    return X


@pytest.mark.slow
@pytest.mark.pybullet
def test_pybullet_closes_the_urdf_by_a_constraint(four_bar: Conversion) -> None:
    """With the constraint of the report, at 1 ms steps and 1 rad/s, the pin stays within 1e-5 m of its bore."""
    pytest.importorskip("pybullet")
    (closure,) = four_bar.report["robot"]["closures"]
    ends = {
        "link_a": closure["link_a"],
        "p_A": closure["pose_a"]["xyz"],
        "link_b": closure["link_b"],
        "p_B": closure["pose_b"]["xyz"],
    }
    file = str(four_bar.file(".urdf"))
    seen = call_isolated("tests.engines:closed_in_pybullet", file, ends, "crank_turn", 1.0)
    assert seen["gaps"]["closed"] < 1e-5
    assert seen["gaps"]["open"] > 1e-2  # without the constraint the same motion opens the loop
    assert seen["positions"][-1]["crank_turn"] >= 2 * pi
    assert max(map(_error, seen["positions"])) < 1e-4


@pytest.mark.mujoco
@pytest.mark.parametrize("suffix", [".xml", ".urdf"])
def test_links_have_the_mass_of_the_closed_forms(four_bar: Conversion, suffix: str) -> None:
    """Masses of the links in MuJoCo, in the drawn pose, are within 1e-3 of the closed forms."""
    (seen,) = call_isolated("tests.engines:mujoco_bodies", str(four_bar.file(suffix)), [{}])
    for name, link in expected()["links"].items():
        assert max(deviations(seen[name], link)) < 1e-3, name


def test_every_check_that_an_engine_can_make_has_passed(four_bar: Conversion) -> None:
    """The verdict names all formats as proven, nothing failed, and each omitted check has a reason."""
    summary = four_bar.report["summary"]
    assert summary["failed"] == 0
    has_sdf_reader = any(map(find_spec, ("pybullet", "pydrake")))
    proven = "URDF, SDFormat and MJCF" if has_sdf_reader else "URDF and MJCF"
    (verdict,) = (line for line in four_bar.run.out.splitlines() if line.startswith("proven: "))
    assert verdict.startswith(f"proven: {proven} match the CAD in ")
    assert "MuJoCo" in verdict
    for check in four_bar.report["checks"]:
        assert check["status"] in ("passed", "not run"), check
        assert check["why"] or check["status"] == "passed", check
    passed = {(c["file"], c["engine"]) for c in four_bar.report["checks"] if c["status"] == "passed"}
    assert passed >= {("four_bar.urdf", "mujoco"), ("four_bar.urdf", "yourdfpy"), ("four_bar.xml", "mujoco")}
