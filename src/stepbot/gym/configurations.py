"""Random configurations that the robot can take, without contact."""

from collections.abc import Mapping
from math import pi
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import Array

from .controls import actuators
from .model import Model, floating_base, has_loops, index, joint_kind, joints_of, name, path

_TOUCH = 1e-4
"""Depth [m] up to which two shapes touch without overlapping: flush faces of CAD."""
_TRIES = 100
_MOVING = 0.5
"""Time [s] for which a robot with closed loops moves to its next configuration."""
_LIFTS = 5


class Configurations:
    """Home, and configurations around it."""

    def __init__(self, model: Model, keyframe: str, changed: Mapping[str, float]) -> None:
        """Find home.

        Args:
            model: The compiled model.
            keyframe: Name of the keyframe; if there is none of this name, home is ``qpos0``.
            changed: Positions [rad or m] of joints that differ from it, by name.

        Raises:
            ValueError: A joint is unknown, has several coordinates, or is in a model with closed loops; a position is
                beyond the joint's limits.
        """
        self._model = model
        key = index(model, "KEY", keyframe)
        self.keyframe = key if key >= 0 else None
        self.q: Array = np.array(model.key_qpos[key] if key >= 0 else model.qpos0)
        self.changed = {_scalar_joint(model, joint): value for joint, value in changed.items()}
        if changed and has_loops(model):
            raise ValueError("home=... would open the closed loops of this robot; add a keyframe to the MJCF instead")
        for joint, value in self.changed.items():
            _check_within_limits(model, joint, value)
            self.q[model.jnt_qposadr[joint]] = value
        self._follow(self.q)
        scalar = self._drawn = _drawn_joints(model)
        self._at = model.jnt_qposadr[scalar]
        limited = model.jnt_limited[scalar].astype(bool)
        ends = model.jnt_range[scalar]
        home = self.q[self._at]
        turn = np.where([joint_kind(model, joint) == "hinge" for joint in scalar], pi, 0.0)
        self._low = np.where(limited, ends[:, 0], home - turn)
        self._high = np.where(limited, ends[:, 1], home + turn)
        self._base = floating_base(model)
        self._known = frozenset[tuple[int, int]]()

    def place(self, data: Any, q: Array) -> None:
        """Set a configuration at rest, with poses and contacts."""
        mujoco.mj_resetData(self._model, data)
        data.qpos[:] = q
        mujoco.mj_fwdPosition(self._model, data)

    def lift(self, data: Any) -> None:
        """Lift a floating base until no shape is in the floor."""
        for _ in range(_LIFTS if self._base is not None else 0):
            depth = self._depth_in_world(data)
            if depth <= _TOUCH:
                break
            data.qpos[self._model.jnt_qposadr[self._base] + 2] += depth
            mujoco.mj_fwdPosition(self._model, data)

    def go_home(self, data: Any) -> None:
        """Set the configuration of home; contacts at home are not counted in others."""
        self.place(data, self.q)
        self._known = frozenset(self._contacts(data))

    def draw(
        self,
        data: Any,
        random: np.random.Generator,
        spread: float,
        controls: tuple[Array, Array, Array],
        *,
        body: int | None = None,
        lift: bool = False,
    ) -> None:
        """Set a random configuration at rest, without contacts other than at home.

        The joints with actuators are drawn, but not wheels: unlimited joints with a velocity.

        Args:
            data: State to be set.
            random: Source of random numbers.
            spread: Share of each joint's range, around home; unlimited hinges have a range of one turn.
            controls: Lowest, home and highest controls, which move a robot with closed loops: its joints depend on each
                other.
            body: Body whose place is drawn: only joints that move it change, unless there are loops; None for all.
            lift: Whether a floating base may be lifted, where legs would be in the floor.

        Raises:
            ValueError: None was found.
        """
        chosen = self._moving(body)
        for _ in range(_TRIES):
            if has_loops(self._model):
                if not self._move(data, random, spread, controls):
                    continue
            else:
                q, shares = self.q.copy(), random.random(len(self._at))
                drawn = self._low + shares * (self._high - self._low)
                home = q[self._at]
                q[self._at] = home + np.where(chosen, spread * (drawn - home), 0.0)
                self._follow(q)
                self.place(data, q)
                if lift:
                    self.lift(data)
            if not set(self._contacts(data)) - self._known:
                return
        raise ValueError(f"no configuration without contact in {_TRIES} random ones; reduce spread={spread:g}")

    def _move(
        self, data: Any, random: np.random.Generator, spread: float, controls: tuple[Array, Array, Array]
    ) -> bool:
        """Let the actuators move the robot from home towards random controls; whether the simulation stays finite."""
        low, home, high = (np.nan_to_num(control, posinf=pi, neginf=-pi) for control in controls)
        self.place(data, self.q)
        data.ctrl[:] = home + spread * (random.uniform(low, high) - home)
        mujoco.mj_step(self._model, data, max(1, round(_MOVING / self._model.opt.timestep)))
        if diverged(data):
            return False
        data.qvel[:] = 0.0
        data.time = 0.0
        mujoco.mj_fwdPosition(self._model, data)
        return True

    def _moving(self, body: int | None) -> NDArray[np.bool_]:
        """Which of the drawn joints are drawn for a body: those above it, and those that followers above it follow."""
        if body is None:
            return np.ones(len(self._drawn), dtype=bool)
        model = self._model
        above = {joint for one in path(model, body) for joint in joints_of(model, one)}
        for constraint in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_JOINT):
            if int(model.eq_obj1id[constraint]) in above:
                above.add(int(model.eq_obj2id[constraint]))
        return np.isin(self._drawn, list(above))

    def _follow(self, q: Array) -> None:
        """Set the joints that follow others by an equality."""
        model = self._model
        for _ in range(2):  # followers of followers
            for constraint in range(model.neq):
                if model.eq_type[constraint] != mujoco.mjtEq.mjEQ_JOINT or not model.eq_active0[constraint]:
                    continue
                follower, leader = int(model.eq_obj1id[constraint]), int(model.eq_obj2id[constraint])
                at = int(model.jnt_qposadr[follower])
                moved = 0.0
                if leader >= 0:
                    start = int(model.jnt_qposadr[leader])
                    moved = q[start] - model.qpos0[start]
                q[at] = model.qpos0[at] + np.polynomial.polynomial.polyval(moved, model.eq_data[constraint][:5])

    def _contacts(self, data: Any) -> list[tuple[int, int]]:
        """Pairs of geoms that overlap."""
        return [(int(one.geom1), int(one.geom2)) for one in data.contact[: data.ncon] if one.dist < -_TOUCH]

    def _depth_in_world(self, data: Any) -> float:
        """Deepest overlap [m] with a shape that does not move, as the floor."""
        weld = self._model.body_weldid[self._model.geom_bodyid]
        depths = [-one.dist for one in data.contact[: data.ncon] if (weld[one.geom1] == 0) != (weld[one.geom2] == 0)]
        return float(max(depths, default=0.0))


def _drawn_joints(model: Model) -> list[int]:
    """Hinges and slides that actuators hold in place; all of them if an actuator acts on something else."""
    acting = actuators(model)
    scalar = [joint for joint in range(model.njnt) if joint_kind(model, joint) in ("hinge", "slide")]
    if any(one.joint is None for one in acting):
        return scalar
    wheels = {one.joint for one in acting if one.drives == "velocity"}
    driven = {one.joint for one in acting}
    return [joint for joint in scalar if joint in driven and (model.jnt_limited[joint] or joint not in wheels)]


def _scalar_joint(model: Model, joint: str) -> int:
    """Index of a hinge or slide."""
    number = index(model, "JOINT", joint)
    if number < 0 or joint_kind(model, number) not in ("hinge", "slide"):
        scalar = [j for j in range(model.njnt) if joint_kind(model, j) in ("hinge", "slide")]
        raise ValueError(
            f"home: no hinge or slide '{joint}'; there are {', '.join(name(model, 'JOINT', j) for j in scalar)}"
        )
    return number


def _check_within_limits(model: Model, joint: int, position: float) -> None:
    low, high = model.jnt_range[joint]
    if model.jnt_limited[joint] and not low <= position <= high:
        unit = "rad" if joint_kind(model, joint) == "hinge" else "m"
        at = f"joint '{name(model, 'JOINT', joint)}' at {position:g} {unit}"
        raise ValueError(f"home: {at} is beyond its limits, {low:.6g} to {high:.6g} {unit}")


def diverged(data: Any) -> bool:
    """Whether a state is not finite, or MuJoCo has warned that it is about to be."""
    kinds = mujoco.mjtWarning
    bad = (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC)
    if any(data.warning[int(kind)].number for kind in bad):
        return True
    return not (np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all())
