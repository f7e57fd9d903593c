"""Every robot of the library passes its drive tests, with its files as they were written."""

import json
import re
from pathlib import Path

import pytest

from stepbot.runtime.robot_library import library_robot
from stepbot_cli import main
from tests.library.conftest import LIBRARY, ROBOTS, Converted

PASSED = re.compile(r"\d+ passed")
GRIPPING = {"abb_yumi", "franka_hand", "kuka_youbot", "robotiq_2f85", "stepbot_arm2", "stepbot_desk_arm"}
"""Robots that grip a cube."""
QUICK = ("stepbot_four_bar",)
"""Robots whose tests take seconds."""


@pytest.mark.pybullet
@pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=pytest.mark.slow if robot in QUICK else pytest.mark.long) for robot in ROBOTS]
)
def test_robot_passes_its_drive_tests(robot: str, converted: Converted, capsys: pytest.CaptureFixture[str]) -> None:
    """In both engines; the numbers and limits of a failure are in the message."""
    folder = converted(robot).folder
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    code = main(["drive", str(folder), "--limits", str(LIBRARY / robot / "expected.json"), "--json"])
    document = json.loads(capsys.readouterr().out)
    assert [one["message"] for one in document["diagnostics"]] == []
    assert code == 0
    assert {one["engine"] for one in document["tests"]} == {"mujoco", "pybullet"}
    assert all(one["status"] == "passed" for one in document["tests"])
    assert ("grip" in {one["test"] for one in document["tests"]}) == (robot in GRIPPING)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


@pytest.mark.long
@pytest.mark.pybullet
@pytest.mark.parametrize(("robot", "mass"), [("franka_hand", 1.0), ("robotiq_2f85", 2.5)])
def test_gripper_holds_objects_of_all_sizes_and_shapes(
    robot: str, mass: float, converted: Converted, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In both engines none sinks in by 1 mm or slips by 2 mm."""
    limits = tmp_path / "limits.json"
    objects = [["cube", 0.02], ["cube", 0.05], ["cube", 0.08], ["cylinder", 0.05], ["sphere", 0.05]]
    demands = {"tests": ["grip"], "cube": mass, "objects": objects}
    limits.write_text(json.dumps({"drive": demands}), encoding="utf-8")
    options = ["--test", "grip", "--limits", str(limits), "--json"]
    code = main(["drive", str(converted(robot).folder), *options])
    document = json.loads(capsys.readouterr().out)
    assert [one["status"] for one in document["tests"]] == ["passed", "passed"], document
    assert not [name for name in document["inapplicable"] if name.startswith("grip")], document
    assert code == 0


@pytest.mark.long
@pytest.mark.parametrize(("robot", "mass"), [("franka_hand", 1.0), ("robotiq_2f85", 2.5)])
def test_gripper_holds_with_the_force_of_its_data_sheet(
    robot: str, mass: float, converted: Converted, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In MuJoCo the cube slips by 1 mm at most, and sinks in by 0.5 mm at most."""
    limits = tmp_path / "limits.json"
    bounds = {"grip": {"penetration": [0.5, "rigid fingers"], "slip": [1.0, "half of the usual limit"]}}
    limits.write_text(json.dumps({"drive": {"tests": ["grip"], "cube": mass, "limits": bounds}}), encoding="utf-8")
    options = ["--test", "grip", "--engine", "mujoco", "--limits", str(limits), "--json"]
    code = main(["drive", str(converted(robot).folder), *options])
    document = json.loads(capsys.readouterr().out)
    assert [one["status"] for one in document["tests"]] == ["passed"], document
    assert code == 0


@pytest.mark.long
@pytest.mark.pybullet
@pytest.mark.parametrize(("robot", "test"), [("ur5e_2f85", "grip"), ("panda_hand", "grip"), ("dog", "stand")])
def test_composed_robots_do_as_their_modules(
    robot: str, test: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A gripper holds its cube on an arm, too, and a trunk with one leg four times stands, in both engines."""
    sidecar = library_robot(robot).sidecar
    code = main(["drive", str(sidecar), "--test", test, "--cache", str(tmp_path), "--json"])
    document = json.loads(capsys.readouterr().out)
    seen = {(one["test"], one["engine"], one["status"]) for one in document["tests"]}
    assert seen == {(test, engine, "passed") for engine in ("mujoco", "pybullet")}, document
    assert code == 0


def test_a_mecanum_base_moves_as_its_tilted_rollers_say() -> None:
    """A youBot's roller carries over 60 degrees of its wheel, so that its axis is tilted: cos is 0.955 on average.

    With the speeds that a level roller needs, the base would strafe 4.5 % and turn 2.7 % less than it does.
    """
    numbers = {(row[0], row[1]): row[3] for row in library_robot("kuka_youbot").table("Drive tests")[1:]}
    for engine in ("mujoco", "pybullet"):
        turned, strafed = numbers["turn", engine].split()[2], numbers["strafe", engine].split()[2]
        assert float(turned) < 1.0
        assert float(strafed) < 1.5


def test_gallery_counts_the_drive_tests_of_each_robot() -> None:
    """Each row of the gallery has the number of drive tests that passed, and none that failed."""
    gallery = LIBRARY.joinpath("README.md").read_text(encoding="utf-8")
    for robot in ROBOTS:
        (row,) = (line for line in gallery.splitlines() if line.startswith(f"| [{robot}]"))
        assert PASSED.fullmatch(row.split("|")[3].strip()), row
