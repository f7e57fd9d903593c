"""The verdict on a robot in words."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.pipeline.verdict import compared_words, proof_words, robot_words
from stepbot.report.robot import Check, Report, Status
from tests import robots

MUJOCO = Check("a.urdf", "urdf", "mujoco", "mass", Status.PASSED, 2.5e-16, 1e-9, "kg", "link 'arm'")
BULLET = Check("a.sdf", "sdf", "pybullet", "mass", Status.PASSED, 3.4e-6, 2e-5, "m", "link 'arm'")
INERTIA = Check("a.sdf", "sdf", "reader", "inertia", Status.PASSED, 1e-16, 1e-9, "kg")
NO_DRAKE = Check("a.sdf", "sdf", "drake", "inertia", Status.NOT_RUN, why="drake is not installed")
NO_NEWTON = Check("a.usda", "usd", "newton", "mass", Status.NOT_RUN, why="newton is not installed")
WRONG = Check("a.xml", "mjcf", "mujoco", "limits", Status.FAILED, 0.5, 1e-9, "rad", "joint 'elbow'")


def words(*checks: Check) -> tuple[str, ...]:
    """The lines about these checks."""
    return proof_words(Report(checks=checks, own_parsers=("reader",)), "the CAD")


def test_proven_formats_with_their_engines() -> None:
    """Formats that an engine confirms are proven; what own parsers alone confirm is listed, with what adds engines."""
    assert words(MUJOCO) == ("proven: URDF matches the CAD in MuJoCo (1 check)",)
    assert words(MUJOCO, BULLET, INERTIA, NO_DRAKE) == (
        "proven: URDF and SDFormat match the CAD in MuJoCo and PyBullet (3 checks)",
        "  by stepbot's parsers alone: inertia of SDFormat; `pip install 'stepbot[verify]'` adds Drake",
    )


def test_what_is_not_proven() -> None:
    """A format that no engine read is never proven, and one that own parsers alone read neither."""
    assert words(MUJOCO, NO_NEWTON) == (
        "proven: URDF matches the CAD in MuJoCo (1 check)",
        "not proven: OpenUSD: no installed engine reads it; `pip install 'stepbot[newton]'` adds Newton",
    )
    assert words(INERTIA) == ("not proven: SDFormat: only stepbot's own parser reads it",)
    assert words() == ("not verified: no engine loaded the files",)


def test_a_failure_comes_first() -> None:
    """The format that differs is named with engine and quantity, before those that are proven."""
    first, second = words(MUJOCO, WRONG)
    assert first == "NOT PROVEN: MJCF differs from the CAD in MuJoCo: limits (1 of 2 checks failed)"
    assert second == "proven: URDF matches the CAD in MuJoCo (1 check)"
    loop = Check("", "", "stepbot", "closures", Status.FAILED, why="open")
    assert words(loop) == ("NOT PROVEN: the robot itself: closures (1 of 1 check failed)",)


@pytest.mark.parametrize(
    ("checks", "line"),
    [
        ((MUJOCO, BULLET), "equal: a.urdf and a.sdf are the same robot in MuJoCo and PyBullet (2 checks)"),
        ((MUJOCO, WRONG), "different: a.xml: limits (1 of 2 checks)"),
        ((MUJOCO,), "not compared: a.sdf could not be read"),
        ((NO_DRAKE,), "not verified: no engine could load a.urdf and a.sdf"),
    ],
)
def test_compared_files(checks: tuple[Check, ...], line: str) -> None:
    """Files are equal, different, or not verified."""
    assert compared_words(Report(checks=checks), (Path("a.urdf"), Path("a.sdf"))) == (line,)


def test_robot_in_one_line() -> None:
    """Links, joints, loops, freedom and mass; one of a kind is singular."""
    four_bar = robots.four_bar()
    assert robot_words(four_bar).startswith("four_bar: 4 links, 4 joints (1 closes a loop), 1 degree of freedom, ")
    tree = replace(four_bar, closures=())
    assert robot_words(tree).startswith("four_bar: 4 links, 3 joints, 3 degrees of freedom, ")


def test_files_that_own_parsers_alone_read() -> None:
    """A file with features that no engine of the core install reads is compared by stepbot's own parser."""
    report = Report(checks=(INERTIA,), own_parsers=("reader",))
    assert compared_words(report, [Path("a.sdf")]) == (
        "equal: a.sdf is the same robot in stepbot's own parser alone (1 check)",
    )
