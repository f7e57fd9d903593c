"""Computed gains of actuators, against closed forms and MuJoCo."""

from math import inf, pi
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Array, Pose, turn_inertia
from stepbot.robot.closures import close_loops
from stepbot.robot.datasheet import accelerations
from stepbot.robot.gains import OVERSHOOT, SAG, SINKING, line_damping, tuned
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Actuator, ActuatorKind, Base, Joint, JointDynamics, JointKind, Limit, Link, Robot
from stepbot.robot.simulation_settings import OPEN_TIMESTEP, SHORT_TIMESTEP, settings_of
from stepbot.robot.tuning import BANDWIDTH as TUNED
from stepbot.robot.tuning import Simulation, Tuning
from stepbot.sidecar.motors import catalogue_motor, catalogue_names, find_motor, fitted
from tests.robots import ROBOTS, four_bar, gripper_with_mimic
from tests.simulators.conftest import skip_without
from tests.workshop import Workshop, at, box_mass

LENGTH, BREADTH = 0.4, 0.03
ROD = (LENGTH, BREADTH, BREADTH)
ARMATURE, DAMPING, BANDWIDTH = 0.02, 0.05, 4.0
HALF = 0.5 * LENGTH


def one_link_arm(kind: ActuatorKind = ActuatorKind.POSITION, effort: float = np.inf, gear: float = 1.0) -> Robot:
    """A horizontal rod on a joint with a horizontal axis, with an actuator whose gains are computed."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.1), at(z=-0.2))])
    rod = shop.link("rod", [(ROD, at(x=HALF))])
    dynamics = JointDynamics(damping=DAMPING, armature=ARMATURE)
    joint = Joint(
        "lift", JointKind.REVOLUTE, "base", "rod", at(), (0.0, -1.0, 0.0), limit=Limit(-2, 2), dynamics=dynamics
    )
    motor = Actuator("motor", "lift", kind, gear=gear, limit=Limit(effort=effort), tuning=Tuning(BANDWIDTH))
    robot = Robot("one_link_arm", (base, rod), (joint,), actuators=(motor,), meshes=shop.sorted_meshes())
    return tuned(robot, fails)


def fails(actuator: Actuator, effort: float, weight: float) -> None:
    """No actuator here is too weak."""
    pytest.fail(f"{actuator.name}: {effort} {weight}")


def rod_inertia() -> float:
    """Inertia [kg m^2] of the rod about its joint, with the armature."""
    return float(box_mass(ROD, at(x=HALF)).inertia[1][1]) + box_mass(ROD).mass * HALF**2 + ARMATURE


def compiled(robot: Robot, *, gravity: bool) -> Any:
    """The robot's MJCF in MuJoCo, without contacts."""
    skip_without("mujoco")
    import mujoco

    files = render(robot, "mjcf", Diagnostics())
    main, *_ = files
    model = mujoco.MjModel.from_xml_string(files[main].decode(), {p: c for p, c in files.items() if p != main})
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.gravity[2] = -9.81 if gravity else 0.0
    return model


def stepped(model: Any, target: float, seconds: float, start: float = 0.0) -> Array:
    """Positions [rad] of the only joint, step by step, after a step of its target."""
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[0], data.ctrl[0] = start, target
    found = []
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        found.append(float(data.qpos[0]))
    return np.array(found)


def test_gains_are_those_of_a_critically_damped_oscillator() -> None:
    """kp = I w^2 and kv + damping = 2 I w with the closed-form inertia; with a gear they are at the motor."""
    (motor,) = one_link_arm().actuators
    inertia, w = rod_inertia(), 2.0 * pi * BANDWIDTH
    assert motor.kp == pytest.approx(inertia * w**2, rel=5e-4)
    assert motor.kv == pytest.approx(2.0 * inertia * w - DAMPING, rel=5e-4)
    assert motor.tuning is not None
    assert motor.tuning.inertia == pytest.approx(inertia, rel=5e-4)
    assert motor.tuning.weight == pytest.approx(box_mass(ROD).mass * 9.81 * HALF, rel=5e-4)
    (geared,) = one_link_arm(gear=-20.0).actuators
    assert (geared.kp, geared.kv) == pytest.approx((motor.kp / 400.0, motor.kv / 400.0), rel=5e-4)
    (turned,) = one_link_arm(ActuatorKind.VELOCITY).actuators
    assert (turned.kp, turned.kv) == (0.0, pytest.approx(inertia * w - DAMPING, rel=5e-4))


def short_arm(damping: float, slides: bool = False) -> Robot:
    """A light link of 60 mm, on a horizontal axis or a vertical slide, with ``gains: auto``."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.1), at(z=-0.2))])
    jaw = shop.link("jaw", [((0.06, 0.01, 0.01), at(x=0.03))])
    kind, axis = (JointKind.PRISMATIC, (0.0, 0.0, 1.0)) if slides else (JointKind.REVOLUTE, (0.0, -1.0, 0.0))
    dynamics = JointDynamics(damping=damping)
    joint = Joint("grip", kind, "base", "jaw", at(), axis, limit=Limit(-1.5, 1.5), dynamics=dynamics)
    motor = Actuator("motor", "grip", ActuatorKind.POSITION, tuning=Tuning(at_least=True))
    robot = Robot("short_arm", (base, jaw), (joint,), actuators=(motor,), meshes=shop.sorted_meshes())
    return tuned(robot, fails)


@pytest.mark.mujoco
def test_a_light_link_does_not_sag() -> None:
    """Where the natural frequency is too soft for the weight, kp is the weight / SAG, also from an upright pose."""
    robot = short_arm(0.0)
    (motor,) = robot.actuators
    body = box_mass((0.06, 0.01, 0.01), at(x=0.03))
    weight = body.mass * 9.81 * 0.03
    assert motor.tuning is not None
    assert motor.tuning.stiffened
    assert motor.kp == pytest.approx(weight / SAG, rel=0.05)
    inertia = float(box_mass((0.06, 0.01, 0.01)).inertia[1][1]) + body.mass * 0.03**2
    assert motor.kp > 1.2 * inertia * (2.0 * pi * 5.0) ** 2
    assert motor.kv == pytest.approx(2.0 * np.sqrt(motor.kp * inertia), rel=1e-3)
    assert stepped(compiled(robot, gravity=True), 0.0, 1.0)[-1] == pytest.approx(-weight / motor.kp, rel=0.01)
    (lift,) = short_arm(0.0, slides=True).actuators
    assert lift.kp == pytest.approx(body.mass * 9.81 / SINKING, rel=1e-3)


def legs(*sides: float) -> Robot:
    """Legs of three joints on a trunk, at the side y = 0.2 m times each of the given, all in another drawn pose."""
    links, joints, motors = [Link("trunk")], [], []
    body = MassProperties(0.8, (0.01, 0.0, -0.12), ((0.004, 0.0, 2e-4), (0.0, 0.004, 0.0), (2e-4, 0.0, 5e-4)))
    for side in sides:
        steps = (
            ("roll", (0.3, 0.2 * side, 0.0), (1.0, 0.0, 0.0), (-0.7, 0.7), 0.0),
            ("hip", (0.02, 0.06 * side, 0.0), (0.0, 1.0, 0.0), (-1.2, 2.4), 0.6 + 0.2 * side),
            ("knee", (0.0, 0.0, -0.25), (0.0, 1.0, 0.0), (-2.6, -0.3), -1.2 - 0.3 * side),
        )
        above = "trunk"
        for name, place, axis, limit, drawn in steps:
            link = f"{name}{side:+.0f}"
            links.append(Link(link, replace(body, com=(0.01, 0.05 * side if name == "roll" else 0.0, -0.12))))
            joint = Joint(f"{link}_turn", JointKind.REVOLUTE, above, link, Pose.of(position=place), axis)
            joints.append(replace(joint, limit=Limit(*limit), drawn_position=drawn))
            motors.append(Actuator(link, joint.name, ActuatorKind.POSITION, tuning=Tuning(at_least=True)))
            above = link
    return tuned(Robot("legs", tuple(links), tuple(joints), actuators=tuple(motors)), fails)


def test_equal_limbs_get_equal_gains() -> None:
    """Gains of a leg and of its mirror image are equal, whatever else hangs on the trunk, and however it is drawn."""
    both, left = legs(1.0, -1.0), legs(1.0)
    gains = [(one.kp, one.kv) for one in both.actuators]
    np.testing.assert_allclose(gains[:3], gains[3:], rtol=1e-3)
    np.testing.assert_allclose(gains[:3], [(one.kp, one.kv) for one in left.actuators], rtol=1e-3)


@pytest.mark.mujoco
def test_passive_damping_does_not_slow_the_joint() -> None:
    """With damping d far beyond critical, kp = d w / 2: a moving target is followed as closely as without damping.

    The slower pole of the joint in MuJoCo is that of I s^2 + d s + kp.
    """
    robot = short_arm(0.05)
    (motor,) = robot.actuators
    assert motor.kv == 0.0
    model = compiled(robot, gravity=False)
    model.opt.timestep = 2e-4
    positions = stepped(model, 0.5, 0.4)
    late = positions[round(0.1 / 2e-4) :: round(0.1 / 2e-4)]
    rates = -np.diff(np.log(0.5 - late)) / 0.1
    assert motor.kp == pytest.approx(0.05 * pi * TUNED, rel=1e-3)
    assert motor.tuning is not None
    inertia = motor.tuning.inertia
    pole = (0.05 - np.sqrt(0.05**2 - 4.0 * inertia * motor.kp)) / (2.0 * inertia)
    np.testing.assert_allclose(rates, pole, rtol=0.03)


@pytest.mark.mujoco
def test_the_step_response_is_the_closed_form() -> None:
    """In MuJoCo the arm follows 1 - (1 + w t) exp(-w t), and sags by its weight / kp."""
    robot = one_link_arm()
    model = compiled(robot, gravity=False)
    model.opt.timestep = 2e-4
    positions = stepped(model, 0.5, 1.0)
    wt = 2.0 * pi * BANDWIDTH * model.opt.timestep * np.arange(1, len(positions) + 1)
    np.testing.assert_allclose(positions, 0.5 * (1.0 - (1.0 + wt) * np.exp(-wt)), atol=2e-3)
    assert positions.max() < 0.5 + 1e-4
    (motor,) = robot.actuators
    assert motor.tuning is not None
    sagged = stepped(compiled(robot, gravity=True), 0.0, 2.0)[-1]
    assert sagged == pytest.approx(-motor.tuning.weight / motor.kp, rel=0.01)


@pytest.mark.mujoco
@pytest.mark.parametrize(("share", "critical", "elsewhere"), [(1.15, 0.9, 0.15), (1.5, 0.3, 0.08), (1.8, 0.04, 0.07)])
def test_a_weak_actuator_brakes_in_time(share: float, critical: float, elsewhere: float) -> None:
    """At its effort limit, down with the weight, a step of 0.5 rad from home stops; critically damped it overshoots.

    From where it is heavier all the way, its overshoot is bounded.
    """
    weight = box_mass(ROD).mass * 9.81 * HALF
    robot = one_link_arm(effort=share * weight)
    (motor,) = robot.actuators
    assert motor.tuning is not None
    assert motor.tuning.braked
    model = compiled(robot, gravity=True)

    def overshoot(start: float = 0.0) -> float:
        positions = stepped(model, start - 0.5, 4.0, start=start)
        return float((positions[-1] - positions.min()) / 0.5)

    assert overshoot() < OVERSHOOT + 5e-3
    assert overshoot(0.25) < elsewhere
    model.actuator_biasprm[0][2] = -2.0 * rod_inertia() * 2.0 * pi * BANDWIDTH
    assert overshoot() > critical


@pytest.mark.mujoco
@pytest.mark.parametrize(
    ("armature", "effort", "speed", "friction"), [(0.5, 8.0, 4.0, 0.0), (0.5, 8.0, 4.0, 2.0), (0.2, 5.0, 1.5, 0.5)]
)
def test_a_limited_effort_costs_no_more_lag_than_braking_takes(
    armature: float, effort: float, speed: float, friction: float
) -> None:
    """The damping is at most a quarter above the least for which MuJoCo overshoots by 5 % of 0.5 rad, either way.

    Dry friction brakes, too.
    """
    robot, model = limited_arm(armature, effort, speed, 1e-3, friction)
    (motor,), (joint,) = robot.actuators, robot.joints
    assert motor.tuning is not None

    def overshoot(kv: float) -> float:
        model.actuator_biasprm[0][2] = line_damping(motor, joint) - kv
        ways = (1.0, -1.0)
        responses = [way * stepped(model, 0.5 * way, 3.0) for way in ways]
        return max(float(one.max() - one[-1]) / 0.5 for one in responses)

    assert overshoot(motor.kv) < 0.05
    assert overshoot(0.8 * motor.kv) > 0.05


@pytest.mark.parametrize("effort", [30.0, np.inf])
def test_a_joint_between_equal_limits_brakes_nothing(effort: float) -> None:
    """Without travel no step overshoots: the gains are those of an actuator without effort limit."""
    robot = one_link_arm()
    (joint,), (motor,) = robot.joints, robot.actuators
    held = replace(joint, limit=Limit(0.3, 0.3))
    robot = replace(robot, joints=(held,), actuators=(replace(motor, limit=Limit(effort=effort)),))
    (found,) = tuned(robot, fails).actuators
    assert (found.kp, found.kv) == (motor.kp, motor.kv)
    assert found.tuning is not None
    assert not found.tuning.braked


@pytest.mark.parametrize("effort", [5e-324, 1e-200])
def test_an_effort_of_next_to_nothing_is_computed_with(effort: float) -> None:
    """A motor of a joint without weight, whose effort limit is near the smallest number, brakes nothing."""
    (joint,), (motor,) = one_link_arm().joints, one_link_arm().actuators
    upright = replace(joint, axis=(0.0, 0.0, 1.0), limit=replace(joint.limit, effort=effort))
    robot = replace(one_link_arm(), joints=(upright,), actuators=(replace(motor, limit=Limit(effort=effort)),))
    (found,) = tuned(robot, fails).actuators
    assert 0.0 < found.kp < inf
    assert found.tuning is not None
    assert not found.tuning.braked
    assert accelerations(robot) == {"lift": 0.0}


def test_followers_of_a_mimic_are_moved_too() -> None:
    """The mass at a finger's motor is that of both fingers, and of the thumb that turns with them."""
    robot = gripper_with_mimic()
    wanted = tuple(replace(actuator, tuning=Tuning()) for actuator in robot.actuators)
    (grip,) = tuned(replace(robot, actuators=wanted), fails).actuators
    thumb = robot.joint_by_name["thumb_pivot"]
    assert thumb.mimic is not None
    body = robot.link_by_name["thumb"].mass_properties
    arm = np.linalg.norm(np.cross(thumb.axis, body.com))
    about_pivot = float(np.array(thumb.axis) @ np.array(body.inertia) @ np.array(thumb.axis) + body.mass * arm**2)
    fingers = sum(robot.link_by_name[name].mass_properties.mass for name in ("left_finger", "right_finger"))
    mass = fingers + about_pivot * thumb.mimic.multiplier**2
    assert grip.tuning is not None
    assert grip.tuning.inertia == pytest.approx(mass, rel=5e-4)


@pytest.mark.parametrize("driven", ["crank_pin", "ground_pin"])
def test_loops_are_followed(driven: str) -> None:
    """The inertia at a joint of a four-bar is twice the kinetic energy of all links at unit speed, by differences.

    So it is at a second actuator, though the loop has one degree of freedom.
    """
    robot = four_bar()
    (first,) = robot.actuators
    both = [replace(first, name=joint, joint=joint, tuning=Tuning()) for joint in ("crank_pin", "ground_pin")]
    actuators = tuned(replace(robot, actuators=tuple(both)), fails).actuators
    (crank,) = (one for one in actuators if one.joint == driven)
    home, h = initial_configuration(robot), 1e-5
    poses = [
        link_poses(robot, close_loops(robot, {**home, crank.joint: home[crank.joint] + d}, (crank.joint,)))
        for d in (-h, h)
    ]
    energy = 0.0
    for link in robot.links:
        before, after = (pose[link.name] for pose in poses)
        body = link.mass_properties
        v = (after.apply(body.com) - before.apply(body.com)) / (2.0 * h)
        turn = (after.R - before.R) @ before.R.T / (2.0 * h)
        w = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
        energy += float(body.mass * v @ v + w @ turn_inertia(before.R, body.inertia) @ w)
    assert crank.tuning is not None
    assert crank.tuning.inertia == pytest.approx(energy + robot.joint_by_name[crank.joint].dynamics.armature, rel=1e-3)


def test_an_actuator_that_cannot_hold_its_joint_is_reported() -> None:
    """The callback gets limit and weight; the gains ignore the limit. Given gains stay as they are."""
    weak: list[tuple[str, float, float]] = []
    robot = one_link_arm()
    limited = replace(robot, actuators=tuple(replace(one, limit=Limit(effort=0.1)) for one in robot.actuators))
    assert (
        tuned(limited, lambda *found: weak.append((found[0].name, *found[1:]))).actuators[0].kp == robot.actuators[0].kp
    )
    assert [(name, effort) for name, effort, _ in weak] == [("motor", 0.1)]
    given = ROBOTS["two_link_arm"]()
    assert tuned(given, fails) is given


def limited_arm(armature: float, effort: float, speed: float, timestep: float, friction: float = 0.0) -> Any:
    """A rod about a horizontal axis with ``gains: auto`` and limits of effort and speed, in MuJoCo; and the robot."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.1), at(z=-0.2))])
    rod = shop.link("rod", [(ROD, at(x=HALF))])
    limit, dynamics = Limit(-2, 2, speed, effort), JointDynamics(armature=armature, friction=friction)
    joint = Joint("lift", JointKind.REVOLUTE, "base", "rod", at(), (0.0, -1.0, 0.0), limit=limit, dynamics=dynamics)
    motor = Actuator("motor", "lift", ActuatorKind.POSITION, tuning=Tuning(at_least=True))
    robot = Robot("limited_arm", (base, rod), (joint,), actuators=(motor,), meshes=shop.sorted_meshes())
    robot = tuned(robot, fails)
    model = compiled(robot, gravity=True)
    model.opt.timestep = timestep
    return robot, model


@pytest.mark.mujoco
@pytest.mark.parametrize("timestep", [1e-3, 2e-3])
@pytest.mark.parametrize(("armature", "effort", "speed"), [(0.0, 30.0, 3.0), (0.05, 20.0, 6.0), (0.3, 60.0, 2.0)])
def test_the_arm_follows_holds_and_stops(armature: float, effort: float, speed: float, timestep: float) -> None:
    """In MuJoCo, a sine of 0.5 Hz lags and 0.5 rad overshoot by at most 5 %, and the arm is held within 0.01 rad."""
    import mujoco

    _, model = limited_arm(armature, effort, speed, timestep)
    data = mujoco.MjData(model)
    times = timestep * np.arange(1, round(4.0 / timestep) + 1)
    errors = []
    for time in times:
        data.ctrl[0] = 0.3 * np.sin(pi * time)
        mujoco.mj_step(model, data)
        errors.append(data.qpos[0] - data.ctrl[0])
    late = times > 2.0
    error, phase = np.array(errors)[late], pi * times[late]
    lag = 2.0 * np.hypot(np.mean(error * np.cos(phase)), np.mean(error * np.sin(phase))) / 0.3
    assert 0.01 < lag < 0.05
    positions = stepped(model, 0.5, 2.0)
    assert positions.max() < 0.5 + 0.05 * 0.5
    assert positions[-1] == pytest.approx(0.5, abs=0.01)


@pytest.mark.mujoco
@pytest.mark.parametrize("way", [0.5, -0.5])
def test_an_upright_arm_stops_where_its_weight_pulls_on(way: float) -> None:
    """The drawn pose has no torque of gravity; after a step of 0.5 rad it takes half of the effort that brakes."""
    shop = Workshop()
    links = shop.link("base", [((0.1, 0.1, 0.1), at(z=-0.2))]), shop.link("rod", [(ROD[::-1], at(z=HALF))])
    weight = box_mass(ROD).mass * 9.81 * HALF
    limit, dynamics = Limit(-2, 2, 2.5, 1.05 * weight), JointDynamics(damping=0.01, armature=ARMATURE)
    joint = Joint("lean", JointKind.REVOLUTE, "base", "rod", at(), (0.0, 1.0, 0.0), limit=limit, dynamics=dynamics)
    motor = Actuator("motor", "lean", ActuatorKind.POSITION, tuning=Tuning(at_least=True))
    robot = Robot("upright_arm", links, (joint,), actuators=(motor,), meshes=shop.sorted_meshes())
    positions = stepped(compiled(tuned(robot, fails), gravity=True), way, 2.0)
    assert positions[-1] == pytest.approx(way, abs=0.01)
    assert np.max(positions / way) - positions[-1] / way < 0.05


@pytest.mark.parametrize(
    ("kind", "effort", "velocity", "expected"),
    [
        (ActuatorKind.POSITION, 20.0, 4.0, 4.5),
        (ActuatorKind.POSITION, 1.0, 4.0, 0.0),
        (ActuatorKind.POSITION, 20.0, 0.0, 0.0),
        (ActuatorKind.POSITION, 20.0, inf, 0.0),
        (ActuatorKind.POSITION, inf, 4.0, 0.0),
        (ActuatorKind.VELOCITY, 20.0, 4.0, 0.0),
    ],
)
def test_damping_of_the_torque_speed_line(kind: ActuatorKind, effort: float, velocity: float, expected: float) -> None:
    """Effort / velocity less the joint's own 0.5, where both limits are numbers, for a position actuator."""
    limit, dynamics = Limit(-1.0, 1.0, velocity, effort), JointDynamics(damping=0.5)
    joint = Joint("lean", JointKind.REVOLUTE, "base", "rod", at(), limit=limit, dynamics=dynamics)
    assert line_damping(Actuator("motor", "lean", kind), joint) == expected


def test_a_damping_that_is_the_slope_leaves_no_residue() -> None:
    """Effort / velocity as a catalogue has it differs from the joint's damping by a rounding, which no file has."""
    for effort, velocity in ((2.942, 4.712), (1.912, 5.454)):
        limit, dynamics = Limit(-1.0, 1.0, velocity, effort), JointDynamics(damping=effort / velocity * (1.0 - 1e-14))
        joint = Joint("lean", JointKind.REVOLUTE, "base", "rod", at(), limit=limit, dynamics=dynamics)
        assert line_damping(Actuator("motor", "lean", ActuatorKind.POSITION), joint) == 0.0


@pytest.mark.mujoco
def test_no_target_drives_a_joint_beyond_its_velocity_limit() -> None:
    """The effort is used up at the limit, however far the target is; without gravity the joint does not reach it."""
    import mujoco

    robot, model = limited_arm(0.05, 20.0, 6.0, 2e-3)
    (motor,), (joint,) = robot.actuators, robot.joints
    assert line_damping(motor, joint) == pytest.approx(20.0 / 6.0)
    assert motor.kv >= 20.0 / 6.0
    model.opt.gravity[2], model.jnt_limited[0], model.actuator_ctrllimited[0] = 0.0, 0, 0
    data = mujoco.MjData(model)
    data.ctrl[0] = 100.0
    speeds = []
    for _ in range(2000):
        mujoco.mj_step(model, data)
        speeds.append(float(data.qvel[0]))
    assert 0.99 * 6.0 < max(speeds) <= 6.0 * (1.0 + 1e-6)


def test_a_given_bandwidth_and_ratio_are_kept_beside_limits() -> None:
    """Limits of effort and speed change neither kp nor kv of a given bandwidth, if the effort brakes the step."""
    robot = one_link_arm()
    (joint,), (motor,) = robot.joints, robot.actuators
    limited = replace(joint, limit=replace(joint.limit, velocity=1.0, effort=500.0))
    (found,) = tuned(replace(robot, joints=(limited,)), fails).actuators
    assert line_damping(motor, limited) > motor.kv
    assert (found.kp, found.kv) == (motor.kp, motor.kv)


def rover(effort: float, damping: float = 0.0) -> Robot:
    """A floating base with two wheels of 50 mm, each with a motor."""
    shop = Workshop()
    boxes = {name: ((0.1, 0.1, 0.1), at(y=y)) for name, y in (("base", 0.0), ("left", 0.2), ("right", -0.2))}
    links = tuple(shop.link(name, [box]) for name, box in boxes.items())
    turns, dynamics = Limit(velocity=12.0, effort=effort), JointDynamics(damping=damping)
    joints = tuple(
        Joint(name, JointKind.CONTINUOUS, "base", name, at(), (0.0, 1.0, 0.0), limit=turns, dynamics=dynamics)
        for name in boxes
        if name != "base"
    )
    motors = tuple(
        Actuator(one.name, one.name, ActuatorKind.VELOCITY, tuning=Tuning(TUNED, at_least=True)) for one in joints
    )
    robot = Robot("rover", links, joints, base=Base.FLOATING, actuators=motors, meshes=shop.sorted_meshes())
    return tuned(robot, fails)


@pytest.mark.parametrize(("effort", "time"), [(0.8, None), (20.0, 2e-3)])
def test_a_wheel_keeps_its_speed_against_its_load(effort: float, time: float | None) -> None:
    """At its effort limit it is 2 % of its velocity limit too slow, unless that is a time constant below 2 ms."""
    (left, _) = rover(effort).actuators
    assert left.tuning is not None
    expected = effort / (0.02 * 12.0) if time is None else left.tuning.inertia / time
    assert left.kv == pytest.approx(expected, rel=1e-3)
    assert left.kv >= 2.0 * pi * TUNED * left.tuning.inertia * 0.999


def test_wheels_whose_motors_are_strongly_damped_have_a_shorter_time_step() -> None:
    """kv is 200 times the damping; below half a step of 2 ms as time constant, a step of 1 ms is the default.

    A motor that has twice the effort that its damping takes at full speed keeps to its target in steps of 2 ms.
    """
    (left, _) = rover(20.0).actuators
    assert left.tuning is not None
    damping = 0.005 * left.tuning.inertia / 1e-3
    effort = 12.0 * damping
    for share, times, expected in (
        (0.98, 1.0, OPEN_TIMESTEP),
        (1.02, 1.0, SHORT_TIMESTEP),
        (1.02, 2.0, SHORT_TIMESTEP),
        (1.02, 2.1, OPEN_TIMESTEP),
    ):
        stiff = rover(times * effort, share * damping)
        assert settings_of(stiff).timestep == expected
        assert settings_of(replace(stiff, simulation=Simulation(timestep=5e-3))).timestep == 5e-3
        given = tuple(replace(one, tuning=None) for one in stiff.actuators)
        assert settings_of(replace(stiff, actuators=given)).timestep == OPEN_TIMESTEP


@pytest.mark.mujoco
@pytest.mark.parametrize("gear", [1.0, -3.0])
@pytest.mark.parametrize("name", [one for one in catalogue_names() if catalogue_motor(one).position_gain])
def test_a_servo_with_the_gain_of_its_firmware_keeps_its_no_load_speed(name: str, gear: float) -> None:
    """In MuJoCo a far target drives no joint beyond 105 % of it, also where less damping is published."""
    import mujoco

    motor = fitted(find_motor(name), JointKind.REVOLUTE, None, gear)
    has = {figure.quantity: figure.value for figure in motor.figures}
    limit = Limit(-1e4, 1e4, velocity=has["velocity"], effort=has["effort"])
    dynamics = JointDynamics(*(has.get(one, 0.0) for one in ("damping", "friction")), armature=has["armature"])
    shop = Workshop()
    links = shop.link("base", [((0.1, 0.1, 0.1), at(z=-0.2))]), shop.link("rod", [((0.1, 0.01, 0.01), at(x=0.05))])
    joint = Joint("turn", JointKind.REVOLUTE, "base", "rod", at(), (0.0, 0.0, 1.0), limit=limit, dynamics=dynamics)
    servo = Actuator("servo", "turn", ActuatorKind.POSITION, kp=has["kp"], gear=gear, motor=motor)
    robot = Robot("servo", links, (joint,), actuators=(servo,), meshes=shop.sorted_meshes())
    model = compiled(tuned(robot, fails), gravity=False)
    assert model.actuator_biasprm[0][2] == 0.0  # all of kv is the line's damping: no rounding is left of it
    data = mujoco.MjData(model)
    data.ctrl[0] = gear * 1e3
    fastest = 0.0
    for _ in range(round(2.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        fastest = max(fastest, float(data.qvel[0]))
    assert 0.5 * limit.velocity < fastest <= 1.05 * limit.velocity
