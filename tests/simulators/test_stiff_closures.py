"""Closures and mimics of the written MJCF in motion: their gaps in closed form, and under random drives."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import Pose
from stepbot.robot.dynamics import mobilities
from stepbot.robot.model import FormatVersions, Joint, JointKind, LoopClosure, Robot
from stepbot.robot.simulation_settings import OPEN_TIMESTEP, SHORT_TIMESTEP, settings_of
from stepbot.robot.tuning import Integrator, Simulation
from tests.robots import ROBOTS
from tests.simulators.conftest import skip_without
from tests.stiffness import largest_gap, largest_gap_of_motors
from tests.workshop import Workshop, at

pytestmark = pytest.mark.mujoco

RADIUS, SPEED = 0.2, 12.0
"""Of a carried block: radius [m] and angular speed [rad/s] of its circle."""


def carried_block() -> Robot:
    """A heavy crank that carries a block on a cross slide in a circle: the block's pull on the pin is constant."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.01), at(z=-0.1))])
    crank = shop.link("crank", [((1.0, 1.0, 0.02), at())])
    carriage = shop.link("carriage", [((0.01, 0.01, 0.01), at(z=0.1))])
    block = shop.link("block", [((0.02, 0.02, 0.02), at(z=0.05))])
    joints = (
        Joint("turn", JointKind.CONTINUOUS, "base", "crank", at()),
        Joint("along", JointKind.PRISMATIC, "base", "carriage", at(), axis=(1.0, 0.0, 0.0)),
        Joint("across", JointKind.PRISMATIC, "carriage", "block", at(), axis=(0.0, 1.0, 0.0)),
    )
    pin = LoopClosure("pin", JointKind.BALL, "crank", Pose.of(position=(RADIUS, 0, 0)), "block", Pose())
    joints = (joints[0], replace(joints[1], X_PC=Pose.of(position=(RADIUS, 0, 0))), joints[2])
    return Robot("carried_block", (base, crank, carriage, block), joints, (pin,), meshes=shop.sorted_meshes())


def compiled(robot: Robot) -> Any:
    """The robot's MJCF, compiled, without contacts."""
    skip_without("mujoco")
    import mujoco

    files = render(robot, "mjcf", Diagnostics())
    main, *_ = files
    model = mujoco.MjModel.from_xml_string(files[main].decode(), {p: c for p, c in files.items() if p != main})
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return model


@pytest.mark.parametrize("stiffness", [1.0, 0.25])
@pytest.mark.parametrize("timestep", [0.002, 0.0005])
def test_the_gap_of_a_whirling_loop_is_its_sagitta_of_one_step(stiffness: float, timestep: float) -> None:
    """The pin of a block carried in a circle is open by w^2 R dt^2 / 2, divided by the stiffness."""
    import mujoco

    robot = replace(carried_block(), simulation=Simulation(timestep=timestep, closure_stiffness=stiffness))
    model = compiled(robot)
    assert model.opt.timestep == timestep
    data = mujoco.MjData(model)
    data.joint("turn").qvel, data.joint("across").qvel = SPEED, SPEED * RADIUS
    for _ in range(round(0.5 / timestep)):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    gap = float(np.linalg.norm(data.site("pin::a").xpos - data.site("pin::b").xpos))
    expected = 0.5 * SPEED**2 * RADIUS * timestep**2 / stiffness
    assert data.joint("turn").qvel[0] == pytest.approx(SPEED, rel=0.01)
    assert gap == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("name", ["four_bar", "gripper_with_mimic", "slider_crank"])
def test_loops_and_mimics_hold_at_random_drives(name: str) -> None:
    """Gaps with bang-bang drives at the effort limits are below 0.1 mm or mrad, and a tenth of those by default."""
    model = compiled(ROBOTS[name]())
    gap = largest_gap(model)
    model.eq_solref[:], model.eq_solimp[:, :3] = (0.02, 1.0), (0.9, 0.95, 0.001)
    assert gap < min(1e-4, 0.1 * largest_gap(model))


@pytest.mark.parametrize("version", [3.3, 3.7])
def test_mimics_hold_motors_with_damping(version: float) -> None:
    """The torque-speed line of a motor, 20 N at 0.1 m/s for fingers of 65 g, opens no mimic by 0.02 mm or mrad.

    As damping of the driven finger it opens them by more than 0.2. The finger still moves at its limit of speed.
    """
    robot = replace(ROBOTS["gripper_with_mimic"](), versions=FormatVersions(mjcf=version))
    (motor,) = robot.actuators
    model = compiled(replace(robot, actuators=(replace(motor, kp=5000.0, kv=200.0),)))
    implicit = compiled(replace(robot, actuators=(replace(motor, kp=5000.0, kv=0.0),)))
    implicit.dof_damping[implicit.joint("finger").dofadr] += 200.0
    assert largest_gap_of_motors(model) < 2e-5
    assert largest_gap_of_motors(implicit) > 2e-4
    model.jnt_limited[:], model.actuator_ctrllimited[:] = 0, 0
    assert speed_of_far_target(model) == pytest.approx(0.1, rel=1e-3)


def speed_of_far_target(model: Any) -> float:
    """Speed [m/s] of the first joint on its way to a target that its motor pushes it to with its whole effort."""
    import mujoco

    data = mujoco.MjData(model)
    data.ctrl[0] = 100.0
    for _ in range(round(0.2 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return float(data.qvel[0])


@pytest.mark.parametrize("name", sorted(ROBOTS))
def test_mobilities_are_those_of_the_compiled_model(name: str) -> None:
    """The diagonal of the inverse of MuJoCo's mass matrix at q = 0: of floating bases, balls and screws, too."""
    import mujoco

    robot = lower(ROBOTS[name](), format_named("mjcf"), Diagnostics())
    model = compiled(robot)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = mobilities(robot)
    seen = 0
    for joint in range(model.njnt):
        if mujoco.mjtJoint(model.jnt_type[joint]) in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            unit, moved = np.zeros((2, 1, model.nv))
            unit[0, model.jnt_dofadr[joint]] = 1.0
            mujoco.mj_solveM(model, data, moved, unit)
            mobility = moved[0, model.jnt_dofadr[joint]]
            assert found[model.joint(joint).name] == pytest.approx(mobility, rel=1e-6)
            seen += 1
    assert seen or not found


def test_settings_are_those_of_the_sidecar_or_fit_the_robot() -> None:
    """The time step is shorter with loops or mimics; given settings are written, in MuJoCo's words."""
    import mujoco

    assert settings_of(ROBOTS["pendulum"]()).timestep == OPEN_TIMESTEP
    assert settings_of(ROBOTS["four_bar"]()).timestep == settings_of(ROBOTS["gripper_with_mimic"]()).timestep
    assert compiled(ROBOTS["pendulum"]()).opt.timestep == OPEN_TIMESTEP
    model = compiled(ROBOTS["four_bar"]())
    assert model.opt.timestep == SHORT_TIMESTEP
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    words = {Integrator.EULER: "EULER", Integrator.RK4: "RK4", Integrator.IMPLICIT: "IMPLICIT"}
    for integrator, word in words.items():
        model = compiled(replace(ROBOTS["pendulum"](), simulation=Simulation(integrator=integrator)))
        assert model.opt.integrator == getattr(mujoco.mjtIntegrator, f"mjINT_{word}")


def test_a_longer_step_of_the_loading_program_keeps_loops_stable() -> None:
    """Gaps stay below 0.5 mm at twice the time step, without a change of the file."""
    model = compiled(ROBOTS["four_bar"]())
    model.opt.timestep *= 2.0
    assert largest_gap(model) < 5e-4
