"""``stepbot drive``: a robot's files driven in engines."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import engine_of
from stepbot.robot.model import Joint, JointKind, Limit
from tests.cli.conftest import Stepbot
from tests.unit.driving.workbench import HORIZONTAL, VERTICAL, gripper, looped_gripper, one_joint, written

pytestmark = [pytest.mark.mujoco]

INSTALL = {"mujoco": "pip install mujoco", "pybullet": "pip install pybullet-arm64"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a written arm in ``arm/`` and a gripper in ``gripper/``."""
    written(one_joint(HORIZONTAL, 150.0, 20.0), tmp_path / "arm")
    written(gripper(20.0), tmp_path / "gripper")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def untimed(document: dict[str, Any]) -> dict[str, Any]:
    """A document without the speeds, which are measured by the clock."""
    return {
        **document,
        "tests": [{k: v for k, v in one.items() if k != "steps_per_second"} for one in document["tests"]],
    }


@pytest.mark.slow
@pytest.mark.pybullet
def test_files_are_driven_and_stay_as_they_are(folder: Path, stepbot: Stepbot) -> None:
    """Every test that applies runs in both engines; the others have reasons; two runs give the same numbers."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    first = stepbot("drive", "arm", "--json")
    assert first.code == 0, first.out
    document = json.loads(first.out)
    assert [(one["test"], one["engine"]) for one in document["tests"]] == [
        (test, engine)
        for engine in ("mujoco", "pybullet")
        for test in ("hold", "step", "track", "sweep", "torque", "drop")
    ]
    assert set(document["inapplicable"]) == {"grip", "roll", "turn", "strafe", "stand"}
    assert all(one["steps_per_second"] > 0 for one in document["tests"])
    again = stepbot("drive", "arm", "--json")
    assert untimed(json.loads(again.out)) == untimed(document)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_a_limit_of_what_is_not_measured_is_named(folder: Path, stepbot: Stepbot) -> None:
    """A robot's own limit of a quantity that a test does not measure is listed, with what it measures."""
    limits = {
        "step": {"slip": [1, "of a gripper"], "overshoot with other gains": [25, "a rig"]},
        "grip": {"slip": [1, "no gripper"]},
    }
    (folder / "own.json").write_text(json.dumps({"drive": {"limits": limits}}), encoding="utf-8")
    ended = stepbot("drive", "arm/one_joint.xml", "--test", "step", "--limits", "own.json", "--json")
    assert ended.code == 0, ended.out
    stated = {key: why for key, why in json.loads(ended.out)["inapplicable"].items() if key.startswith("limit of")}
    assert stated.keys() == {"limit of slip in step"}
    assert "overshoot" in stated["limit of slip in step"]


def test_one_file_and_one_test(folder: Path, stepbot: Stepbot) -> None:
    """An MJCF is driven in MuJoCo alone, with the report beside it; the table has a line per test."""
    run = stepbot("drive", "arm/one_joint.xml", "--test", "step,hold", "--engine", "mujoco")
    assert run.code == 0, run.err
    lines = run.out.splitlines()
    assert [line.split()[:3] for line in lines[2:4]] == [["hold", "mujoco", "passed"], ["step", "mujoco", "passed"]]
    assert lines[0] == "driven: 2 tests: 2 passed, 0 failed"
    assert re.fullmatch(r"do not apply: .*roll.* \(-v shows why\)", lines[4])
    assert lines[-1] == "each number: -v    next: stepbot datasheet arm/one_joint.xml"
    verbose = stepbot("drive", "arm/one_joint.xml", "--test", "step,hold", "--engine", "mujoco", "-v").out.splitlines()
    assert any(line.startswith("roll does not apply: no velocity actuator") for line in verbose)


def test_a_robot_without_actuators_falls(folder: Path, stepbot: Stepbot) -> None:
    """Its other tests have one reason, and so one line."""
    written(replace(one_joint(VERTICAL, 1.0), actuators=()), folder / "limp")
    run = stepbot("drive", "limp", "--engine", "mujoco")
    assert run.code == 0, run.err
    (line,) = (line for line in run.out.splitlines() if "apply" in line)
    assert line.startswith("hold, step, track, ")
    assert line.endswith(" do not apply: the robot has no actuators")


def test_warnings_of_the_engine_leave_no_file(folder: Path, stepbot: Stepbot) -> None:
    """MuJoCo would write a log file into the current folder for a simulation that diverges."""
    written(one_joint(VERTICAL, 1e14, 1.0, 1e30), folder / "light")
    before = sorted(folder.rglob("*"))
    run = stepbot("drive", "light", "--engine", "mujoco", "--test", "step")
    assert run.code == 1
    assert "SB830" in run.err
    assert run.out.splitlines()[0] == "driven: 1 test: 0 passed, 1 failed"
    assert sorted(folder.rglob("*")) == before


def test_a_failure_names_place_number_limit_and_remedy(folder: Path, stepbot: Stepbot) -> None:
    """A limit of the robot's own is compared, and its reason is in the diagnostic."""
    (folder / "own.json").write_text(
        '{"drive": {"limits": {"hold": {"angle error with other gains": [0.001, "a test rig"]}}}}'
    )
    run = stepbot("drive", "arm", "--engine", "mujoco", "--test", "hold", "--limits", "own.json", "--json")
    assert run.code == 1
    (found,) = json.loads(run.out)["diagnostics"]
    assert (found["code"], found["file"]) == ("SB830", "one_joint.xml")
    assert found["message"].startswith("hold in mujoco: angle error with other gains of 'turn' is 0.0")
    assert found["message"].endswith("rad, limit 0.001 rad")
    assert found["notes"] == ["the limit: a test rig"]
    assert found["help"][0].startswith("raise kp")


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("nowhere",), "SB001", "file not found"),
        (("arm/report.json",), "SB833", "no file .xml of the report's robot"),
        (("arm", "--limits", "none.json"), "SB833", "cannot be read"),
        (("broken",), "SB833", "report.json is not JSON"),
        (("list",), "SB833", "report.json has no robot"),
        (("poor",), "SB833", "report.json is not the report of a robot"),
    ],
)
def test_bad_input(folder: Path, stepbot: Stepbot, arguments: tuple[str, ...], code: str, message: str) -> None:
    """What cannot be driven ends in a diagnostic and exit code 2."""
    for name, text in (("broken", "{"), ("list", "[]"), ("poor", '{"robot": {"name": "one_joint"}}')):
        written(one_joint(HORIZONTAL), folder / name)
        (folder / name / "report.json").write_text(text)
    run = stepbot("drive", *arguments, "--engine", "mujoco", "--json")
    document = json.loads(run.out)
    assert (run.code, document["exit_code"], document["robot"]) == (2, 2, None)
    (found,) = document["diagnostics"]
    assert found["code"] == code
    assert message in found["message"]


def test_a_step_file_is_drafted_first(folder: Path, stepbot: Stepbot) -> None:
    """A STEP has no joints, and no report to search for: the remedy is a draft."""
    (folder / "arm.step").write_text("ISO-10303-21;\n")
    run = stepbot("drive", "arm.step")
    assert run.code == 1
    assert "error[SB102]: sidecar: file is a STEP file" in run.err
    assert "`stepbot init arm.step`" in run.err


def test_a_file_of_an_earlier_conversion(folder: Path, stepbot: Stepbot) -> None:
    """A file that the report does not list is of another state of the robot."""
    document = json.loads((folder / "arm" / "report.json").read_bytes())
    document["files"] = [one for one in document["files"] if one["format"] != "mjcf"]
    (folder / "arm" / "report.json").write_text(json.dumps(document))
    run = stepbot("drive", "arm", "--engine", "mujoco", "--json")
    (found,) = json.loads(run.out)["diagnostics"]
    assert (run.code, found["code"], found["message"]) == (2, "SB833", "no file .xml of the report's robot")


@pytest.mark.pybullet
def test_more_joints_than_pybullet_reports(tmp_path: Path, stepbot: Stepbot) -> None:
    """PyBullet is not run, with the reason; where it alone is asked for, it is an error and not a crash."""
    robot = one_joint(HORIZONTAL)
    base, part = robot.links[0], replace(robot.links[-1], collisions=(), visuals=())
    more = tuple(replace(part, name=f"bolt_{n}") for n in range(127))
    bolted = (Joint(f"{one.name}_joint", JointKind.FIXED, base.name, one.name) for one in more)
    written(replace(robot, links=(*robot.links, *more), joints=(*robot.joints, *bolted)), tmp_path / "bolts")
    reason = "PyBullet reports the state of at most 127 joints, the file has 128"
    run = stepbot("drive", str(tmp_path / "bolts"), "--test", "drop", "--json")
    assert json.loads(run.out)["not_run"] == {"pybullet": reason}
    assert run.code == 0
    run = stepbot("drive", str(tmp_path / "bolts"), "--test", "drop", "--engine", "pybullet")
    assert f"error[SB832]: pybullet: {reason}" in run.err
    assert run.code == 1


def test_unknown_test_and_engine(folder: Path, stepbot: Stepbot) -> None:
    """A misspelt name is a usage error with the nearest one."""
    assert "did you mean 'sweep'" in stepbot("drive", "arm", "--test", "sweeep").err
    assert "did you mean 'mujoco'?" in stepbot("drive", "arm", "--engine", "mujoko").err


def missing(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Some engines are not installed."""
    for name in names:
        monkeypatch.setattr(engine_of(name), "available", lambda name=name: f"{name} is not installed")


@pytest.mark.slow
def test_without_pybullet_the_result_says_so(
    folder: Path, arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An engine that is not installed is not run, never passed; ``convert --drive`` does the same."""
    missing(monkeypatch, "pybullet")
    run = stepbot("drive", "gripper", "--test", "hold,grip", "--json")
    document = json.loads(run.out)
    assert (run.code, document["diagnostics"]) == (0, [])
    assert document["not_run"] == {"pybullet": "pybullet is not installed"}
    assert [(one["test"], one["engine"], one["status"]) for one in document["tests"]] == [
        ("hold", "mujoco", "passed"),
        ("grip", "mujoco", "passed"),
    ]
    lines = stepbot("drive", "gripper", "--test", "hold,grip").out.splitlines()
    assert lines[0] == "driven: 2 tests: 2 passed, 0 failed; not run in pybullet"
    assert lines[-2] == "not run in pybullet: pybullet is not installed"
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--no-verify", "--drive", "--json")
    assert json.loads(run.out)["drive"]["not_run"] == {"pybullet": "pybullet is not installed"}
    assert run.code == 0


@pytest.mark.slow
def test_without_mujoco_nothing_is_gripped(folder: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Poses are chosen without contacts, and the reason why no cube is gripped is MuJoCo's absence."""
    missing(monkeypatch, "mujoco")
    run = stepbot("drive", "gripper", "--json")
    document = json.loads(run.out)
    assert run.code == 0
    assert document["not_run"] == {"mujoco": "mujoco is not installed"}
    assert {one["engine"] for one in document["tests"]} == {"pybullet"}
    assert document["inapplicable"]["grip"] == "needs the MJCF and MuJoCo, in which grasps are found"


@pytest.mark.parametrize(
    ("absent", "arguments", "missed"),
    [
        (("pybullet",), ("arm", "--engine", "pybullet"), ("pybullet",)),
        (("pybullet",), ("arm", "--engine", "mujoco,pybullet"), ("pybullet",)),
        (("pybullet",), ("arm/one_joint.urdf",), ("pybullet",)),
        (("mujoco", "pybullet"), ("arm",), ("mujoco", "pybullet")),
    ],
    ids=["demanded", "one of two demanded", "file of that engine", "none installed"],
)
def test_an_engine_that_is_needed_is_exit_code_2(
    folder: Path,
    stepbot: Stepbot,
    monkeypatch: pytest.MonkeyPatch,
    absent: tuple[str, ...],
    arguments: tuple[str, ...],
    missed: tuple[str, ...],
) -> None:
    """Nothing is driven without a demanded engine, or if no engine is left for the files."""
    missing(monkeypatch, *absent)
    run = stepbot("drive", *arguments, "--json")
    document = json.loads(run.out)
    assert (run.code, document["tests"]) == (2, [])
    assert [one["message"] for one in document["diagnostics"]] == [
        f"drive in {name}: {name} is not installed" for name in missed
    ]
    assert {one["code"] for one in document["diagnostics"]} == {"SB005"}
    assert document["diagnostics"][0]["help"][0] == INSTALL[missed[0]]
    other = "or drive in the installed engine: --engine mujoco"
    assert (other in document["diagnostics"][0]["help"]) == (absent == ("pybullet",))


@pytest.mark.slow
def test_a_file_without_its_other_engine(folder: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """PyBullet drives no MJCF, so that its absence is not worth a word there."""
    missing(monkeypatch, "pybullet")
    run = stepbot("drive", "arm/one_joint.xml", "--test", "hold", "--json")
    assert (run.code, json.loads(run.out)["not_run"]) == (0, {})


@pytest.mark.slow
def test_a_sweep_that_covers_a_part_of_the_range_says_so(folder: Path, stepbot: Stepbot) -> None:
    """A range that is not covered is in the table, with its numbers and what stops the sweep, although it passes."""
    robot = looped_gripper(1.0)
    joints = (
        replace(joint, limit=Limit(-0.005, 0.03)) if joint.name == "left_guide" else joint for joint in robot.joints
    )
    written(replace(robot, joints=tuple(joints)), folder / "looped")
    arguments = ("drive", "looped", "--engine", "mujoco", "--test", "sweep")
    (line,) = (line for line in stepbot(*arguments).out.splitlines() if line.startswith("sweep covers"))
    assert re.fullmatch(
        r"sweep covers 5\d % of the range of turn: -74.48 to 1\d\.?\d* deg of -74.48 to 74.48 deg; "
        "stopped above by the limit of left_guide",
        line,
    ), line
    (found,) = json.loads(stepbot(*arguments, "--json").out)["ranges"]
    assert (found["joint"], found["unit"], found["limits"]) == ("turn", "rad", [-1.3, 1.3])
    assert found["stops"] == ["", "the limit of left_guide"]
    assert "sweep covers" not in stepbot("drive", "gripper", "--engine", "mujoco", "--test", "sweep").out


@pytest.mark.slow
def test_columns_line_up_and_limits_have_units(folder: Path, stepbot: Stepbot) -> None:
    """The speeds end below each other, and a limit has the unit of its quantity."""
    _, head, *rows = (
        line
        for line in stepbot("drive", "gripper", "--engine", "mujoco", "--test", "hold,step,grip").out.splitlines()
        if "apply" not in line and "next: " not in line
    )
    end = head.index("steps/s") + len("steps/s")
    assert all(row[:end].rstrip() == row[:end] and row[end : end + 2] == "  " for row in rows), rows
    for row in rows:
        worst, limit = row.split(", limit ")
        assert limit.split()[-1] == worst.split()[-1] in ("mm", "rad", "%")


def test_a_time_limit_ends_a_drive(folder: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """A drive that takes too long is reported with the engine."""
    monkeypatch.setattr(
        "stepbot.pipeline.driving.located", lambda formats, *others, **more: ({path: path for path in formats}, {})
    )
    run = stepbot("drive", "gripper", "--engine", "mujoco", "--timeout", "0.01", "--json")
    document = json.loads(run.out)
    assert run.code == 1
    assert [one["code"] for one in document["diagnostics"]] == ["SB832"]


def test_plots_are_the_same_bytes_in_two_runs(folder: Path, stepbot: Stepbot) -> None:
    """One SVG for each test; without times and random names inside."""
    pytest.importorskip("matplotlib")
    for name in ("one", "two"):
        assert stepbot("drive", "arm", "--engine", "mujoco", "--test", "hold,drop", "--plots", name).code == 0
    drawn = sorted((folder / "one").iterdir())
    assert [path.name for path in drawn] == ["drop.svg", "hold.svg"]
    for path in drawn:
        assert path.read_bytes() == (folder / "two" / path.name).read_bytes()


@pytest.mark.slow
def test_files_of_a_conversion_whose_drive_fails(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Failing drive tests move no file: the folder that is printed has them."""

    def fails(target: Path, options: object, chosen: object, diagnostics: Diagnostics, progress: object) -> None:
        diagnostics.add("SB832", "stopped", Span(target.as_posix()))

    monkeypatch.setattr("stepbot.pipeline.driving.drive", fails)
    run = stepbot("convert", "arm2.robot.yaml", "-o", "out", "--no-verify", "--drive")
    assert run.code == 1
    assert " files in out" in run.out
    assert (arm / "out" / "arm2.urdf").exists()
    assert json.loads(stepbot("convert", "arm2.robot.yaml", "-o", "out", "--drive", "--json").out)["output"] == "out"
