"""The snippet of report.json holds loops closed in PyBullet: run as a user would, on the URDF that was written."""

from pathlib import Path
from typing import Any

import pytest

from stepbot.closure_snippet import pybullet_snippet
from stepbot.kinematics import initial_configuration
from stepbot.loops import closure_gap
from stepbot.model import Robot
from stepbot.simulators.pybullet import body_of
from tests.closed_mechanisms import delta, sliding_closure, stewart, welded
from tests.robots import four_bar, two_link_arm
from tests.simulators.conftest import skip_without, write


def _widest_gap(robot: Robot, file: Path, snippet: str) -> float:
    """How far [m] loops open in half a second of falling sideways, held by the snippet."""
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
        if snippet:
            module: dict[str, Any] = {}
            exec(compile(snippet, "snippet", "exec"), module)
            assert len(module["close_loops"](loaded)) >= len(robot.closures)
        widest = 0.0
        for _ in range(500):
            engine.stepSimulation()
            for closure in robot.closures:
                ends = (body.X_WL(body.links.index(link) - 1) for link in (closure.link_a, closure.link_b))
                widest = max(widest, closure_gap(closure, *ends)[0])
        return widest
    finally:
        engine.disconnect(client)


@pytest.mark.pybullet
@pytest.mark.parametrize("build", [four_bar, sliding_closure, welded, delta, stewart])
def test_it_holds_what_would_fall_apart(build: type, tmp_path: Path) -> None:
    """Closed within a millimetre of the links' centimetres with it, and far open without."""
    skip_without("pybullet")
    robot: Robot = build()
    file = write(robot, tmp_path).written["urdf"].path
    held, loose = (_widest_gap(robot, file, snippet) for snippet in (pybullet_snippet(robot), ""))
    assert held < 1e-3
    assert loose > 20 * held
    assert loose > 0.02


def test_a_tree_needs_none() -> None:
    """No text where there is nothing to hold."""
    assert pybullet_snippet(two_link_arm()) == ""
