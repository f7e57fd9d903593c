"""Every robot of the library passes its drive tests, with its files as they were written."""

import json
import re
import shutil
from pathlib import Path

import pytest

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
def test_franka_hand_holds_a_kilogram(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With its continuous gripping force of 70 N and contacts of 4 ms the hand holds 1 kg, 0.2 mm deep at most."""
    shutil.copytree(LIBRARY / "franka_hand", tmp_path / "hand")
    sidecar = tmp_path / "hand" / "hand.robot.yaml"
    text = sidecar.read_text(encoding="utf-8").replace("kp: 1000, kv: 50", "kp: 10000, kv: 60, limits: {effort: 70 N}")
    sidecar.write_text(text.replace("defaults: {", "defaults: {contact: {softness: 4 ms}, "), encoding="utf-8")
    limits = tmp_path / "limits.json"
    bounds = {"grip": {"penetration": [0.2, "rigid fingers"]}}
    limits.write_text(json.dumps({"drive": {"tests": ["grip"], "cube": 1.0, "limits": bounds}}), encoding="utf-8")
    options = ["--test", "grip", "--engine", "mujoco", "--limits", str(limits), "--json"]
    code = main(["drive", str(sidecar), *options])
    document = json.loads(capsys.readouterr().out)
    assert [one["status"] for one in document["tests"]] == ["passed"], document
    assert code == 0


def test_gallery_counts_the_drive_tests_of_each_robot() -> None:
    """Each row of the gallery has the number of drive tests that passed, and none that failed."""
    gallery = LIBRARY.joinpath("README.md").read_text(encoding="utf-8")
    for robot in ROBOTS:
        (row,) = (line for line in gallery.splitlines() if line.startswith(f"| [{robot}]"))
        assert PASSED.fullmatch(row.split("|")[3].strip()), row
