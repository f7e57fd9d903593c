"""The constraints of report.json close loops of the written URDF in PyBullet, added as a user would."""

import math
from pathlib import Path
from typing import Any

import pytest

import stepbot
from stepbot.diagnostics import Diagnostics
from stepbot.engines.pybullet.body import body_of
from stepbot.report.document import report_document
from stepbot.report.results import Status
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


def _lazy_tongs(stages: int) -> str:
    """An MJCF of crossed bars, each pinned to the next one at its ends and to its partner in its middle."""
    x, z = 0.1 * math.cos(0.6), 0.1 * math.sin(0.6)

    def bars(name: str, side: float, number: int) -> str:
        size, at = (1.0, (0.0, 0.0)) if number == 0 else (2.0, (x * min(number, 2), z * -side * min(number, 2)))
        to = f"{size * x} 0 {size * side * z}"
        inner = bars(name, -side, number + 1) if number < stages else ""
        return f"""<body name="{name}{number}" pos="{at[0]} 0 {at[1]}"><joint name="{name}_pin{number}" axis="0 1 0"/>
<geom type="capsule" size="0.004" density="2700" contype="0" conaffinity="0" fromto="0 0 0 {to}"/>{inner}</body>"""

    pins = "".join(
        f'<connect name="middle{i}" body1="a{i}" body2="b{i}" anchor="{x} 0 {z * (-1) ** i}"/>'
        for i in range(1, stages + 1)
    )
    return f"""<mujoco model="tongs"><compiler angle="radian"/><option timestep="0.001"/>
<worldbody><body name="ground">{bars("a", 1.0, 0)}{bars("b", -1.0, 0)}</body></worldbody>
<equality>{pins}</equality></mujoco>"""


@pytest.mark.long
@pytest.mark.pybullet
def test_loops_that_fold_flat_pass_their_proof(tmp_path: Path) -> None:
    """Lazy tongs stick where PyBullet's solver ends early, and are driven again up to where they are nearly flat."""
    (tmp_path / "tongs.xml").write_text(_lazy_tongs(3), encoding="utf-8")
    made = stepbot.convert(tmp_path / "tongs.xml", output=tmp_path / "out", formats="urdf", require="pybullet")
    assert not [str(one) for one in made.diagnostics if one.severity == "error"]
    assert made.report is not None
    (check,) = [c for c in made.report.checks if (c.engine, c.quantity) == ("pybullet", "closures")]
    assert check.status is Status.PASSED


_FIVE_BAR = """<mujoco model="five_bar"><compiler angle="radian"/><option timestep="0.001"/>
<default><geom type="capsule" size="0.004" density="2700" contype="0" conaffinity="0"/></default>
<worldbody><body name="ground"><geom type="box" size="0.12 0.02 0.01"/>
<body name="a" pos="-0.1 0 0"><joint name="a_crank" axis="0 1 0" range="-0.28 0.28"/><geom fromto="0 0 0 0 0 0.1"/>
<body name="hand" pos="0 0 0.1"><joint name="wrist" axis="0 1 0"/><geom fromto="0 0 0 0 0 0.05"/>
<body name="a_bar" pos="0 0 0.05"><joint name="a_pin" axis="0 1 0"/><geom fromto="0 0 0 0.1 0 0.066332496"/></body>
</body></body>
<body name="b" pos="0.1 0 0"><joint name="b_crank" axis="0 1 0" range="-0.28 0.28"/><geom fromto="0 0 0 0 0 0.15"/>
<body name="b_bar" pos="0 0 0.15"><joint name="b_pin" axis="0 1 0"/>
<geom fromto="0 0 0 -0.1 0 0.066332496"/></body></body>
</body></worldbody>
<equality><connect name="middle" body1="a_bar" body2="b_bar" anchor="0.1 0 0.066332496"/>
<joint joint1="wrist" joint2="a_crank" polycoef="0 -0.25 0 0 0"/></equality></mujoco>"""


@pytest.mark.long
@pytest.mark.pybullet
def test_a_loop_with_a_mimic_passes_its_proof_up_to_its_dead_centre(tmp_path: Path) -> None:
    """A gear's error of 1e-4 rad in the wrist turned the bars, which are nearly in line, by 3e-3 rad."""
    (tmp_path / "five_bar.xml").write_text(_FIVE_BAR, encoding="utf-8")
    made = stepbot.convert(tmp_path / "five_bar.xml", output=tmp_path / "out", formats="urdf", require="pybullet")
    assert not [str(one) for one in made.diagnostics if one.severity == "error"]
    assert made.report is not None
    (check,) = [c for c in made.report.checks if (c.engine, c.quantity) == ("pybullet", "closures")]
    assert check.status is Status.PASSED


@pytest.mark.long
@pytest.mark.pybullet
def test_slow_loops_stick_unless_the_solver_goes_on(tmp_path: Path) -> None:
    """The first bars turn by 0.2 rad in ten seconds: loops open less than a tenth as wide without the threshold."""
    import pybullet as engine

    (tmp_path / "tongs.xml").write_text(_lazy_tongs(3), encoding="utf-8")
    made = stepbot.convert(tmp_path / "tongs.xml", output=tmp_path / "out", formats="urdf", verify=False)
    assert made.robot is not None

    def widest(**settings: float) -> float:
        client, gap = engine.connect(engine.DIRECT), 0.0
        engine.setPhysicsEngineParameter(enableFileCaching=0, numSolverIterations=200, **settings)
        engine.setTimeStep(1e-3)
        file = str(tmp_path / "out" / "tongs.urdf")
        body = body_of(engine, engine.loadURDF(file, useFixedBase=True, flags=engine.URDF_USE_INERTIA_FROM_FILE))
        for joint in body.coordinates.values():
            engine.setJointMotorControl2(body.id, joint, engine.VELOCITY_CONTROL, force=0.0)
        stepbot.close_loops(body.id, tmp_path / "out" / "report.json", client)
        for step in range(10_000):
            for name, way in (("a_pin0", -0.2), ("b_pin0", 0.2)):
                at = way * step / 10_000
                engine.setJointMotorControl2(
                    body.id, body.coordinates[name], engine.POSITION_CONTROL, targetPosition=at, force=50.0
                )
            engine.stepSimulation()
            for one in made.robot.closures if step % 25 == 0 else ():
                ends = (body.X_WL(body.links.index(link) - 1) for link in (one.link_a, one.link_b))
                gap = max(gap, closure_gap(one, *ends)[0])
        engine.disconnect(client)
        return gap

    sticking, closed = widest(), widest(solverResidualThreshold=0.0)
    assert closed < 0.1 * sticking


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
