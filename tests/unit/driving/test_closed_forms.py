"""Drive tests against closed forms: a pendulum, a damped second-order system, a block held by friction."""

from math import cos, exp, inf, pi, radians, sin, sqrt
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.driving.driving import EXPERIMENTS
from stepbot.driving.grasping import Grasp, find_grasp
from stepbot.driving.results import Result
from stepbot.driving.stage import Stage
from stepbot.engines.simulation import GRAVITY, Cube
from stepbot.geometry.spatial import Pose
from stepbot.robot.gains import tuned
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Box,
    Collision,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    Robot,
)
from stepbot.robot.tuning import Tuning
from tests.unit.driving.workbench import (
    ENGINES,
    HORIZONTAL,
    VERTICAL,
    files_of,
    gripper,
    looped_gripper,
    one_joint,
    stage_of,
)

INERTIA = 0.05 + 1.0 * 0.5**2
"""Inertia [kg m^2] of the arm of ``one_joint`` about its joint."""

pytestmark = [pytest.mark.mujoco, pytest.mark.pybullet]


def value(result: Result, quantity: str) -> float:
    """The value of a quantity."""
    return next(one.value for one in result.measures if one.quantity == quantity)


def run(test: str, stage: Stage) -> Result:
    """The result of a test."""
    return EXPERIMENTS[test](stage)


@pytest.mark.parametrize("engine", ENGINES)
def test_energy_of_a_pendulum(engine: str, tmp_path: Path) -> None:
    """At rest it is m g h, and a pendulum without damping keeps it within a percent of what it exchanges."""
    stage = stage_of(one_joint(HORIZONTAL), engine, tmp_path)
    with stage.scene() as simulation:
        simulation.reset({"turn": radians(-60.0)})
        above = sum(simulation.energy())
        simulation.reset({"turn": 0.0})
        level = sum(simulation.energy())
        assert above - level == pytest.approx(GRAVITY * 0.5 * cos(radians(30.0)), rel=1e-6)
        for _ in range(round(2.0 / simulation.timestep)):
            simulation.step()
        assert sum(simulation.energy()) - level == pytest.approx(0.0, abs=0.01 * GRAVITY * 0.5)
    assert value(run("drop", stage), "energy gain") < 1.0


@pytest.mark.parametrize("ratio", [0.3, 0.6, 1.0])
def test_overshoot_of_a_second_order_system(ratio: float, tmp_path: Path) -> None:
    """In MuJoCo, whose actuator is a spring and a damper, the step overshoots by exp(-pi z / sqrt(1 - z^2))."""
    stiffness = 150.0
    stage = stage_of(one_joint(VERTICAL, stiffness, 2.0 * ratio * sqrt(stiffness * INERTIA)), "mujoco", tmp_path)
    expected = 100.0 * exp(-pi * ratio / sqrt(1.0 - ratio**2)) if ratio < 1.0 else 0.0
    assert value(run("step", stage), "overshoot with other gains") == pytest.approx(expected, abs=1.5)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_fast_motor_reaches_its_speed(engine: str, tmp_path: Path) -> None:
    """A motor of 3000 rpm is not clamped to the 100 rad/s that PyBullet allows unless told otherwise."""
    robot = one_joint(VERTICAL)
    (joint,) = robot.joints
    joint = replace(joint, kind=JointKind.CONTINUOUS, limit=Limit(velocity=314.0, effort=1e3))
    motor = Actuator("motor", joint.name, ActuatorKind.VELOCITY, kv=50.0)
    stage = stage_of(replace(robot, joints=(joint,), actuators=(motor,)), engine, tmp_path)
    with stage.scene() as simulation:
        simulation.reset({"turn": 0.0})
        simulation.command({"motor": 200.0})
        for _ in range(round(0.5 / simulation.timestep)):
            simulation.step()
        assert simulation.speeds()["turn"] == pytest.approx(200.0, rel=0.01)


def test_a_light_joint_with_much_damping_reaches_the_speed_of_its_effort(tmp_path: Path) -> None:
    """In PyBullet, too: effort / damping, from which it stops at once: six times what PyBullet's integrator bears."""
    robot = one_joint(HORIZONTAL)
    (joint,), base = robot.joints, robot.links[0]
    damping = 0.6
    joint = replace(
        joint, dynamics=JointDynamics(damping=damping), limit=Limit(-100.0, 100.0, velocity=inf, effort=1.0)
    )
    light = Link("arm", replace(base.mass_properties, mass=0.01, inertia=((1e-4, 0, 0), (0, 1e-4, 0), (0, 0, 1e-4))))
    robot = replace(robot, links=(base, light), joints=(joint,))
    stage = stage_of(robot, "pybullet", tmp_path)
    with stage.scene() as simulation:
        for effort in (0.6, -0.3):
            simulation.reset({"turn": 0.0})
            simulation.apply({"turn": effort})
            for _ in range(50):
                simulation.step()
            assert simulation.speeds()["turn"] == pytest.approx(effort / damping, rel=1e-3)
        simulation.release()
        for _ in range(50):
            simulation.step()
        assert simulation.speeds()["turn"] == pytest.approx(0.0, abs=1e-3)
    motor = Actuator("drive", "turn", ActuatorKind.POSITION, kp=30.0, kv=1.0)
    (tmp_path / "driven").mkdir()
    driven = stage_of(replace(robot, actuators=(motor,)), "pybullet", tmp_path / "driven")
    assert value(run("step", driven), "overshoot with other gains") < 1.0
    assert value(run("step", driven), "angle error") < 1e-3


@pytest.mark.parametrize("engine", ENGINES)
def test_a_step_is_braked_along_the_torque_speed_line(engine: str, tmp_path: Path) -> None:
    """An arm whose motor has just the effort to brake it does not overshoot: the line adds effort against the motion.

    From 3 rad/s, 6 N m alone need 0.22 rad for the 0.3 kg m^2, and the gains brake within 0.15 rad.
    """
    (joint,) = one_joint(VERTICAL).joints
    joint = replace(joint, limit=Limit(-2.0, 2.0, velocity=4.0, effort=6.0))
    robot = replace(one_joint(VERTICAL, 2000.0, 100.0), joints=(joint,))
    result = run("step", stage_of(robot, engine, tmp_path))
    assert value(result, "overshoot with other gains") < 5.0
    assert value(result, "speed of limit with other gains") <= 100.5


@pytest.mark.parametrize("engine", ENGINES)
def test_a_slow_screw_reaches_the_end_of_its_step(engine: str, tmp_path: Path) -> None:
    """50 mm at 20 mm/s take 2.5 s, and a sine of 25 mm at 0.5 Hz would be four times as fast as the screw."""
    base, arm = one_joint(VERTICAL).links
    limit = Limit(-0.1, 0.1, velocity=0.02, effort=100.0)
    joint = Joint("slide", JointKind.PRISMATIC, "base", "arm", axis=(1.0, 0.0, 0.0), limit=limit)
    screw = Actuator("screw", "slide", ActuatorKind.POSITION, tuning=Tuning(at_least=True))
    robot = tuned(Robot("screw", (base, arm), (joint,), actuators=(screw,)), lambda *_: None)
    stage = stage_of(robot, engine, tmp_path)
    assert value(run("step", stage), "travel error") < 0.1
    assert value(run("track", stage), "lag") < 5.0


@pytest.mark.parametrize("engine", ENGINES)
def test_random_efforts_do_not_drive_a_light_joint_beyond_its_speed(engine: str, tmp_path: Path) -> None:
    """One step of 1000 N m would accelerate the arm by 7 rad/s, its limit is 0.5 rad/s."""
    (joint,) = one_joint(VERTICAL).joints
    joint = replace(joint, limit=Limit(-2.0, 2.0, velocity=0.5, effort=1e3))
    robot = replace(one_joint(VERTICAL, 100.0, 10.0), joints=(joint,))
    assert value(run("torque", stage_of(robot, engine, tmp_path)), "speed of limit with other gains") <= 102.0


def test_random_efforts_do_not_drive_a_joint_on_a_braked_one_beyond_its_speed(tmp_path: Path) -> None:
    """MuJoCo brakes the arm by 200 N m s/rad within the step, which accelerates the tip that the arm carries."""
    base, arm = one_joint(VERTICAL).links
    (turn,) = one_joint(VERTICAL).joints
    turn = replace(turn, dynamics=JointDynamics(damping=200.0), limit=Limit(-2.0, 2.0, velocity=5.0, effort=60.0))
    limit = Limit(-2.0, 2.0, velocity=0.5, effort=100.0)
    tip = Joint(
        "tip", JointKind.REVOLUTE, "arm", "end", X_PC=Pose.of(position=(1.0, 0.0, 0.0)), axis=VERTICAL, limit=limit
    )
    motors = tuple(Actuator(f"{one}_motor", one, ActuatorKind.POSITION, kp=100.0, kv=10.0) for one in ("turn", "tip"))
    robot = Robot("braked", (base, arm, replace(arm, name="end")), (turn, tip), actuators=motors)
    measures = run("torque", stage_of(robot, "mujoco", tmp_path)).measures
    assert {m.where: m.value for m in measures if m.quantity == "speed of limit with other gains"}["tip"] <= 101.0


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_objects_are_held_in_place_of_the_cube(engine: str, tmp_path: Path) -> None:
    """A cylinder, a sphere and a cube as wide as the open gripper, each held by 20 N."""
    stage = stage_of(gripper(20.0), engine, tmp_path)
    (grasp,) = stage.survey.grasps
    files = files_of(gripper(20.0), tmp_path)
    objects = (Cube(0.03, 0.2, "cylinder"), Cube(0.03, 0.2, "sphere"), Cube(grasp.gaps[1], 0.2))
    found = [find_grasp(str(files["mujoco"]), stage.mechanism, grasp.fingers, 0.2, one) for one in objects]
    assert all(isinstance(one, Grasp) for one in found), found
    stage.survey = replace(stage.survey, grasps=tuple(one for one in found if isinstance(one, Grasp)))
    assert [grip.slip < 2.0 for grip in run("grip", stage).grips] == [True] * 3


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "cylinder", "cube"])
def test_heavy_objects_do_not_creep_between_light_fingers(shape: str, tmp_path: Path) -> None:
    """MuJoCo's friction is a damper: 1 kg between fingers of 20 g creeps by less than 1 mm in 5 s.

    The speed of the creep is the force of a contact x (1 / (3 m_finger) + 1 / m) x (1 - d) / d x t / 2 / ``impratio``,
    with the impedance d and the time constant t.
    """
    robot = gripper(100.0)
    hand, *fingers = robot.links
    light = tuple(replace(one, mass_properties=replace(one.mass_properties, mass=0.02)) for one in fingers)
    robot = replace(robot, links=(hand, *light))
    stage = stage_of(robot, "mujoco", tmp_path)
    (grasp,) = stage.survey.grasps
    file = str(files_of(robot, tmp_path)["mujoco"])
    held = find_grasp(file, stage.mechanism, grasp.fingers, 1.0, Cube(0.03, 1.0, shape))
    assert isinstance(held, Grasp), held
    stage.survey = replace(stage.survey, grasps=(held,))
    (grip,) = run("grip", stage).grips
    assert grip.loss is None
    assert grip.slip < 1.0, grip.slip


def test_sag_under_gravity(tmp_path: Path) -> None:
    """A held arm sags by gravity's torque over the stiffness of its motor, at most m g r / kp."""
    stage = stage_of(one_joint(HORIZONTAL, 100.0, 15.0), "mujoco", tmp_path)
    expected = max(GRAVITY * 0.5 * abs(cos(q["turn"])) / 100.0 for q in stage.survey.poses)
    assert value(run("hold", stage), "angle error with other gains") == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("force", "holds"), [(0.6, False), (20.0, True)])
def test_cube_is_held_by_friction(engine: str, force: float, holds: bool, tmp_path: Path) -> None:
    """With a friction coefficient of 1, two fingers hold a cube if twice their force exceeds its weight of 1.96 N.

    One motor moves both fingers, so each has half of its force.
    """
    stage = stage_of(gripper(force), engine, tmp_path)
    (grasp,) = stage.survey.grasps
    assert grasp.gaps == pytest.approx((0.0, 0.06), abs=1e-6) or grasp.gaps[1] - grasp.gaps[0] > 0.03
    slip = value(run("grip", stage), "slip")
    assert slip < 2.0 if holds else slip > 50.0


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("effort", "holds"), [(0.005, False), (0.3, True)])
def test_jaws_of_a_linkage_hold_a_cube(engine: str, effort: float, holds: bool, tmp_path: Path) -> None:
    """A crank of 20 mm with 0.3 N m presses with 7.5 N or more on each jaw; with 0.005 N m it presses less than 1 N.

    The gap is that of the slider-crank, in closed form.
    """
    stage = stage_of(looped_gripper(effort), engine, tmp_path)
    (grasp,) = stage.survey.grasps
    ends = [-0.02 * sin(t) + sqrt(0.04**2 - (0.02 * cos(t)) ** 2) for t in (1.3, -1.3)]
    assert grasp.gaps == pytest.approx([2.0 * (end - 0.0146) for end in ends], abs=1e-6)
    (grip,) = run("grip", stage).grips
    assert (grip.loss is None) == holds
    assert grip.slip < 2.0 or not holds


@pytest.mark.parametrize(("stroke", "blocked", "why"), [(0.004, False, "8.0 mm"), (0.03, True, "the open hand")])
def test_fingers_that_cannot_grip_have_a_reason(stroke: float, blocked: bool, why: str, tmp_path: Path) -> None:
    """Fingers with too short a stroke, or with something between them, are reported by the name of their motor."""
    robot = gripper(20.0)
    joints = tuple(replace(joint, limit=replace(joint.limit, upper=stroke)) for joint in robot.joints)
    hand, *fingers = robot.links
    if blocked:
        between = Collision("between", Box((0.01, 0.01, 0.01)), Pose.of(position=(0.0, 0.0, 0.13)))
        hand = replace(hand, collisions=(between,))
    survey = stage_of(replace(robot, joints=joints, links=(hand, *fingers)), "mujoco", tmp_path).survey
    assert survey.grasps == ()
    assert why in survey.misses["motor"]


def test_steps_avoid_what_is_on_their_way(tmp_path: Path) -> None:
    """An arm with a post in front of its step, and room behind the post, steps to the other side."""
    robot = one_joint(VERTICAL, 100.0, 10.0)
    base, arm = robot.links
    bar = Collision("bar", Box((0.1, 0.01, 0.01)), Pose.of(position=(0.5, 0.0, 0.0)))
    free = stage_of(replace(robot, links=(base, replace(arm, collisions=(bar,)))), "mujoco", tmp_path / "free").survey
    (end,) = free.steps[0].ends
    X_BP = Pose.of(position=(0.5 * cos(0.5 * end), 0.5 * sin(0.5 * end), 0.0))
    post = Link("post", base.mass_properties, collisions=(Collision("post", Box((0.02, 0.02, 0.2))),))
    links = (base, post, replace(arm, collisions=(bar,)))
    robot = replace(
        robot, links=links, joints=(Joint("foot", JointKind.CONTINUOUS, "base", "post", X_BP), *robot.joints)
    )
    (blocked,) = stage_of(robot, "mujoco", tmp_path / "blocked").survey.steps
    assert blocked.ends == pytest.approx((-end,))


def crank_angle(pin: float) -> float:
    """Angle [rad] of the crank of ``looped_gripper`` at which a jaw's pin is at a distance [m] from its axis."""
    low, high = -1.3, 1.3
    for _ in range(60):
        middle = 0.5 * (low + high)
        far = -0.02 * sin(middle) + sqrt(0.04**2 - (0.02 * cos(middle)) ** 2) > pin
        low, high = (middle, high) if far else (low, middle)
    return low


@pytest.mark.slow
def test_a_sweep_states_what_stops_it(tmp_path: Path) -> None:
    """A guide with a limit inside of the crank's range stops the crank there; the sweep goes nine tenths of the way."""
    robot = looped_gripper(1.0)
    guide = "left_guide"
    joints = tuple(
        replace(joint, limit=Limit(-0.005, 0.03)) if joint.name == guide else joint for joint in robot.joints
    )
    (swept,) = stage_of(replace(robot, joints=joints), "mujoco", tmp_path).survey.ranges
    stop = crank_angle(sqrt(0.04**2 - 0.02**2) - 0.005)
    assert swept.swept == pytest.approx((-1.3, 0.9 * stop), rel=0.03)
    assert swept.stops == ("", f"the limit of {guide}")
    assert swept.share == pytest.approx((1.3 + 0.9 * stop) / 2.6, rel=0.02)


@pytest.mark.slow
def test_a_contact_stops_a_sweep_of_a_linkage_where_it_is(tmp_path: Path) -> None:
    """Jaws of a linkage that meet are swept up to there, at eighths of the way, not through each other."""
    robot = looped_gripper(1.0)
    links = [
        replace(
            link, collisions=tuple(replace(one, X_LG=Pose.of(position=(-0.02, 0.0, 0.13))) for one in link.collisions)
        )
        for link in robot.links
    ]
    (swept,) = stage_of(replace(robot, links=tuple(links)), "mujoco", tmp_path).survey.ranges
    meet = crank_angle(0.025)
    assert meet - 1.3 / 8 < swept.swept[1] <= meet
    assert swept.stops == ("", "a contact")
