"""``stepbot diff``: STEP files by component, sidecars by robot, robot files by what engines load."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from robot_library.moments import pose
from tests.revisions import LEVER, Revision, write_lever
from tests.solids import box

from .conftest import Stepbot


@pytest.fixture
def lever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Revision:
    """The current folder, with ``old.step``; a revision to write to ``new.step``."""
    monkeypatch.chdir(tmp_path)
    return Revision(write_lever(tmp_path / "old.step"))


def differences(stepbot: Stepbot, old: str, new: str, code: int) -> list[dict[str, Any]]:
    """The rows of the document that ``--json`` prints."""
    run = stepbot("diff", "--json", old, new)
    document = json.loads(run.out)
    assert (run.code, document["exit_code"]) == (code, code)
    rows: list[dict[str, Any]] = document["differences"]
    return rows


@pytest.mark.slow
def test_every_kind_of_change_in_a_step(lever: Revision, stepbot: Stepbot) -> None:
    """Each change is one row: renamed, moved, reshaped, removed, added; two exports of one assembly have none."""
    lever.write(Path("same.step"))
    assert differences(stepbot, "old.step", "same.step", 0) == []
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).move("beam:1", pose((0, 5.0, 0)))
    lever.reshape("plate", box(80, 80, 12).shape).remove_number("M3", 2)
    lever.copy("XL430:1", "spare:1", pose((0, -40.0, 0))).write(Path("new.step"))
    rows = differences(stepbot, "old.step", "new.step", 1)
    assert [(row["kind"], row["name"], row.get("new_name")) for row in rows] == [
        ("renamed", "base/M3#3", "base/M3#2"),
        ("renamed", "base/M3#4", "base/M3#3"),
        ("renamed", "arm/motor", "arm/XL430:1"),
        ("reshaped", "base/plate", None),
        ("moved", "arm/beam", None),
        ("removed", "base/M3#2", None),
        ("added", "arm/spare:1", None),
    ]
    assert rows[4]["amount"] == pytest.approx(0.005, abs=1e-9)
    assert "volume" in rows[3]["detail"]


@pytest.mark.slow
def test_sidecars_are_compared_by_their_robots(lever: Revision, stepbot: Stepbot) -> None:
    """Sidecars are compared by their robots: limits, masses and frames differ, the order of keys does not."""
    shutil.copy("old.step", "lever.step")
    Path("a.robot.yaml").write_text(LEVER, encoding="utf-8")
    Path("b.robot.yaml").write_text("# the same\n" + LEVER.replace("[beam, motor]", "[motor, beam]"), encoding="utf-8")
    assert differences(stepbot, "a.robot.yaml", "b.robot.yaml", 0) == []
    text = LEVER.replace("upper: 0.2", "upper: 0.7") + "parts: {motor: {mass: 50 g}}\n"
    Path("b.robot.yaml").write_text(text + "frames: {tip: {link: arm, origin: {center: motor}}}\n", encoding="utf-8")
    rows = differences(stepbot, "a.robot.yaml", "b.robot.yaml", 1)
    found = {(row["kind"], row["name"]): row.get("amount") for row in rows}
    assert found["limits", "upper limit of joint 'hinge'"] == pytest.approx(0.5, abs=1e-12)
    assert found["mass", "mass of link 'arm'"] == pytest.approx(0.002, rel=1e-9)
    assert ("frames", "frame 'tip' is new") in found
    limit = next(row for row in rows if row["kind"] == "limits")
    assert (limit["old"], limit["new"], limit["unit"]) == (0.2, 0.7, "rad")
    assert limit["detail"] == "11.46 -> 40.11 deg (+250 %)"


def test_the_table_of_robots(lever: Revision, stepbot: Stepbot) -> None:
    """A motion is one row; boxes of single shapes are counted where their link has a row, and listed with -v."""
    shutil.copy("old.step", "lever.step")
    Path("a.robot.yaml").write_text(LEVER, encoding="utf-8")
    text = LEVER.replace("lower: -0.2", "lower: -inf").replace("{type:", "{zero: 10 deg, type:")
    Path("b.robot.yaml").write_text(text, encoding="utf-8")
    rows = [row.split("  ") for row in stepbot("diff", "a.robot.yaml", "b.robot.yaml").out.splitlines()]
    cells = [[cell.strip() for cell in row if cell] for row in rows]
    assert ["limits", "lower limit of joint 'hinge'", "-11.46 deg -> unlimited"] in cells
    assert not any("box of visual '" in row[-1] for row in rows)
    (count,) = (row[0] for row in rows if len(row) == 1)
    assert count.endswith("of single shapes (-v lists them)")
    verbose = stepbot("diff", "a.robot.yaml", "b.robot.yaml", "-v").out
    assert "box of visual '" in verbose
    assert verbose.count("\n") > len(rows)


URDF = """<robot name="arm">
  <link name="base"><inertial>
    <mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial>
    <mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""


@pytest.mark.slow
@pytest.mark.mujoco
def test_robots_are_compared_as_engines_load_them(tmp_path: Path, stepbot: Stepbot) -> None:
    """Robot files, or folders of them, are compared as engines load them: equal, or with another mass and limit."""
    for name, text in (
        ("old", URDF),
        ("new", URDF.replace('value="2"', 'value="2.5"').replace('upper="1"', 'upper="2"')),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / "arm.urdf").write_text(text, encoding="utf-8")
    old, new = tmp_path / "old", tmp_path / "new"
    assert differences(stepbot, str(old), str(old / "arm.urdf"), 0) == []
    rows = differences(stepbot, str(old), str(new), 1)
    found = {(row["kind"], row["name"]): row.get("amount") for row in rows}
    assert found["mass", "mass of link 'arm'"] == pytest.approx(0.5, rel=1e-9)
    assert found["limits", "upper limit of joint 'hinge'"] == pytest.approx(1.0, rel=1e-9)
    run = stepbot("diff", str(old), str(new))
    assert f"differences between {(old / 'arm.urdf').as_posix()} and {(new / 'arm.urdf').as_posix()}" in run.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("old.step", "gone.step"), "SB001"),
        (("gone", "old"), "file not found"),
        (("gone", "old.step"), "gone: error[SB001]: file not found"),
        (("empty", "empty"), "no URDF, SDFormat or MJCF file in this folder"),
        (("old.step", "a.robot.yaml"), "cannot compare a step with a sidecar"),
        (("a.robot.yaml", "a.robot.yaml"), "SB102"),
        (("broken.urdf", "broken.urdf"), "SB814"),
    ],
)
def test_what_cannot_be_read_ends_in_code_2(
    arguments: tuple[str, str], words: str, lever: Revision, stepbot: Stepbot
) -> None:
    """A missing or unreadable file ends in exit code 2."""
    Path("empty").mkdir()
    Path("a.robot.yaml").write_text("# nothing\n", encoding="utf-8")
    Path("broken.urdf").write_text("<robot", encoding="utf-8")
    run = stepbot("diff", *arguments)
    assert (run.code, run.out) == (2, "")
    assert words in run.err
