"""The constraints of report.json close loops of the written URDF in PyBullet, added as a user would."""

from pathlib import Path
from typing import Any

import pytest

import stepbot
from stepbot.diagnostics import Diagnostics
from stepbot.engines.pybullet.body import body_of
from stepbot.report.document import report_document
from stepbot.report.robot import Report
from stepbot.robot.closures import closure_gap
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import Robot
from tests.closed_mechanisms import delta, sliding_closure, stewart, welded
from tests.robots import four_bar, two_link_arm
from tests.simulators.conftest import skip_without, write


def _widest_gap(robot: Robot, file: Path, report: dict[str, Any] | None, erp: float | None = None) -> float:
    """Gap [m] of loops in half a second of a sideways fall, with and without the constraints of a report."""
    import pybullet as engine

    client = engine.connect(engine.DIRECT)
    try:
        engine.setPhysicsEngineParameter(enableFileCaching=0, numSolverIterations=200)
        engine.setTimeStep(1e-3)
        engine.setGravity(3.0, -9.0, -3.0)
        loaded = engine.loadURDF(str(file), useFixedBase=True, flags=engine.URDF_USE_INERTIA_FROM_FILE)
        body = body_of(engine, loaded)
        body.set(initial_configuration(robot))
        for joint in body.coordinates.values():
            engine.setJointMotorControl2(loaded, joint, engine.VELOCITY_CONTROL, force=0.0)
        if report is not None:
            constraints = stepbot.close_loops(loaded, report, client)
            assert len(constraints) >= len(robot.closures)
            for constraint in constraints if erp is not None else ():
                engine.changeConstraint(constraint, erp=erp)
        widest = 0.0
        for _ in range(500):
            engine.stepSimulation()
            for closure in robot.closures:
                ends = (body.X_WL(body.links.index(link) - 1) for link in (closure.link_a, closure.link_b))
                widest = max(widest, closure_gap(closure, *ends)[0])
        return widest
    finally:
        engine.disconnect(client)


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.parametrize(
    "build", [four_bar, sliding_closure, welded, delta, pytest.param(stewart, marks=pytest.mark.long)]
)
def test_it_holds_what_would_fall_apart(build: type, tmp_path: Path) -> None:
    """With the constraints the loop stays closed to a millimetre, and without them it opens."""
    skip_without("pybullet")
    robot: Robot = build()
    file = write(robot, tmp_path).written["urdf"].path
    held, loose = (_widest_gap(robot, file, report) for report in (_report(robot), None))
    assert held < 1e-3
    assert loose > 20 * held
    assert loose > 0.02


def test_a_tree_needs_none() -> None:
    """A robot without closures has no constraints."""
    assert _report(two_link_arm())["robot"]["pybullet"] == []


def _report(robot: Robot) -> dict[str, Any]:
    return report_document(Report(robot=robot), Diagnostics())


@pytest.mark.slow
@pytest.mark.pybullet
def test_erp_of_a_point_constraint_changes_nothing(tmp_path: Path) -> None:
    """PyBullet accepts `erp` of a point-to-point constraint and ignores it: `closure_stiffness` cannot be set there."""
    skip_without("pybullet")
    robot = four_bar()
    file = write(robot, tmp_path).written["urdf"].path
    gaps = [_widest_gap(robot, file, _report(robot), erp) for erp in (None, 0.05, 0.9)]
    assert gaps[0] == gaps[1] == gaps[2] > 0.0
