"""Single jaws: where they grip a cube against their hand, whether it is held, and why others are not tried."""

from collections.abc import Callable
from math import pi, sqrt
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.driving.driving import EXPERIMENTS
from stepbot.driving.results import Loss, Result
from stepbot.engines.simulation import GRAVITY
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import Base, Box, Collision, JointDynamics, Robot
from tests.unit.driving.workbench import ENGINES, clamp, stage_of

LYING = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, -0.5 * pi, 0.0))
"""Pose of a hand on its back, whose jaw closes downwards."""

pytestmark = [pytest.mark.mujoco, pytest.mark.pybullet]


def gripped(robot: Robot, engine: str, folder: Path) -> Result:
    """The result of the grip test."""
    return EXPERIMENTS["grip"](stage_of(robot, engine, folder))


@pytest.mark.slow
@pytest.mark.parametrize("slides", [False, True], ids=["turns", "slides"])
def test_cube_is_flat_on_the_hand(slides: bool, tmp_path: Path) -> None:
    """Parallel plates 24 mm apart grip a cube of nearly that size, flat on the hand and between the plates' edges."""
    (grasp,) = stage_of(clamp(1.0, slides=slides), "mujoco", tmp_path).survey.grasps
    edge = grasp.cube.edge
    assert 0.018 <= edge <= 0.026
    assert grasp.X_HC.R[:, 0] == pytest.approx([1.0, 0.0, 0.0], abs=2e-3)
    assert grasp.X_HC.p[0] == pytest.approx(0.5 * edge, abs=1e-3)
    assert abs(grasp.X_HC.p[1]) < 0.015
    assert 0.045 < grasp.X_HC.p[2] < 0.115
    assert grasp.open["close"] > grasp.closed
    assert grasp.gaps[0] < 0.5 * edge < 0.5 * grasp.gaps[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "X_BH"),
    [
        *(pytest.param(engine, IDENTITY, id=f"{engine}-upright") for engine in ENGINES),
        pytest.param("mujoco", LYING, id="mujoco-lying"),
        pytest.param("pybullet", LYING, id="pybullet-lying", marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize(
    ("slides", "effort", "holds"),
    [
        (False, 0.03, False),
        (False, 1.5, True),
        pytest.param(True, 0.3, False, marks=pytest.mark.long),
        pytest.param(True, 20.0, True, marks=pytest.mark.long),
    ],
)
def test_cube_is_held_by_friction(
    engine: str, slides: bool, effort: float, holds: bool, X_BH: Pose, tmp_path: Path
) -> None:
    """With a friction coefficient of 1, jaw and hand hold a cube if twice the jaw's force exceeds its weight of 1.96 N.

    The turning jaw's lever is at least 40 mm: 0.03 N m are less than 0.75 N. On a hand on its back the cube would lie
    without any force, so that its weight acts along the plates there; the sliding jaw's own weight adds 0.5 N.
    """
    measures = {
        one.quantity: one.value for one in gripped(clamp(effort, slides=slides, X_BH=X_BH), engine, tmp_path).measures
    }
    assert measures["slip"] < 2.0 if holds else measures["slip"] > 20.0
    assert measures["penetration"] < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_cube_that_nothing_holds_falls_freely(engine: str, tmp_path: Path) -> None:
    """Without a force it is lost after the time of a free fall over two edges; the rest of the fall is left out."""
    (grip,) = gripped(clamp(1e-5), engine, tmp_path).grips
    assert grip.loss is Loss.FREE
    assert grip.seconds == pytest.approx(sqrt(4.0 * grip.cube.edge / GRAVITY), rel=0.15)
    assert 2e3 * grip.cube.edge < grip.slip < 2.5e3 * grip.cube.edge


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_effort_on_the_cube(engine: str, tmp_path: Path) -> None:
    """MuJoCo's motor presses with kp times the rest of its way; PyBullet's, without gains, with all of its effort."""
    stage = stage_of(clamp(40.0), engine, tmp_path)
    (grip,) = EXPERIMENTS["grip"](stage).grips
    assert grip.loss is None
    assert grip.links == {"base", "hand", "jaw"}
    assert grip.effort is not None
    rest = 0.25 + 0.01  # the plates are parallel at 0, where they are as far apart as the cube is wide
    share = 20.0 * rest / 40.0 if engine == "mujoco" else 1.0
    assert grip.effort == pytest.approx(share, rel=0.25)


@pytest.mark.slow
def test_a_light_jaw_with_a_strong_motor_does_not_leap_through_the_cube(tmp_path: Path) -> None:
    """MuJoCo limits no speed: a jaw whose target is at the closed end at once reaches 60 rad/s, 10 mm in a step."""
    robot = clamp(3.0)
    mount, close = robot.joints
    light = replace(close, dynamics=JointDynamics(damping=0.05), limit=replace(close.limit, lower=-0.25, upper=1.9))
    motors = (replace(robot.actuators[0], kp=50.0, kv=0.1),)
    (grip,) = gripped(replace(robot, joints=(mount, light), actuators=motors), "mujoco", tmp_path).grips
    assert grip.loss is None
    assert grip.slip < 2.0


def _without_plate(robot: Robot) -> Robot:
    base, hand, jaw = robot.links
    behind = Collision("behind", Box((0.02, 0.04, 0.02)), Pose.of(position=(0.0, 0.0, -0.1)))
    return replace(robot, links=(base, replace(hand, collisions=(behind,)), jaw))


def _between(lower: float, upper: float) -> Callable[[Robot], Robot]:
    """Other limits of the jaw."""

    def mutated(robot: Robot) -> Robot:
        mount, close = robot.joints
        return replace(robot, joints=(mount, replace(close, limit=replace(close.limit, lower=lower, upper=upper))))

    return mutated


def _without_shapes(robot: Robot) -> Robot:
    base, hand, jaw = robot.links
    return replace(robot, links=(base, hand, replace(jaw, collisions=())))


@pytest.mark.parametrize(
    ("mutated", "why"),
    [
        (_without_plate, "the link does not close on the one that carries it"),
        (_between(0.2, 1.2), "the link does not close on the one that carries it"),
        (_between(-0.25, -0.15), "the link does not close on the one that carries it"),
        (lambda robot: replace(robot, base=Base.FLOATING), "the link stands on the floor"),
        (_without_shapes, "a link without collision shapes, or a motor without limits"),
    ],
    ids=["no plate", "stays open", "stays closed", "foot", "no shapes"],
)
def test_jaws_that_cannot_grip_have_a_reason(mutated: Callable[[Robot], Robot], why: str, tmp_path: Path) -> None:
    """A jaw without a face to close on, that does not come near it, or that stands on the floor, is reported."""
    survey = stage_of(mutated(clamp(1.0)), "mujoco", tmp_path).survey
    assert survey.grasps == ()
    assert why in survey.misses["motor"]
