"""Invalid arguments: message and remedy, in text and JSON."""

import json
import sys
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.draft.draft import Confidence, Draft, DraftLink
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.starter import starter_name

from .conftest import Stepbot


@pytest.mark.parametrize(
    ("arguments", "command", "words"),
    [
        (["convert", "a.yaml", "--nope"], "stepbot convert", "No such option"),
        (["convert"], "stepbot convert", "Missing argument"),
        (["converrt"], "stepbot", "did you mean 'convert'?"),
        (["library", "exprot", "ur5e"], "stepbot library", "did you mean 'export'?"),
        (["explain", "SB000"], "stepbot explain", "unknown code 'SB000'"),
        (["convert", "a.yaml", "--no-verify", "--require", "mujoco"], "stepbot convert", "--require"),
        (["convert", "a.yaml", "-f", "urdf", "mjcf", "sdf"], "stepbot convert", "commas: `-f urdf,mjcf,sdf`"),
        (["batch", "-o", "out", "--format", "urdf", "mujoco", "a.yaml"], "stepbot batch", "commas: `-f urdf,mujoco`"),
        (["convert", "a.yaml", "-f", "ros2"], "stepbot convert", "a ROS 2 package is written by `--ros2 NAME`"),
        (["convert", "a.yaml", "-f", "gymnasium"], "stepbot convert", "`-f mjcf`, then `stepbot.gym.make` in Python"),
        (["convert", "a.yaml", "-f", "isaac-sim"], "stepbot convert", "it reads OpenUSD: `-f usd`"),
        (["convert", "a.yaml", "--density", "1000"], "stepbot convert", "`density` is set in the sidecar, under"),
        (["convert", "a.yaml", "arm.step"], "stepbot convert", "the sidecar names its STEP file; `--step FILE`"),
    ],
)
def test_usage_errors_are_json_where_json_was_asked_for(
    stepbot: Stepbot, arguments: list[str], command: str, words: str
) -> None:
    """A bad option, missing argument or unknown command is SB010, in JSON if requested; exit code 2."""
    run = stepbot(*arguments)
    assert (run.code, run.out) == (2, "")
    assert run.err.startswith(f"Usage: {command} ")
    if command != "stepbot explain":
        assert words in run.err
    run = stepbot(*arguments, "--json")
    document = json.loads(run.out)
    assert document["exit_code"] == run.code == 2
    assert run.err == ""
    (found,) = document["diagnostics"]
    assert (found["code"], found["file"], found["help"]) == ("SB010", command, [f"`{command} --help`"])
    if command != "stepbot explain":  # the command has no --json, which is the error here
        assert words in found["message"]


def test_unknown_command_without_neighbours_lists_all(stepbot: Stepbot) -> None:
    """An unknown command without similar names lists all commands."""
    assert "choose from init, convert, batch, inspect" in stepbot("xyzzy").err


@pytest.mark.parametrize("value", ["abc", "0", "-1", "nan", "inf", "5 min"])
def test_invalid_timeout_is_rejected(stepbot: Stepbot, value: str) -> None:
    """An invalid time limit is rejected with the accepted form."""
    run = stepbot("convert", "a.yaml", "--timeout", value)
    assert run.code == 2
    assert f"'{value}' is not a positive number of seconds, such as 600" in run.err


@pytest.mark.parametrize("value", ["abc", "0", "1.5"])
def test_invalid_jobs_are_rejected(stepbot: Stepbot, value: str) -> None:
    """An invalid number of cores is rejected with the accepted form."""
    run = stepbot("batch", ".", "-o", "out", "-j", value)
    assert run.code == 2
    assert f"'{value}' is not a positive number of cores" in run.err


@pytest.mark.parametrize("given", [("-f", "urdf,sdf"), ("-f", "urdf, sdformat", "-f", "sdf")])
def test_formats_in_a_list(arm: Path, stepbot: Stepbot, given: tuple[str, ...]) -> None:
    """`-f urdf,sdf` is `-f urdf -f sdf`."""
    run = stepbot("convert", "arm2.robot.yaml", "--no-verify", "-o", "out", "--json", *given)
    assert run.code == 0
    files = {Path(name).suffix for name in json.loads(run.out)["files"] if "/" not in name}
    assert files == {".urdf", ".sdf", ".json"}


def test_unknown_format_in_a_list(stepbot: Stepbot) -> None:
    """An unknown format in a list is reported by its name alone."""
    run = stepbot("convert", "arm2.robot.yaml", "-f", "urdf,udrf")
    assert run.code == 2
    assert "unknown format 'udrf'; did you mean 'urdf'?" in run.err


@pytest.mark.parametrize("command", ["convert", "check"])
def test_step_in_place_of_a_sidecar(arm: Path, stepbot: Stepbot, command: str) -> None:
    """The message about a STEP argument has the command that drafts a sidecar, and inspect; the draft is valid."""
    run = stepbot(command, "arm2.step", "--json")
    assert run.code == 1
    (found,) = json.loads(run.out)["diagnostics"]
    assert found["code"] == "SB102"
    init, inspect = found["help"]
    assert "`stepbot init arm2.step`" in init
    assert "`stepbot inspect arm2.step`" in inspect


@pytest.mark.parametrize(
    "name",
    [
        "XL,XC 330 v1.step",
        "机器人.stp",
        "a: b #1.step",
        "true.step",
        "true",
        "007.step",
        "-x.step",
        "it's.step",
        'a "b".step',
        "a\\b*?.step",
        "....step",
        "a\nb.step",
        "x" * 200 + ".step",
    ],
)
def test_draft_of_any_file_name(name: str) -> None:
    """A drafted sidecar is valid and names its STEP, whatever the file name."""
    diagnostics = Diagnostics()
    draft = Draft(Path(name).stem, "base", (DraftLink("base", (), Confidence(1.0), rest=True),))
    sidecar = parse_sidecar(sidecar_text(draft, name), Path(starter_name(Path(name))), diagnostics)
    assert list(diagnostics) == []
    assert sidecar is not None
    assert sidecar.document.step == name


def test_missing_dask_names_the_extra(arm: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--scheduler` without Dask reports what to install, with stepbot's version bounds."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    run = stepbot("batch", str(arm), "-o", "out", "--scheduler", "tcp://127.0.0.1:1")
    assert run.code == 2
    assert "error[SB003]: Python package missing: no module named 'distributed'" in run.err
    assert "pip install 'stepbot[dask]'" in run.err
