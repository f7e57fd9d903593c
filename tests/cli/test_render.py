"""``stepbot render`` and ``stepbot inspect --picture``: pictures of sidecars and STEP files."""

import functools
import json
import math
import shutil
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from PIL import Image

from stepbot.pictures import picture as pictures
from stepbot_cli.render import read_positions
from tests import parts
from tests.cli.conftest import Stepbot
from tests.composition.described import box, composing, joint, link, urdf
from tests.robots import ROBOTS

SMALL = ("--size", "200x150", "--samples", "1")


@pytest.fixture
def four_bar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path) -> Path:
    """The current folder, with the four-bar linkage of the library."""
    for file in ("four_bar.robot.yaml", "four_bar.step"):
        shutil.copy(robot_library / "stepbot_four_bar" / file, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def rendered(stepbot: Stepbot, *arguments: str) -> dict[str, Any]:
    """The JSON document of a picture that was drawn."""
    run = stepbot("render", *arguments, "--json")
    assert run.code == 0, run.out
    document: dict[str, Any] = json.loads(run.out)
    return document


@pytest.mark.slow
def test_a_sidecar_gives_a_picture_of_its_robot(arm: Path, stepbot: Stepbot) -> None:
    """The file is named after the sidecar and has the size of the option; every link has a place in it."""
    run = stepbot("render", "arm2.robot.yaml", *SMALL)
    assert (run.code, run.out, run.err) == (0, "arm2.png\n", "")
    picture = Image.open(BytesIO((arm / "arm2.png").read_bytes()))
    assert (picture.size, picture.mode) == ((200, 150), "RGB")
    document = rendered(stepbot, "arm2.robot.yaml", *SMALL, "-o", "again.png")
    assert (arm / "again.png").read_bytes() == (arm / "arm2.png").read_bytes()
    assert {"base", "upper_arm", "forearm"} <= set(document["places"]) | set(document["hidden"])
    pixels = np.asarray(picture).astype(int)
    for x, y in document["places"].values():  # no place is on the paper
        assert pixels[int(y), int(x)].min() < 225


@pytest.mark.slow
def test_a_loop_closes_at_the_given_position(four_bar: Path, stepbot: Stepbot) -> None:
    """The other joints follow; where that is impossible, the end of the way is reported."""
    document = rendered(stepbot, "four_bar.robot.yaml", *SMALL, "--joint", "crank_turn=60deg")
    assert document["positions"]["crank_turn"] == "60 deg"
    assert set(document["positions"]) == {"crank_turn", "coupler_turn", "rocker_swing"}
    run = stepbot("render", "four_bar.robot.yaml", *SMALL, "--joint", "rocker_swing=-15deg")
    assert run.code == 2
    assert "the loops or the limits of other joints stop the mechanism on its way there, at rocker_swing=" in run.err


def test_a_wrong_position_is_reported(arm: Path, stepbot: Stepbot) -> None:
    """With the joint, the reason and a remedy; nothing is written."""
    run = stepbot("render", "arm2.robot.yaml", *SMALL, "--joint", "sholder=3")
    assert run.code == 2
    assert "Invalid value for --joint: joint 'sholder' does not exist; did you mean 'shoulder'?" in run.err
    assert not (arm / "arm2.png").exists()


@pytest.mark.parametrize(
    ("robot", "text", "message"),
    [
        ("two_link_arm", "elbow", "'elbow' is not NAME=VALUE, such as elbow=30deg"),
        ("two_link_arm", "elbow=3 mm", "joint 'elbow': wrong unit 'mm': expected angle [rad]"),
        ("two_link_arm", "elbow=999deg", "joint 'elbow': 999 deg is outside its limits, "),
        ("two_link_arm", "elbow=60", "; if the unit is deg, write elbow=60deg"),
        ("two_link_arm", "elbow=fast", "joint 'elbow': invalid quantity 'fast'"),
        ("gripper_with_mimic", "finger=3deg", "joint 'finger': wrong unit 'deg': expected length [m]"),
        ("gripper_with_mimic", "thumb_pivot=0", "joint 'thumb_pivot' follows 'finger'; set 'finger' instead"),
        ("ball", "shoulder=1", "has no position of its own; shoulder_yaw or shoulder_pitch or shoulder_roll"),
        ("four_bar", "rocker_pin=1", "joint 'rocker_pin' has no position of its own; "),
        ("one_link", "elbow=1", "joint 'elbow' does not exist; the robot has no moving joint"),
    ],
)
def test_a_position_is_checked_against_its_joint(robot: str, text: str, message: str) -> None:
    """Form, name, unit and limits; a mimic, a closure and a joint of several degrees of freedom have none."""
    with pytest.raises(click.BadParameter) as caught:
        read_positions(ROBOTS[robot](), [text])
    assert message in str(caught.value)


def test_positions_have_units() -> None:
    """Degrees, millimetres, or plain SI."""
    assert read_positions(ROBOTS["two_link_arm"](), ["elbow=30deg"]) == {"elbow": pytest.approx(math.pi / 6)}
    assert read_positions(ROBOTS["two_link_arm"](), ["elbow = 0.25"]) == {"elbow": 0.25}
    assert read_positions(ROBOTS["gripper_with_mimic"](), ["finger=12 mm"]) == {"finger": pytest.approx(0.012)}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("arm2.robot.yaml", "--view", "fornt"), "unknown view 'fornt'; did you mean 'front'?"),
        (("arm2.robot.yaml", "--view", "10,95"), "the elevation up to 90 degrees"),
        (("arm2.robot.yaml", "-o", "arm.jpg"), "'arm.jpg' is not a PNG file"),
        (("arm2.robot.yaml", "--size", "huge"), "'huge' is not a size such as 1200x900"),
        (("arm2.step", "--joint", "a=1"), "a STEP file has no joints; give a sidecar"),
    ],
)
def test_wrong_usage_is_reported(arguments: tuple[str, ...], message: str, arm: Path, stepbot: Stepbot) -> None:
    """Exit code 2, with the reason."""
    run = stepbot("render", *arguments)
    assert run.code == 2
    assert message in " ".join(run.err.split())


def test_a_missing_package_is_reported_before_the_step_is_read(
    arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the command that installs the extra."""
    monkeypatch.setitem(sys.modules, "embreex", None)
    for command in (("render", "missing.robot.yaml"), ("inspect", "missing.step", "--picture", "arm.png")):
        run = stepbot(*command)
        assert run.code == 2
        assert "error[SB003]: Python package missing: no module named 'embreex'" in run.err
        assert "pip install 'stepbot[render]'" in run.err


def test_a_file_that_cannot_be_written_is_reported(arm: Path, stepbot: Stepbot) -> None:
    """SB004, exit code 2."""
    (arm / "taken").write_text("")
    run = stepbot("render", "arm2.step", *SMALL, "-o", "taken/arm.png")
    assert run.code == 2
    assert "taken/arm.png: error[SB004]: cannot write" in run.err


def test_errors_of_the_sidecar_end_without_a_picture(arm: Path, stepbot: Stepbot) -> None:
    """The diagnostics are those of `stepbot check --step`."""
    sidecar = arm / "arm2.robot.yaml"
    sidecar.write_text(sidecar.read_text(encoding="utf-8").replace("parent:", "parrent:", 1), encoding="utf-8")
    run = stepbot("render", "arm2.robot.yaml", *SMALL)
    assert run.code == 1
    assert "parrent" in run.err
    assert not (arm / "arm2.png").exists()


def test_a_step_file_gives_a_picture_of_its_assembly(arm: Path, stepbot: Stepbot) -> None:
    """Names of the children of the root are the labels."""
    document = rendered(stepbot, "arm2.step", "--labels", *SMALL)
    assert document["positions"] == {}
    assert document["places"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "suffix", [pytest.param("urdf", marks=pytest.mark.long), pytest.param("sdf", marks=pytest.mark.long), "xml"]
)
def test_a_description_gives_the_picture_of_its_sidecar(suffix: str, arm: Path, stepbot: Stepbot) -> None:
    """Links of the file are where those of the sidecar are, at the same positions of the joints."""
    assert stepbot("convert", "arm2.robot.yaml", "-o", "out", "--no-verify").code == 0
    pose = ("--joint", "shoulder=40deg", "--joint", "elbow=20deg", "--joint", "finger=5mm", *SMALL)
    expected = rendered(stepbot, "arm2.robot.yaml", *pose)["places"]
    found = rendered(stepbot, f"out/arm2.{suffix}", *pose)
    assert found["positions"]["shoulder"] == "40 deg"
    for name, place in expected.items():
        assert found["places"][name] == pytest.approx(place, abs=4.0), name


def test_a_missing_target_is_reported(arm: Path, stepbot: Stepbot) -> None:
    """SB001, exit code 2."""
    for name in ("gone.robot.yaml", "gone.step", "gone.urdf"):
        run = stepbot("render", name)
        assert run.code == 2
        assert "error[SB001]" in run.err


@pytest.mark.slow
def test_an_exploded_view_names_the_listed_components(
    tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All parts, each name once; --depth and --filter select them as they select rows."""
    monkeypatch.setattr(pictures, "Sheet", functools.partial(pictures.Sheet, width=300, height=225, samples=1))
    parts.write_hinge(tmp_path / "hinge.step", bolts=True)
    picture = tmp_path / "hinge.png"
    run = stepbot("inspect", str(tmp_path / "hinge.step"), "--picture", str(picture))
    assert run.code == 0
    assert run.out.splitlines()[-1] == picture.as_posix()
    whole = np.asarray(Image.open(BytesIO(picture.read_bytes())))
    assert whole.shape == (225, 300, 3)
    run = stepbot("inspect", str(tmp_path / "hinge.step"), "--picture", str(picture), "--depth", "0", "--json")
    assert json.loads(run.out)["picture"] == picture.as_posix()
    assert (np.asarray(Image.open(BytesIO(picture.read_bytes()))) != whole).any()


def test_a_module_is_drawn_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot) -> None:
    """Its links and the axes between them, without what it is attached to; other names are errors that list them."""
    monkeypatch.chdir(tmp_path)
    hand = urdf(
        "hand",
        link("palm", more=box(0.1, 0.1, 0.1)),
        link("tip", more=box(0.1, 0.1, 0.1)),
        joint("j", "palm", "tip", xyz="0 0 0.3"),
    )
    (tmp_path / "hand.urdf").write_text(hand, encoding="utf-8")
    modules = ("a: {file: hand.urdf}", "b: {file: hand.urdf, at: a/tip, offset: {xyz: [0.5, 0, 0]}}")
    (tmp_path / "r.robot.yaml").write_text(composing(*modules), encoding="utf-8")
    document = rendered(stepbot, "r.robot.yaml", *SMALL, "--labels", "--module", "b")
    assert set(document["places"]) == {"b_palm", "b_tip"}
    assert {*document["hidden"], *document["unlabelled"]} <= {"b_palm", "b_tip", "b_j"}
    run = stepbot("render", "r.robot.yaml", *SMALL, "--module", "c")
    assert run.code == 2
    assert "no module 'c'; choose from a, b" in run.err
