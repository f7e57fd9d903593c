"""Stand: stay upright at the height of home, with little effort, while being pushed."""

from collections.abc import Mapping
from math import cos, pi, radians
from os import PathLike
from typing import Any

import mujoco
import numpy as np

from stepbot.geometry.spatial import Array

from .environment import Info, RobotEnv
from .model import Model, floating_base

_FALLEN = cos(radians(60.0))
_LOW = 0.4
"""Share of the height of home below which the robot has fallen."""
_EFFORT = 0.1
"""Reward lost by the power that lifts the robot by 1 m/s."""


class Stand(RobotEnv):
    """Stay upright at the height of home, with little effort.

    The reward of a step is the product of the cosine of the base's tilt and its height as a share of home's, each at
    most 1, less 0.1 s/m P / (m g): P is the sum of the magnitudes of the actuators' powers [W], m g the robot's weight
    [N]. A tilt above 60 degrees or a height below 0.4 of home's ends the episode. ``push`` changes the base's velocity
    every ``push_interval`` seconds. ``info`` has ``tilt`` [rad], ``height`` [m], ``is_success`` (tilted by less than
    0.2 rad, not below 0.8 of the height of home), and the parts of the reward.
    """

    period = 0.02

    def __init__(
        self, model: str | PathLike[str] | Model, *, push: float = 0.0, push_interval: float = 1.0, **options: Any
    ) -> None:
        """Make the environment.

        Args:
            model: As for :class:`RobotEnv`.
            push: Largest change [m/s] of the base's horizontal velocity.
            push_interval: Time [s] between pushes; the first is at the start.
            options: Arguments of :class:`RobotEnv`.

        Raises:
            ValueError: The robot has no floating base, or nothing is there to stand on; a number is negative; or
                :class:`RobotEnv` raises it.
        """
        if push < 0.0 or not push_interval > 0.0:
            raise ValueError(f"push must not be negative and push_interval positive: {push}, {push_interval}")
        super().__init__(model, **options)
        base = floating_base(self.model)
        if base is None:
            raise ValueError(
                "to stand, a robot needs a floating base: `base: floating` in the sidecar, or <freejoint> in the MJCF"
            )
        fixed = self.model.body_weldid[self.model.geom_bodyid] == 0
        if not (fixed & (self.model.geom_contype > 0)).any():
            raise ValueError("no floor to stand on; load the scene, <robot>.scene.xml, or add a plane to the MJCF")
        self._body = int(self.model.jnt_bodyid[base])
        self._dof = int(self.model.jnt_dofadr[base])
        mujoco.mj_kinematics(self.model, self.data)
        self._up_B = self.data.xmat[self._body].reshape(3, 3)[2].copy()
        self._height = float(self.data.xpos[self._body][2])
        weight = float(self.model.body_subtreemass[self._body] * np.linalg.norm(self.model.opt.gravity))
        self._effort = _EFFORT / weight
        self._push, self._interval, self._next = push, push_interval, 0.0

    def _begin(self, options: Mapping[str, Any]) -> None:
        super()._begin(options)
        self._next = 0.0
        self._push_if_due()

    def _push_if_due(self) -> None:
        if self._push and self.data.time >= self._next - 1e-9:
            direction, size = self.np_random.uniform(0.0, 2.0 * pi), self._push * self.np_random.random()
            self.data.qvel[self._dof] += size * np.cos(direction)
            self.data.qvel[self._dof + 1] += size * np.sin(direction)
            self._next += self._interval

    def _cosine(self) -> float:
        """Cosine of the base's tilt against home."""
        return float(np.clip(self.data.xmat[self._body].reshape(3, 3)[2] @ self._up_B, -1.0, 1.0))

    def _state_info(self) -> Info:
        cosine, height = self._cosine(), float(self.data.xpos[self._body][2])
        tilt = float(np.arccos(cosine))
        return {"tilt": tilt, "height": height, "is_success": tilt < 0.2 and height > 0.8 * self._height}

    def _judge(self, action: Array) -> tuple[float, bool, Info]:  # noqa: ARG002
        info, cosine = self._state_info(), self._cosine()
        upright, level = max(0.0, cosine), float(np.clip(info["height"] / self._height, 0.0, 1.0))
        power = float(np.abs(self.data.actuator_force * self.data.actuator_velocity).sum())
        effort = min(1.0, self._effort * power)
        fallen = cosine < _FALLEN or info["height"] < _LOW * self._height
        self._push_if_due()
        parts = {"reward_upright": upright * level, "reward_effort": -effort}
        return upright * level - effort, fallen, {**info, **parts}
