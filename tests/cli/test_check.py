"""``stepbot check``: findings on standard output as text, concise text and JSON, with and without the STEP."""

import json
from pathlib import Path

import pytest

from .conftest import Stepbot


def damage(sidecar: Path, old: str, new: str) -> None:
    """Replace a part of a sidecar."""
    text = sidecar.read_text(encoding="utf-8")
    assert old in text
    sidecar.write_text(text.replace(old, new), encoding="utf-8")


def test_clean_sidecar_is_ok(arm: Path, stepbot: Stepbot) -> None:
    """A sidecar without findings prints its counts of links and joints, nothing with -q, and needs no STEP."""
    (arm / "arm2.step").unlink()
    run = stepbot("check", "arm2.robot.yaml")
    assert (run.code, run.out, run.err) == (0, "ok: 5 links, 4 joints; STEP not read (--step)\n", "")
    for option in ("-q", "--concise"):
        assert stepbot("check", "arm2.robot.yaml", option).out == ""


def test_each_of_several_sidecars_is_ok_or_not(arm: Path, stepbot: Stepbot) -> None:
    """With several sidecars, those without errors are listed."""
    bad = arm / "bad.robot.yaml"
    bad.write_text((arm / "arm2.robot.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    damage(bad, "child: forearm", "child: forarm")
    run = stepbot("check")
    assert run.code == 1
    (line,) = [line for line in run.out.splitlines() if "ok: " in line]
    assert line == "arm2.robot.yaml: ok: 5 links, 4 joints; STEP not read (--step)"


def test_all_faults_at_once_with_frames(arm: Path, stepbot: Stepbot) -> None:
    """Two errors in one file are reported together, each with its code frame, below the verdict that counts them."""
    damage(arm / "arm2.robot.yaml", "base: fixed", "base: fixxed")
    damage(arm / "arm2.robot.yaml", "child: forearm", "child: forarm")
    run = stepbot("check", "arm2.robot.yaml")
    assert (run.code, run.err) == (1, "")
    assert "arm2.robot.yaml:6:7: error[" in run.out
    assert "6 | base: fixxed" in run.out
    assert "did you mean 'forearm'?" in run.out
    assert run.out.startswith("arm2.robot.yaml: 2 errors\n")
    assert run.out.count("2 errors") == 1
    assert run.out.splitlines()[-1].startswith("next: stepbot explain SB")
    assert stepbot("check", "arm2.robot.yaml", "-q").out.startswith("arm2.robot.yaml:6:7: error[")


def test_errors_of_a_sidecar_keep_its_step_from_being_read(arm: Path, stepbot: Stepbot) -> None:
    """What `--step` asks for was not done: the output states it, so that nobody waits for findings of the CAD."""
    damage(arm / "arm2.robot.yaml", "child: forearm", "child: forarm")
    run = stepbot("check", "--step", "arm2.robot.yaml")
    assert run.out.startswith("arm2.robot.yaml: 1 error; STEP not read, correct these first\n")
    assert "STEP not read" not in stepbot("check", "arm2.robot.yaml").out
    damage(arm / "arm2.robot.yaml", "child: forarm", "child: forearm")
    (arm / "arm2.step").unlink()
    run = stepbot("check", "--step", "arm2.robot.yaml")
    assert "SB001" in run.out
    assert "STEP not read" not in run.out


def test_concise_is_one_line_each(arm: Path, stepbot: Stepbot) -> None:
    """`--concise` prints one line per finding."""
    damage(arm / "arm2.robot.yaml", "child: forearm", "child: forarm")
    run = stepbot("check", "--concise", "arm2.robot.yaml")
    assert len(run.out.splitlines()) == 1
    assert run.out.startswith("arm2.robot.yaml:")
    assert ": error[" in run.out


def test_json_is_one_document(arm: Path, stepbot: Stepbot) -> None:
    """`--json` prints one document with files, findings and exit code."""
    damage(arm / "arm2.robot.yaml", "child: forearm", "child: forarm")
    run = stepbot("check", "--json", "arm2.robot.yaml")
    document = json.loads(run.out)
    assert document["files"] == ["arm2.robot.yaml"]
    assert document["exit_code"] == run.code == 1
    assert {d["file"] for d in document["diagnostics"]} == {"arm2.robot.yaml"}


def test_several_files(arm: Path, stepbot: Stepbot) -> None:
    """Findings of several files are in the order of the arguments; a missing file does not hide the others."""
    bad = arm / "bad.robot.yaml"
    bad.write_text((arm / "arm2.robot.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    damage(bad, "child: forearm", "child: forarm")
    run = stepbot("check", "--concise", "gone.robot.yaml", "arm2.robot.yaml", "bad.robot.yaml")
    assert [line.partition(":")[0] for line in run.out.splitlines()] == ["gone.robot.yaml", "bad.robot.yaml"]
    assert run.code == 2


@pytest.mark.parametrize("arguments", [["--step", "arm2.robot.yaml"], ["arm2.robot.yaml", "--step", "arm2.step"]])
def test_against_the_step(arm: Path, stepbot: Stepbot, arguments: list[str]) -> None:
    """`--step`, alone or with a file, finds component names that are not in the CAD."""
    damage(arm / "arm2.robot.yaml", "{parts: [forearm]}", "{parts: [forarm]}")
    assert stepbot("check", "arm2.robot.yaml").code == 0
    run = stepbot("check", *arguments)
    assert run.code == 1
    assert "error[SB301]: link 'forearm': no component 'forarm' in arm2.step" in run.out


def test_one_step_is_not_that_of_all_sidecars_of_a_folder(arm: Path, stepbot: Stepbot) -> None:
    """A STEP on the command line is compared with, and locked for, the sidecars that are named, and no others."""
    (arm / "other.robot.yaml").write_text((arm / "arm2.robot.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    for command in (("check", "--fix"), ("check",), ("lock",)):
        run = stepbot(*command, "--step", "arm2.step")
        assert run.code == 2
        named = "name the one that describes it, for example `--step arm2.step arm2.robot.yaml`"
        assert f"--step arm2.step: 2 sidecars were found; {named}" in " ".join(run.err.split())
    assert not list(arm.glob("*.lock.json"))
    assert stepbot("check", "--step", "arm2.step", "arm2.robot.yaml", "other.robot.yaml").code == 0


def test_strict_counts_warnings(arm: Path, stepbot: Stepbot) -> None:
    """A clean sidecar stays clean under --strict."""
    assert stepbot("check", "--strict", "arm2.robot.yaml").code == 0
