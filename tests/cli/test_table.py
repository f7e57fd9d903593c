"""The table of engine checks."""

import re

import pytest

from stepbot.report.robot import Check, Report, Status
from stepbot_cli.columns import aligned, cells
from stepbot_cli.table import show_table

PASSED = Check("a.urdf", "urdf", "mujoco", "mass", Status.PASSED, 2.5e-16, 1e-9, "kg", "link 'arm'")
LINKS = Check("a.urdf", "urdf", "mujoco", "links", Status.PASSED)
NOT_TOLD = Check("a.urdf", "urdf", "mujoco", "meshes", Status.NOT_RUN, why="mujoco does not report it")
FAILED = Check("a.sdf", "sdf", "pybullet", "mass", Status.FAILED, 0.5, 1e-9, "kg", "link 'arm'", why="0.5 kg too heavy")
ABSENT = Check("a.xml", "mjcf", "pybullet", "mass", Status.NOT_RUN, why="pybullet is not installed")


def table(capsys: pytest.CaptureFixture[str], *checks: Check) -> list[str]:
    """Lines of the table for some checks."""
    show_table(Report(checks=checks, own_parsers=("reader", "extensions")))
    return capsys.readouterr().out.splitlines()


def test_one_line_per_file_and_engine(capsys: pytest.CaptureFixture[str]) -> None:
    """A row has the number of comparisons, the worst deviation and the result."""
    lines = table(capsys, LINKS, PASSED, NOT_TOLD, FAILED, ABSENT)
    assert [re.split(r"  +", line) for line in lines[:4]] == [
        ["format", "file", "engine", "result", "quantities", "worst deviation"],
        ["urdf", "a.urdf", "mujoco", "passed", "2", "2.5e-16 kg, tolerance 1e-09: link 'arm'"],
        ["sdf", "a.sdf", "pybullet", "failed", "1", "5.0e-01 kg, tolerance 1e-09: link 'arm'"],
        ["mjcf", "a.xml", "pybullet", "not run", "-", "mass not run: pybullet is not installed"],
    ]


def test_reasons_and_counts(capsys: pytest.CaptureFixture[str]) -> None:
    """Below the table are failures, reasons for not run, and counts; not run is never counted as passed."""
    lines = table(capsys, LINKS, PASSED, NOT_TOLD, FAILED, ABSENT)
    assert "a.urdf in mujoco: meshes not run: mujoco does not report it" in lines
    assert "a.sdf in pybullet: mass: 0.5 kg too heavy" in lines
    assert lines[-1] == "5 checks: 2 passed, 1 failed, 2 not run"


def test_what_own_parsers_say_is_counted_apart(capsys: pytest.CaptureFixture[str]) -> None:
    """Checks passed only by stepbot's own parser are counted in a separate line."""
    own = Check("a.urdf", "urdf", "extensions", "sensors", Status.PASSED)
    lines = table(capsys, PASSED, own)
    assert lines[-2].startswith("1 passed by stepbot's parsers only")
    assert lines[-1] == "2 checks: 2 passed, 0 failed, 0 not run"


def test_what_files_are_compared_with(capsys: pytest.CaptureFixture[str]) -> None:
    """For files compared with each other the table names the reference."""
    other = Check("a.sdf", "sdf", "pybullet", "mass", Status.PASSED, 0.0, 1e-9, "kg", against="a.urdf (mujoco)")
    head, _, line, *_ = table(capsys, PASSED, other)
    assert "compared with" in head
    assert "a.urdf (mujoco)" in line


@pytest.mark.parametrize("width", [60, 80, 120])
def test_columns_wrap_each_on_its_own(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, width: int
) -> None:
    """On a narrow screen each cell wraps within its column; no word is lost."""
    monkeypatch.setenv("COLUMNS", str(width))
    where = "colour of visual 'forearm_visual_3' of link 'forearm' at configuration 31"
    far = Check("机器人.urdf", "urdf", "mujoco", "mass", Status.PASSED, 2.5e-16, 1e-9, "kg", where)
    lines = table(capsys, far)
    assert max(map(cells, lines)) <= width
    last = [line[lines[0].index("worst") - 3 :] for line in lines[1 : lines.index("")]]
    words = re.sub(r"\s+", "", "".join(last))
    assert where.replace(" ", "") in words


def test_columns_are_straight_for_wide_names() -> None:
    """A Chinese character takes two columns, a combining accent none."""
    assert cells("机器人") == 6
    assert cells("e\u0301") == 1
    assert aligned([("机", "x"), ("abc", "y")]) == ["机   x", "abc  y"]
