"""Steps per second of MJCF files of one robot in MuJoCo, one after the other in short turns, by processor time.

Two files may differ in more than the shapes whose cost is asked for. They are compared as written, and with the first
one's solver options, gains and joint dynamics, so that shapes and pairs that can touch are all that differs.
"""

import statistics
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

_OPTIONS = (
    *("timestep", "integrator", "solver", "cone", "jacobian", "impratio", "iterations", "tolerance", "ls_iterations"),
    *("ls_tolerance", "noslip_iterations", "ccd_iterations", "disableflags", "enableflags", "gravity"),
)
"""Fields of ``mjModel.opt``."""
_DRIVES = (
    *("actuator_trntype", "actuator_trnid", "actuator_dyntype", "actuator_gaintype", "actuator_biastype"),
    *("actuator_dynprm", "actuator_gainprm", "actuator_biasprm", "actuator_gear"),
    *("actuator_ctrllimited", "actuator_ctrlrange", "actuator_forcelimited", "actuator_forcerange"),
    *("dof_damping", "dof_armature", "dof_frictionloss", "jnt_stiffness", "jnt_limited", "jnt_range"),
    *("jnt_actfrclimited", "jnt_actfrcrange"),
)
"""Fields of ``mjModel``: what drives the joints and resists their motion."""
_HELD = 50
"""Steps for which random torques are held."""
_TORQUE = 10.0
"""Largest random torque [N m] or force [N]."""


class NotOneRobot(ValueError):
    """Two models have different joints or actuators."""


def compare_steps(files: Mapping[str, Path], rounds: int = 7, steps: int = 2000) -> list[str]:
    """Lines with the steps per second of MJCF files under random torques, and the ratios to the first file.

    Args:
        files: The files, each with its name in the lines.
        rounds: Number of turns; the ratio is the median of theirs.
        steps: Steps of each file in each turn.

    Raises:
        NotOneRobot: The files have different joints or actuators.
    """
    import mujoco

    models = {name: mujoco.MjModel.from_xml_path(str(path)) for name, path in files.items()}
    lines = [f"{name}: {_shapes(model)}" for name, model in models.items()]
    lines += _compared(mujoco, models, "as written", rounds, steps)
    first, *others = models.values()
    differing = dict.fromkeys(field for model in others for field in made_equal(model, first))
    if differing:
        lines.append(f"differ in {', '.join(differing)}")
        lines += _compared(mujoco, models, "these made equal", rounds, steps)
    return lines


def made_equal(model: Any, first: Any) -> list[str]:
    """Give a model the solver options, gains and joint dynamics of another; the names of those that differed.

    Raises:
        NotOneRobot: The models have different joints or actuators.
    """
    if (model.nq, model.nv, model.nu, model.njnt) != (first.nq, first.nv, first.nu, first.njnt):
        raise NotOneRobot("the files have different joints or actuators")
    differing = []
    for owner, other, fields in ((model.opt, first.opt, _OPTIONS), (model, first, _DRIVES)):
        for field in fields:
            own, value = np.array(getattr(owner, field)), np.array(getattr(other, field))
            if not np.array_equal(own, value):
                differing.append(field)
                setattr(owner, field, value if value.ndim else value.item())
    return differing


def _shapes(model: Any) -> str:
    solid = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
    meshes = [int(model.geom_dataid[g]) for g in solid if model.geom_dataid[g] >= 0]
    vertices = sum(int(model.mesh_vertnum[mesh]) for mesh in meshes)
    return f"{len(solid)} collision shapes, {vertices:,} vertices, {model.nexclude} excluded pairs of bodies"


def _compared(mujoco: Any, models: Mapping[str, Any], how: str, rounds: int, steps: int) -> list[str]:
    """A line for each model but the first."""
    rates: dict[str, list[float]] = {name: [] for name in models}
    touching: dict[str, float] = {}
    for seed in range(rounds):
        turn = list(models)[:: -1 if seed % 2 else 1]  # neither file always runs on the other's warm caches
        for name in turn:
            rate, touching[name] = _rate(mujoco, models[name], steps, seed)
            rates[name].append(rate)
    first, *others = models
    speeds = {name: f"{statistics.median(values):,.0f} steps/s" for name, values in rates.items()}
    return [
        f"{how}: {first} {speeds[first]}, {other} {speeds[other]}: {_median_ratio(rates[other], rates[first])};"
        f" contacts {touching[first]:.2f} and {touching[other]:.2f}"
        for other in others
    ]


def _median_ratio(one: Sequence[float], other: Sequence[float]) -> str:
    ratios = sorted(a / b for a, b in zip(one, other, strict=True))
    return f"{statistics.median(ratios):.2f} x ({ratios[0]:.2f} to {ratios[-1]:.2f})"


def _rate(mujoco: Any, model: Any, steps: int, seed: int) -> tuple[float, float]:
    """Steps per second of processor time, and contacts on average at every change of the torques."""
    data, random = mujoco.MjData(model), np.random.default_rng(seed)
    contacts = []
    start = time.process_time()
    for step in range(steps):
        if step % _HELD == 0:
            contacts.append(int(data.ncon))
            data.qfrc_applied[:] = random.uniform(-_TORQUE, _TORQUE, model.nv)
        mujoco.mj_step(model, data)
    return steps / (time.process_time() - start), statistics.fmean(contacts)
