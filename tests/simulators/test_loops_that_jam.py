"""Loops that do not close, or cannot move, because of inaccurate drawing."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Pose
from stepbot.report.robot import Status
from stepbot.robot.model import JointDynamics, JointKind, Robot
from stepbot.verification.conversion import Provers, verify
from tests.conftest import ReadDiagnostics
from tests.robots import crooked_four_bar, four_bar
from tests.simulators.conftest import skip_without, write


@pytest.mark.slow
def test_a_loop_that_cannot_stay_closed_is_a_warning(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A loop that opens as it moves is one warning per robot; the files represent the CAD, so their checks pass."""
    folder = write(crooked_four_bar(5e-5), tmp_path)
    with Provers(folder.written) as provers:
        report = verify(folder.robot, folder.written, provers, diagnostics, timeout=120.0)
    (warning,) = diagnostics
    assert warning.code == "SB818"
    assert warning.message.startswith("closure 'rocker_pin' opens by up to ")
    assert report.degrees_of_freedom == 1
    assert not report.failed


@pytest.mark.slow
def test_a_mechanism_that_cannot_move_is_a_warning(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A loop with a weld in place of a pin cannot move, which is a warning."""
    robot = four_bar()
    welded = replace(robot, closures=(replace(robot.closures[0], kind=JointKind.FIXED),))
    folder = write(welded, tmp_path)
    with Provers(folder.written) as provers:
        report = verify(folder.robot, folder.written, provers, diagnostics, timeout=120.0)
    assert diagnostics.codes() == ["SB819"]
    assert report.degrees_of_freedom == 0
    assert report.driven == ()
    assert not report.failed


def test_a_loop_that_is_open_as_drawn_is_an_error(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A loop that is open as drawn is an error, and no engine runs."""
    robot = four_bar()
    closure = robot.closures[0]
    away = Pose.of(closure.X_BF.R, closure.X_BF.p + np.array([0.0, 0.0, 0.5]))
    folder = write(replace(robot, closures=(replace(closure, X_BF=away),)), tmp_path)
    with Provers(folder.written) as provers:
        report = verify(folder.robot, folder.written, provers, diagnostics)
    assert diagnostics.codes() == ["SB808"]
    assert [check.status for check in report.checks] == [Status.FAILED]


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.parametrize("name", ["rocker", "coupler"])
def test_loops_close_whatever_their_links_weigh(name: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A link of tons in a light loop: the solver converged late, and the loop was open by a tenth of a millimetre."""
    robot = four_bar()
    own = robot.link_by_name[name].mass_properties
    inertia = tuple(tuple(1e5 * value for value in row) for row in own.inertia)
    heavy = replace(own, mass=1e5 * own.mass, inertia=inertia)
    links = tuple(replace(one, mass_properties=heavy) if one.name == name else one for one in robot.links)
    assert not _failed(replace(robot, links=links), tmp_path, diagnostics)


@pytest.mark.slow
def test_a_spring_in_a_loop_holds_it_open_in_no_engine(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Drake's constraints give way to a spring, by 5e-5 rad in the joints that follow; loops are closed without it."""
    skip_without("drake")
    robot = four_bar()
    spring = JointDynamics(stiffness=20.0, spring_reference=0.5)
    joints = tuple(replace(one, dynamics=spring) if one.name == "coupler_pin" else one for one in robot.joints)
    assert not _failed(replace(robot, joints=joints), tmp_path, diagnostics)


def _failed(robot: Robot, path: Path, diagnostics: Diagnostics) -> bool:
    folder = write(robot, path)
    with Provers(folder.written) as provers:
        return verify(folder.robot, folder.written, provers, diagnostics, timeout=120.0).failed
