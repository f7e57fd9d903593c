"""Tasks: reach, bring the tip to a target that the robot can reach; stand, stay upright while being pushed."""

from collections.abc import Mapping
from math import cos, pi, radians
from os import PathLike
from typing import Any

import mujoco
import numpy as np

from stepbot.engines.mujoco.model import collected_warnings
from stepbot.geometry.spatial import Array

from .environment import Info, Marker, RobotEnv
from .model import Model, floating_base, frame_names, index, name, tip_body, tip_frame

_EFFORT = 0.02
"""Reward lost by actions at their bounds."""
_RESTING = 1e-9
"""Distance [m] that is numeric residue."""


class Reach(RobotEnv):
    """Bring the tip to a target, and hold it there.

    The target is where the tip is in a random configuration within the joint limits and without contact, so that it can
    be reached. The reward of a step is s / (s + d), with the distance d [m] and s = 2 ``tolerance``, less 0.02 of the
    mean square of the normalised actions. No state but a diverged one ends an episode. ``info`` has ``distance`` [m],
    ``is_success`` (within ``tolerance``), and the parts of the reward.
    """

    mode = "rate"
    extra = tuple((f"{what}/{axis}", "m") for what in ("tip", "error") for axis in "xyz")

    def __init__(
        self,
        model: str | PathLike[str] | Model,
        *,
        tip: str | None = None,
        spread: float = 1.0,
        tolerance: float = 0.05,
        **options: Any,
    ) -> None:
        """Make the environment.

        Args:
            model: As for :class:`RobotEnv`.
            tip: Name of a site or body; None for the one named frame of the last link of the chain with most joints, or
                of the hand that carries it if it is a jaw (:func:`.model.tip_body`), or of a link before; without one,
                for that link's origin.
            spread: Share of each joint's range, around home, from which targets are drawn.
            tolerance: Distance [m] within which the target is reached.
            options: Arguments of :class:`RobotEnv`.

        Raises:
            ValueError: The tip is unknown or ambiguous, a number is not positive, or :class:`RobotEnv` raises it.
        """
        if not 0.0 < spread <= 1.0 or not tolerance > 0.0:
            raise ValueError(f"spread must be in (0, 1] and tolerance positive, not {spread} and {tolerance}")
        super().__init__(model, **options)
        self._site, self._body = _tip(self.model, tip)
        self._spread, self._tolerance = spread, tolerance
        self._target = np.zeros(3)
        self._reject_resting_tip()

    @property
    def tip(self) -> Array:
        """Position (3,) [m] of the tip in the world."""
        position = self.data.site_xpos[self._site] if self._site >= 0 else self.data.xpos[self._body]
        return np.array(position)

    @property
    def tip_name(self) -> str:
        """The tip in words: ``site 'tool0'``."""
        kind, at = ("site", self._site) if self._site >= 0 else ("body", self._body)
        return f"{kind} '{name(self.model, kind.upper(), at)}'"

    @property
    def target(self) -> Array:
        """Position (3,) [m] of the target in the world."""
        return self._target.copy()

    def _reject_resting_tip(self) -> None:
        """Raise ValueError if the tip is at the same place in two configurations."""
        places, random = [], np.random.default_rng(0)
        with collected_warnings():
            for _ in range(2):
                self._draw_target(random, 1.0)
                places.append(self.tip)
        if float(np.linalg.norm(places[1] - places[0])) < _RESTING:
            raise ValueError(f"no joint moves the tip, {self.tip_name}; pass tip=... with another site or body")

    def _draw_target(self, random: np.random.Generator, spread: float) -> None:
        body = self._body if self._site < 0 else int(self.model.site_bodyid[self._site])
        self._configurations.draw(self.data, random, spread, self._range(), body=body)

    def _begin(self, options: Mapping[str, Any]) -> None:
        given = options.get("target")
        if given is None:
            self._draw_target(self.np_random, self._spread)
            self._target = self.tip
        else:
            self._target = np.asarray(given, dtype=np.float64).reshape(3).copy()
        super()._begin(options)

    def _extra(self) -> Array:
        return np.concatenate((self.tip, self._target - self.tip))

    def _state_info(self) -> Info:
        distance = float(np.linalg.norm(self._target - self.tip))
        return {"distance": distance, "is_success": distance <= self._tolerance}

    def _judge(self, action: Array) -> tuple[float, bool, Info]:
        info = self._state_info()
        scale = 2.0 * self._tolerance
        near = scale / (scale + info["distance"])
        share = action / np.maximum(self.action_space.high, -self.action_space.low)
        effort = _EFFORT * float(np.mean(share**2))
        return near - effort, False, {**info, "reward_distance": near, "reward_effort": -effort}

    def _markers(self) -> tuple[Marker, ...]:
        return (Marker(self._target, self._tolerance),)


def _tip(model: Model, given: str | None) -> tuple[int, int]:
    """Index of the site, or -1 and index of the body."""
    if given is None:
        body = tip_body(model)
        site = tip_frame(model, body)
        return (-1, body) if site is None else (site, -1)
    site, body = index(model, "SITE", given), index(model, "BODY", given)
    if site < 0 and body < 0:
        raise ValueError(f"tip: no site or body '{given}'; sites: {', '.join(frame_names(model)) or 'none'}")
    return site, body


_FALLEN = cos(radians(60.0))
_LOW = 0.4
"""Share of the height of home below which the robot has fallen."""
_POWER = 0.1
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
        self._effort = _POWER / weight
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
