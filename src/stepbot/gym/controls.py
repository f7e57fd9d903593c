"""Actions to controls: what -1, 0 and 1 mean for each actuator."""

from collections.abc import Mapping
from math import pi
from typing import Any

import mujoco
import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array
from stepbot.robot.mesh_names import SCOPE

from .model import Model, joint_kind, name

MODES = ("target", "rate")
_EFFORT = {"hinge": "N*m", "slide": "N"}
_POSITION = {"hinge": "rad", "slide": "m"}


class Actuator(Struct, frozen=True):
    """An actuator of the model."""

    index: int
    name: str
    joint: int | None
    """The joint that it drives; None for tendons, sites and other transmissions."""
    drives: str
    """``position``, ``velocity``, ``effort`` or, for other gains, ``control``."""
    gear: float

    def unit(self, model: Model) -> str:
        """Unit of its control divided by its gear; empty if it is unknown."""
        kind = joint_kind(model, self.joint) if self.joint is not None else ""
        if self.drives == "effort":
            return _EFFORT.get(kind, "")
        position = _POSITION.get(kind, "")
        return f"{position}/s" if position and self.drives == "velocity" else position


def actuators(model: Model) -> list[Actuator]:
    """The actuators of a model, in order."""
    return [_actuator(model, index) for index in range(model.nu)]


def _actuator(model: Model, index: int) -> Actuator:
    on_joint = model.actuator_trntype[index] == mujoco.mjtTrn.mjTRN_JOINT
    joint = int(model.actuator_trnid[index, 0]) if on_joint else None
    if joint is not None and joint_kind(model, joint) not in _POSITION:
        joint = None
    bias, gain = model.actuator_biasprm[index], model.actuator_gainprm[index]
    drives = "control"
    if model.actuator_dyntype[index] == mujoco.mjtDyn.mjDYN_NONE:
        affine = model.actuator_biastype[index] == mujoco.mjtBias.mjBIAS_AFFINE
        if affine and gain[0] and bias[1] == -gain[0]:
            drives = "position"
        elif affine and gain[0] and bias[1] == 0.0 and bias[2] == -gain[0]:
            drives = "velocity"
        elif model.actuator_biastype[index] == mujoco.mjtBias.mjBIAS_NONE:
            drives = "effort"
    return Actuator(index, name(model, "ACTUATOR", index), joint, drives, float(model.actuator_gear[index, 0]))


class Controls:
    """The action space of a robot, and the controls that an action gives.

    With the mode ``target``, -1 and 1 are the ends of an actuator's control range and 0 is its control at home; between
    them the control is linear. With ``rate``, an action is the speed of a position actuator's target: 1 is the joint's
    velocity limit. Other actuators are as with ``target``. Without ``normalise`` actions have the joints' units.
    """

    def __init__(
        self, model: Model, home: Array, *, mode: str, normalise: bool, max_speed: float | None, period: float
    ) -> None:
        """Find ranges and units.

        Args:
            model: The compiled model.
            home: Controls (nu,) at home.
            mode: ``target`` or ``rate``.
            normalise: Whether actions are between -1 and 1.
            max_speed: Speed [rad/s or m/s] of the targets of all position actuators, instead of the joints' velocity
                limits.
            period: Time [s] between two actions.

        Raises:
            ValueError: The mode is unknown; the range of a control or the limit of a speed is.
        """
        if mode not in MODES:
            raise ValueError(f"unknown mode of actions '{mode}'; there are {', '.join(MODES)}")
        driven = actuators(model)
        moved = [mode == "rate" and one.drives == "position" and one.joint is not None for one in driven]
        self.names = tuple(f"{one.name}/{'rate' if m else one.drives}" for one, m in zip(driven, moved, strict=True))
        units = [one.unit(model) for one in driven]
        self.units = tuple(f"{unit}/s" if m else unit for unit, m in zip(units, moved, strict=True))
        self.targets = tuple(f"{one.name}/target" for one, m in zip(driven, moved, strict=True) if m)
        """Targets that actions move: the state of this object."""
        self.target_units = tuple(unit for unit, m in zip(units, moved, strict=True) if m)
        self._moved = np.array(moved)
        self._gear = np.array([one.gear for one in driven])
        ranges = [_range(model, one, float(home[one.index]), endless=m) for one, m in zip(driven, moved, strict=True)]
        self._low, self._high = np.array(ranges).T
        self._home = np.clip(home, self._low, self._high)
        speeds = [_speed(model, one, max_speed) if m else 0.0 for one, m in zip(driven, moved, strict=True)]
        self._speed = np.array(speeds)
        self._step = np.abs(self._gear) * self._speed * period
        self._normalise, self._period = normalise, period
        self._control = self._home.copy()

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest action."""
        if self._normalise:
            return -np.ones(len(self.names)), np.ones(len(self.names))
        gear = np.where(self._moved, 1.0, self._gear)
        ends = np.array(
            [np.where(self._moved, -self._speed, self._low), np.where(self._moved, self._speed, self._high)]
        )
        ends /= gear
        return ends.min(axis=0), ends.max(axis=0)

    @property
    def home(self) -> Array:
        """Controls (nu,) at home."""
        return self._home.copy()

    @property
    def range(self) -> tuple[Array, Array]:
        """Lowest and highest control, in the model's own units; infinite where only the rate is limited."""
        return self._low.copy(), self._high.copy()

    def reset(self, control: Array) -> None:
        """Start from a control."""
        self._control = np.clip(control, self._low, self._high)

    def apply(self, action: Array) -> Array:
        """The controls (nu,) for the next period."""
        if self._normalise:
            part = np.where(action >= 0.0, self._high - self._home, self._home - self._low)
            target = self._home + action * np.where(self._moved, 0.0, part)
            moved = self._control + np.sign(self._gear) * action * self._step
        else:
            target = action * self._gear
            moved = self._control + action * self._gear * self._period
        self._control = np.clip(np.where(self._moved, moved, target), self._low, self._high)
        return self._control

    def read(self) -> Array:
        """The targets that actions move, in the joints' units."""
        return np.asarray(self._control[self._moved] / self._gear[self._moved])


def home_control(model: Model, keyframe: int | None, q: Array, changed: Mapping[int, float]) -> Array:
    """Controls (nu,) of a keyframe; of position actuators that it does not set, those that hold the configuration.

    Args:
        model: The compiled model.
        keyframe: Index of the keyframe; None for none.
        q: Coordinates (nq,) at home.
        changed: Positions of joints that differ from the keyframe.
    """
    control = np.array(model.key_ctrl[keyframe]) if keyframe is not None else np.zeros(model.nu)
    for actuator in actuators(model):
        if (
            actuator.drives == "position"
            and actuator.joint is not None
            and (keyframe is None or actuator.joint in changed)
        ):
            control[actuator.index] = actuator.gear * q[model.jnt_qposadr[actuator.joint]]
    return control


def _range(model: Model, actuator: Actuator, home: float, *, endless: bool) -> tuple[float, float]:
    """Lowest and highest control of an actuator."""
    if model.actuator_ctrllimited[actuator.index]:
        low, high = model.actuator_ctrlrange[actuator.index]
        return float(low), float(high)
    if endless:
        return -np.inf, np.inf
    half = 0.0
    kind = joint_kind(model, actuator.joint) if actuator.joint is not None else ""
    if actuator.drives == "position" and kind == "hinge":
        half = pi * abs(actuator.gear)  # one turn
    elif actuator.drives == "velocity" and actuator.joint is not None:
        home, half = 0.0, abs(actuator.gear) * (velocity_limit(model, actuator.joint) or 0.0)
    elif actuator.drives == "effort" and model.actuator_forcelimited[actuator.index]:
        home, half = 0.0, float(np.abs(model.actuator_forcerange[actuator.index]).max())
    if not half:
        raise ValueError(
            f"actuator '{actuator.name}' has no control range; add ctrlrange to it in the MJCF, or limits to the joint"
        )
    return home - half, home + half


def velocity_limit(model: Model, joint: int) -> float | None:
    """Velocity limit [rad/s or m/s], which stepbot writes as ``<numeric name="<joint>::velocity">``."""
    for index in range(model.nnumeric):
        if name(model, "NUMERIC", index) == f"{name(model, 'JOINT', joint)}{SCOPE}velocity":
            data: Any = model.numeric_data[model.numeric_adr[index]]
            return float(data)
    return None


def _speed(model: Model, actuator: Actuator, most: float | None) -> float:
    assert actuator.joint is not None
    speed = most if most is not None else velocity_limit(model, actuator.joint)
    if speed is None:
        joint = name(model, "JOINT", actuator.joint)
        raise ValueError(
            f"joint '{joint}' has no velocity limit, <numeric name=\"{joint}{SCOPE}velocity\" data=...> in the MJCF; "
            "pass max_speed=... [rad/s or m/s], or action='target' to set positions"
        )
    return float(speed)
