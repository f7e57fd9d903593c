"""Independent engines detect the removal of any element or attribute of a written file."""

import os
from collections import Counter
from collections.abc import Sequence
from math import sqrt
from pathlib import Path

import pytest

from tests.robots import ROBOTS
from tests.simulators.conftest import skip_without, write

from .changed import LIBRARY, WANTED, library_builds, section
from .changed import OF_EACH as OF_EACH_OF_LIBRARY
from .changes import changes
from .judge import Judge, question
from .page import ALL, CORE, PAGE, ROWS, counted, page, share
from .reasons import NO_REASON, reason_for
from .removal import removals
from .siblings import FORMATS, Noticed, trials
from .trial import Flawed, verdicts

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="engines crash here, in forks of this process")

SLICE = ("two_link_arm",)
OF_EACH = 12
OF_EACH_LONG = 4
"""Removals per file; all of them, some 14,000, take hours: `make mutation`."""

XML = b"""<?xml version="1.0"?>
<!-- a comment is no element -->
<robot name="r"><link name="a"><inertial/></link><transmission name="t"><joint name="j"/></transmission></robot>
"""


def test_everything_is_removed_once() -> None:
    """Every element but the root is removed with its content, and every attribute; blocks and settings are marked."""
    found = {one.path: one for one in removals(XML, "urdf")}
    assert list(found) == [
        "robot[r]@name",
        "robot[r]/link[a]",
        "robot[r]/link[a]@name",
        "robot[r]/link[a]/inertial",
        "robot[r]/transmission[t]",
        "robot[r]/transmission[t]@name",
        "robot[r]/transmission[t]/joint[j]",
        "robot[r]/transmission[t]/joint[j]@name",
    ]
    assert [path for path, one in found.items() if one.unread] == list(found)[4:]
    assert b"<link" not in found["robot[r]/link[a]"].content
    assert b"<transmission" in found["robot[r]/link[a]"].content
    assert Counter(one.kind for one in found.values())["robot/link"] == 1
    settings = [one for one in removals(b'<mujoco><option timestep="1"/><worldbody/></mujoco>', "mjcf") if one.unread]
    assert [one.path for one in settings] == ["mujoco/option", "mujoco/option@timestep"]


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.mujoco
def test_a_slice_is_noticed(tmp_path: Path) -> None:
    """Some removals from each file of an arm are detected, or have a documented reason."""
    for engines in CORE.values():
        for engine in engines:
            skip_without(engine)
    found = list(verdicts({name: ROBOTS[name] for name in SLICE}, CORE, tmp_path, OF_EACH))
    assert Counter(one.format for one in found) == dict.fromkeys(CORE, OF_EACH)
    lost = [one for one in found if not one.noticed and not one.removal.unread]
    for one in lost:
        assert reason_for(one.format, one.removal.kind, core=True) != NO_REASON
    assert [one.removal.path for one in lost if one.format != "sdf"] == []
    assert len(lost) < OF_EACH / 2


@pytest.mark.mujoco
def test_what_changes_nothing_is_not_noticed(tmp_path: Path) -> None:
    """The judge accepts an unchanged file, and rejects another robot."""
    skip_without("mujoco")
    folder = write(ROBOTS["pendulum"](), tmp_path)
    path = folder.written["mjcf"].path
    asked = question(folder.request("mjcf"))
    with Judge("mujoco", asked, folder.expected("mjcf", asked)) as judge:
        assert judge.look_at_right(str(path)) == ""
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("<worldbody>", "<statistic/><worldbody>"), encoding="utf-8")
        assert judge.look_at(str(path)) == ""
        path.write_text(text.replace("</mujoco>", ""), encoding="utf-8")
        assert judge.look_at(str(path)).startswith("refuses")
        path.write_text(text.replace('mass="', 'mass="1'), encoding="utf-8")
        assert judge.look_at(str(path)).startswith("mass")


@pytest.mark.mujoco
def test_a_file_that_is_flawed_from_the_start_is_no_trial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file with defects before any removal is rejected, since every removal would count as detected."""
    skip_without("mujoco")
    monkeypatch.setattr("tests.mutation.judge.Judge.look_at_right", lambda judge, file: "sees another robot")
    with pytest.raises(Flawed, match=r"one_link\.xml: mujoco: sees another robot"):
        list(verdicts({"one_link": ROBOTS["one_link"]}, {"mjcf": ("mujoco",)}, tmp_path))


@pytest.mark.long
def test_everything_is_noticed(tmp_path: Path) -> None:
    """Many removals from every file reach the required shares, and all undetected ones have a reason.

    The share of a sample is off by its standard deviation, twice of which is allowed: 2.5 % for 130 removals and 98 %.
    """
    for engine in ("pybullet", "mujoco", "yourdfpy", "drake"):
        skip_without(engine)
    found = list(verdicts(ROBOTS, ALL, tmp_path, OF_EACH_LONG))
    assert [line for line in page(found, None).splitlines() if NO_REASON in line] == []
    for row in ROWS:
        chance = 2.0 * sqrt(row.wanted * (1.0 - row.wanted) / len(counted(row, found)))
        assert share(row, found) >= row.wanted - chance, f"{row.title} by {row.engines}"


def test_changes_are_beyond_the_tolerance() -> None:
    """Zeros, lengths of directions, and changes within the tolerance are omitted."""
    text = (
        b'<robot name="r"><link name="a"><inertial><origin xyz="0.1 1e-12 0"/><mass value="2"/>'
        b'<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="1e-11" ixz="1e-3" iyz="0"/></inertial></link>'
        b'<joint name="j" type="revolute"><axis xyz="0 0 1"/><limit upper="1e9"/></joint></robot>'
    )
    found = {one.path.rpartition("/")[2] + one.old: one for one in changes(text, "seed")}
    expected = {"inertia@ixx0.1", "inertia@iyy0.1", "inertia@izz0.1", "inertia@ixz1e-3", "mass@value2", "origin@xyz0.1"}
    assert expected == {name for name in found if not name.startswith(("axis", "limit"))}
    assert all(float(one.new) < 0.0 for name, one in found.items() if name.startswith(("axis", "limit")))
    mass = found["mass@value2"]
    assert mass.kind == "inertial/mass@value"
    assert f'value="{mass.new}"'.encode() in mass.content
    assert [one.content for one in changes(text, "seed")] == [one.content for one in changes(text, "seed")]


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.mujoco
@pytest.mark.parametrize(
    ("name", "of_each"),
    [("equipped", 2), *(pytest.param(name, 8, marks=pytest.mark.long) for name in ("equipped", "two_link_arm"))],
)
def test_changed_numbers_are_noticed(name: str, of_each: int, tmp_path: Path) -> None:
    """`verify` and the conversion detect at least 97 % of changed numbers, with a reason for the rest."""
    for engine in ("yourdfpy", "mujoco", "pybullet"):
        skip_without(engine)
    found = list(trials({name: ROBOTS[name]}, tmp_path, of_each))
    assert len(found) == len(FORMATS) * of_each
    _assert_noticed(found)


@pytest.mark.long
def test_changed_numbers_of_the_library_are_noticed(tmp_path: Path) -> None:
    """Three hundred changes are detected in robots with sensors, keyframes, mimics, loops and ball joints."""
    for engine in ("yourdfpy", "mujoco", "pybullet"):
        skip_without(engine)
    found = list(trials(library_builds(LIBRARY), tmp_path, OF_EACH_OF_LIBRARY))
    assert len(found) >= 300
    _assert_noticed(found)


def _assert_noticed(noticed: Sequence[Noticed]) -> None:
    assert [line for line in section(noticed, "command").splitlines() if NO_REASON in line] == []
    for by in ("by_verify", "by_conversion"):
        lost = [f"{one.format}: {one.change.path} {one.change.old}" for one in noticed if not getattr(one, by)]
        assert 1.0 - len(lost) / len(noticed) >= WANTED, lost


def test_the_page_is_there() -> None:
    """The page has a line for every row."""
    text = PAGE.read_text(encoding="utf-8")
    for row in ROWS:
        assert f"| {row.title} | {row.engines} | " in text
