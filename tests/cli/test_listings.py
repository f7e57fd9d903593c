"""``stepbot formats``, ``stepbot schema``, and the width of listings."""

import json
from pathlib import Path

import jsonschema
import pytest

from stepbot.formats import FORMATS
from stepbot.runtime.robot_library import library_robots
from stepbot_cli.columns import cells

from .conftest import Stepbot


def test_formats_are_those_that_are_found(stepbot: Stepbot) -> None:
    """`formats` lists every writer with its file, aliases and limitations."""
    run = stepbot("formats")
    assert run.code == 0
    formats, _, made_from_them = run.out.partition("\n\n")
    assert [line.split()[0] for line in formats.splitlines() if not line.startswith(" ")] == list(FORMATS)
    assert max(map(len, formats.splitlines())) <= 100
    assert all(what in made_from_them for what in ("--ros2", "--gazebo", "stepbot.gym"))
    assert "alias sdformat" in run.out
    assert "not written, with a diagnostic" in run.out


def test_formats_as_json(stepbot: Stepbot) -> None:
    """`formats --json` has every feature with its level."""
    document = json.loads(stepbot("formats", "--json").out)
    (urdf,) = [one for one in document["formats"] if one["name"] == "urdf"]
    assert urdf["suffix"] == ".urdf"
    assert urdf["notions"]["mimic"]["level"] == "exact"


@pytest.mark.slow
def test_schema_is_a_schema(stepbot: Stepbot) -> None:
    """`schema` prints a valid JSON Schema that accepts a small sidecar and rejects an unknown key."""
    schema = json.loads(stepbot("schema").out)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    sidecar = {"version": 1, "robot": "arm", "step": "arm.step", "links": {"base": {"rest": True}}}
    assert validator.is_valid(sidecar)
    assert not validator.is_valid({**sidecar, "colour": "red"})


@pytest.mark.parametrize("columns", ["60", "80", "200"])
@pytest.mark.parametrize(
    "command", ["formats", "library list", "explain SB203", "explain SB304", "cache info", "--help"]
)
def test_a_listing_fits_the_screen(
    command: str, columns: str, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No line is wider than the terminal; only a path, which cannot be broken, may be."""
    monkeypatch.setenv("COLUMNS", columns)
    run = stepbot(*command.split())
    assert run.code == 0
    wide = [line for line in run.out.splitlines() if cells(line) > int(columns) and "/" not in line]
    assert wide == []


def test_a_listing_in_a_pipe_has_one_line_for_each_item(stepbot: Stepbot) -> None:
    """So that grep and cut work."""
    lines = stepbot("library", "list").out.splitlines()
    assert len(lines) == len(library_robots())


def test_a_table_of_joints_is_wrapped(stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nine columns fit 80 characters."""
    monkeypatch.setenv("COLUMNS", "80")
    run = stepbot("library", "show", "delta")
    assert [line for line in run.out.splitlines() if cells(line) > 80 and "/" not in line] == []


def test_shared_axes_fit_the_screen(stepbot: Stepbot, arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`inspect --between` is wrapped at spaces on a terminal, and has one line for each axis in a pipe."""
    between = ("inspect", "arm2.step", "--between", "base", "shoulder")
    piped = stepbot(*between).out.splitlines()
    assert len(piped) == 2
    monkeypatch.setenv("COLUMNS", "60")
    wrapped = stepbot(*between).out.splitlines()
    assert max(map(cells, wrapped)) <= 60
    assert " ".join(" ".join(wrapped).split()) == " ".join(" ".join(piped).split())
