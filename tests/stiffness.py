"""Gaps of closures and mimics in MuJoCo while motors push at their limits in random directions."""

from typing import Any

import numpy as np

DURATION, HOLD = 2.0, 0.1
"""Length [s] of the simulation, and of each push."""


def largest_gap(model: Any, seed: int = 1, efforts: float = 5.0, fastest: float = 5.0) -> float:
    """Largest gap [m, or rad of a mimic] while each actuated joint is pushed with its effort limit.

    Its direction changes at random every ``HOLD`` seconds. As a motor does, a joint stops being pushed at its velocity
    limit.

    Args:
        model: A compiled MuJoCo model, whose first keyframe closes the loops.
        seed: Of the random directions.
        efforts: Effort [N m] or [N] of actuators without a limit.
        fastest: Velocity limit [rad/s] or [m/s] of joints without one.
    """
    import mujoco

    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    limits = {model.numeric(i).name: float(model.numeric(i).data[0]) for i in range(model.nnumeric)}
    joints = [model.joint(int(model.actuator_trnid[a][0])) for a in range(model.nu)]
    efforts_of = [_effort(model, a, joint.id, efforts) for a, joint in enumerate(joints)]
    random = np.random.Generator(np.random.PCG64(seed))
    steps, worst = round(HOLD / model.opt.timestep), 0.0
    signs = np.zeros(len(joints))
    for k in range(round(DURATION / model.opt.timestep)):
        if k % steps == 0:
            signs = random.choice((-1.0, 1.0), len(joints))
        for sign, joint, effort in zip(signs, joints, efforts_of, strict=True):
            fast = sign * data.qvel[joint.dofadr[0]] > limits.get(f"{joint.name}::velocity", fastest)
            data.qfrc_applied[joint.dofadr[0]] = 0.0 if fast else sign * effort
        mujoco.mj_step(model, data)
        worst = max(worst, *(_gap(model, data, e) for e in range(model.neq)))
    assert not any(warning.number for warning in data.warning)
    return worst


def largest_gap_of_motors(model: Any, seed: int = 1) -> float:
    """Largest gap [m, or rad of a mimic] while the motors go to random ends of their ranges, a new one every ``HOLD``.

    Args:
        model: A compiled MuJoCo model, whose first keyframe closes the loops; all its actuators have ranges.
        seed: Of the random ends.
    """
    import mujoco

    assert model.actuator_ctrllimited.all()
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    random, worst = np.random.Generator(np.random.PCG64(seed)), 0.0
    for k in range(round(DURATION / model.opt.timestep)):
        if k % round(HOLD / model.opt.timestep) == 0:
            data.ctrl[:] = model.actuator_ctrlrange[range(model.nu), random.integers(0, 2, model.nu)]
        mujoco.mj_step(model, data)
        worst = max(worst, *(_gap(model, data, e) for e in range(model.neq)))
    assert not any(warning.number for warning in data.warning)
    return worst


def _effort(model: Any, actuator: int, joint: int, otherwise: float) -> float:
    """The smaller limit of the actuator, at the joint, and of the joint."""
    limits = [otherwise]
    if model.actuator_forcelimited[actuator]:
        limits = [float(model.actuator_forcerange[actuator][1] * abs(model.actuator_gear[actuator][0]))]
    if model.jnt_actfrclimited[joint]:
        limits.append(float(model.jnt_actfrcrange[joint][1]))
    return min(limits)


def _gap(model: Any, data: Any, e: int) -> float:
    """Gap [m] of a point constraint, or deviation [m or rad] of a mimic."""
    import mujoco

    a, b = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
    if model.eq_type[e] != mujoco.mjtEq.mjEQ_JOINT:
        return float(np.linalg.norm(data.site_xpos[a] - data.site_xpos[b]))
    follower, leader = (float(data.qpos[model.jnt_qposadr[joint]]) for joint in (a, b))
    offset, multiplier = model.eq_data[e][:2].tolist()
    return abs(follower - offset - multiplier * leader)
