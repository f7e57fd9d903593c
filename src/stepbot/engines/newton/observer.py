"""Newton as an observer of OpenUSD: its importer, its forward kinematics and its mass matrix, on the CPU.

Newton compiles its kernels on first use, which takes about a minute, and keeps them in its own cache. It has single
precision. https://newton-physics.github.io/newton
"""

import warnings
from collections.abc import Iterator, Mapping
from functools import cached_property
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, Pose, matrix3, quaternion_from_rotation, rotation_from_rpy, unit, vector3
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.model import ActuatorKind, JointDynamics, JointKind, Limit, Mimic

from ..captured_output import printed
from ..distribution import provider
from ..observation import (
    Dynamics,
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedActuator,
    ObservedClosure,
    ObservedJoint,
    ObservedLink,
    Quantity,
    Request,
    turned_as_expected,
)
from ..usd.stage import name_of
from . import ENGINE

_NOT_RUN: Mapping[Quantity, str] = {
    Quantity.MESHES: "Newton keeps shapes in its own form; they are read through USD's library",
    Quantity.CONTACTS: "read through USD's library",
    Quantity.GRAVITY: "Newton has no function for gravity forces",
    Quantity.INVERSE_DYNAMICS: "Newton's inverse dynamics is not compared",
    Quantity.SIMULATION: "Newton's solvers need a robot with contact parameters of their own",
}
_BALL_RATES = "Newton's velocities of ball joints are not those of yaw, pitch and roll"
_DECIMALS = 6


def prepare() -> None:
    """Import the engine's slow modules; schemas first, as USD's registry is filled once."""
    import newton_usd_schemas  # noqa: F401, I001
    import newton  # noqa: F401


def observe(request: Request) -> Observation:
    """Import the stage and report its content.

    Raises:
        EngineRefused: Newton does not import it.
        EngineCannotRead: It has joints that Newton merges or does not support.
    """
    import newton_usd_schemas  # noqa: F401, I001
    import newton as engine
    import warp
    from pxr import Tf, Usd

    warp.config.quiet = True
    with printed(), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            stage = Usd.Stage.Open(request.file)
            builder = engine.ModelBuilder()
            # Approximations are computed when a simulation starts, and need further packages.
            builder.add_usd(stage, skip_mesh_approximation=True)
            model = builder.finalize(device="cpu")
        except (Tf.ErrorException, ValueError, RuntimeError, KeyError) as error:
            folder = f"{Path(request.file).parent.as_posix()}/"
            raise EngineRefused(str(error).replace(folder, "").strip()) from error
        return _Loaded(engine, stage, builder, model, request).observation(
            [str(one.message) for one in caught if one.category.__name__ == "NewtonWarning"]
        )


class _Loaded(Struct, frozen=True, dict=True):
    """A model and the stage that it was imported from."""

    engine: Any
    stage: Any
    builder: Any
    model: Any
    request: Request

    def observation(self, messages: list[str]) -> Observation:
        """Everything that Newton reports."""
        joints = tuple(self.joints())
        balls = [joint.name for joint in joints if joint.kind == JointKind.BALL]
        not_run = dict(_NOT_RUN) | ({Quantity.MASS_MATRIX: _BALL_RATES} if balls else {})
        return Observation(
            engine=ENGINE.name,
            **provider("newton"),
            format=self.request.format,
            base="fixed" if self.held else "floating",
            links=tuple(map(self.link, range(len(self.bodies)))),
            joints=joints,
            coordinates=tuple(self.columns),
            poses=tuple(self.poses(q) for q in [*self.request.configurations, *self.request.closed]),
            dynamics=() if balls else tuple(self.dynamics(q) for q in self.request.configurations),
            closures=tuple(self.closures()),
            actuators=tuple(self.actuators()),
            warnings=tuple(dict.fromkeys(messages)),
            not_run=not_run,
        )

    def named(self, path: str) -> str:
        return name_of(self.stage.GetPrimAtPath(path))

    @cached_property
    def bodies(self) -> list[str]:
        return [self.named(path) for path in self.builder.body_label]

    @cached_property
    def tree(self) -> list[int]:
        """The joints between two bodies that are part of an articulation."""
        return [i for i in self.inner if self.builder.joint_articulation[i] >= 0]

    @cached_property
    def inner(self) -> list[int]:
        """The joints between two bodies."""
        return [i for i, parent in enumerate(self.builder.joint_parent) if parent >= 0]

    @cached_property
    def held(self) -> bool:
        """Whether a fixed joint holds a body to the world."""
        types = self.engine.JointType
        ends = zip(self.builder.joint_parent, self.builder.joint_type, strict=True)
        return any(parent < 0 and kind == types.FIXED for parent, kind in ends)

    @cached_property
    def kinds(self) -> dict[int, str]:
        """The kind of each type of joint."""
        types = self.engine.JointType
        return {
            types.FIXED: JointKind.FIXED.value,
            types.REVOLUTE: JointKind.REVOLUTE.value,
            types.PRISMATIC: JointKind.PRISMATIC.value,
            types.BALL: JointKind.BALL.value,
        }

    def kind(self, i: int) -> str:
        """Kind of a joint; Newton does not distinguish continuous ones.

        Raises:
            EngineCannotRead: Newton has made a joint of several degrees of freedom of it.
        """
        kind = self.builder.joint_type[i]
        if kind not in self.kinds:
            raise EngineCannotRead(f"joint {self.builder.joint_label[i]} is of Newton's type {kind}")
        return self.kinds[kind]

    @cached_property
    def columns(self) -> dict[str, int]:
        """For each coordinate, its index among the velocities; balls have three."""
        columns: dict[str, int] = {}
        for i in self.tree:
            name, start = self.named(self.builder.joint_label[i]), self.builder.joint_qd_start[i]
            if self.kind(i) == JointKind.BALL:
                names = self.request.balls.get(name, ())
                columns |= {one: start + number for number, one in enumerate(names)}
            elif self.kind(i) != JointKind.FIXED:
                columns[name] = start
        return columns

    def link(self, i: int) -> ObservedLink:
        model = self.model
        return ObservedLink(
            self.bodies[i],
            float(model.body_mass.numpy()[i]),
            vector3(model.body_com.numpy()[i]),
            matrix3(model.body_inertia.numpy()[i]),
        )

    def joints(self) -> Iterator[ObservedJoint]:
        for i in self.tree:
            yield self.joint(i)

    def joint(self, i: int) -> ObservedJoint:
        """A joint."""
        builder, kind = self.builder, self.kind(i)
        parent, child = (self.bodies[j] for j in (builder.joint_parent[i], builder.joint_child[i]))
        name, X_CJ = self.named(builder.joint_label[i]), _pose(builder.joint_X_c[i])
        anchor = vector3(np.round(X_CJ.p, _DECIMALS) + 0.0)
        if kind in (JointKind.FIXED, JointKind.BALL):
            return ObservedJoint(name, kind, parent, child, anchor=anchor, mimic_read=True)
        v = builder.joint_qd_start[i]
        lower, upper = float(builder.joint_limit_lower[v]), float(builder.joint_limit_upper[v])
        velocity, effort = float(builder.joint_velocity_limit[v]), float(builder.joint_effort_limit[v])
        limit = Limit(
            lower,
            upper,
            velocity if velocity < builder.default_joint_cfg.velocity_limit else inf,
            effort if effort < builder.default_joint_cfg.effort_limit else inf,
        ).without_beyond(NO_BOUND)
        actuated = self.actuator(i) is not None
        return ObservedJoint(
            name,
            kind,
            parent,
            child,
            axis=vector3(X_CJ.turn(unit(builder.joint_axis[v]))),
            anchor=anchor,
            limit=limit,
            # The effort limit of an actuator is its own.
            limit_fields=("lower", "upper", "velocity", *(() if actuated else ("effort",))),
            dynamics=JointDynamics(
                float(builder.joint_damping[v]),
                float(builder.joint_friction[v]),
                armature=float(builder.joint_armature[v]),
            ),
            dynamics_fields=("damping", "friction", "armature"),
            mimic=self.mimic(i),
            mimic_read=True,
        )

    def mimic(self, i: int) -> Mimic | None:
        """The joint that another one follows."""
        leader = self.builder.joint_mimic_joint[i]
        if leader < 0:
            return None
        offset, multiplier = self.builder.joint_mimic_coeffs[i]
        return Mimic(self.named(self.builder.joint_label[leader]), float(multiplier), float(offset))

    def closures(self) -> Iterator[ObservedClosure]:
        """Joints between two bodies that are in no articulation."""
        for i in (i for i in self.inner if i not in self.tree):
            builder, kind = self.builder, self.kind(i)
            ends = self.bodies[builder.joint_parent[i]], self.bodies[builder.joint_child[i]]
            frames = _pose(builder.joint_X_p[i]), _pose(builder.joint_X_c[i])
            moves = kind not in (JointKind.FIXED, JointKind.BALL)
            axis = vector3(unit(builder.joint_axis[builder.joint_qd_start[i]])) if moves else None
            name = self.named(builder.joint_label[i])
            yield turned_as_expected(name, kind, ends, frames, axis, self.request.closures)

    def actuators(self) -> Iterator[ObservedActuator]:
        """The drives that are actuators."""
        yield from (actuator for i in self.tree if (actuator := self.actuator(i)) is not None)

    def actuator(self, i: int) -> ObservedActuator | None:
        """The actuator of a joint: a drive with gains or a name; one with neither is a limit of the effort."""
        if self.kind(i) not in (JointKind.REVOLUTE, JointKind.PRISMATIC):
            return None
        path, v = self.builder.joint_label[i], self.builder.joint_qd_start[i]
        kp, kv = float(self.builder.joint_target_ke[v]), float(self.builder.joint_target_kd[v])
        name = str(self.stage.GetPrimAtPath(path).GetCustomDataByKey("actuator") or "")
        if not (name or kp or kv):
            return None
        effort = float(self.builder.joint_effort_limit[v])
        kind = ActuatorKind.POSITION if kp else ActuatorKind.VELOCITY if kv else ActuatorKind.MOTOR
        bound = (-effort, effort) if effort < self.builder.default_joint_cfg.effort_limit else (-inf, inf)
        ranges = (bound, None) if kind is ActuatorKind.MOTOR else (None, bound)
        return ObservedActuator(name, self.named(path), kind.value, kp, kv, None, *ranges)

    def poses(self, at: Mapping[str, float]) -> dict[str, Pose]:
        """Pose of every link relative to the first."""
        state = self._state(at)
        X_W = {name: _pose(X) for name, X in zip(self.bodies, state.body_q.numpy(), strict=True)}
        X_RW = X_W[self.bodies[0]].inverse()
        return {name: X_RW @ X for name, X in X_W.items()}

    def dynamics(self, at: Mapping[str, float]) -> Dynamics:
        """Mass matrix in the coordinates."""
        if not self.columns:
            return Dynamics()
        H = self.engine.eval_mass_matrix(self.model, self._state(at), include_armature=False)
        rows = list(self.columns.values())
        M: Array = np.asarray(H.numpy()[0], dtype=np.float64)[np.ix_(rows, rows)]
        return Dynamics(mass_matrix=M)

    def _state(self, at: Mapping[str, float]) -> Any:
        """The state at a configuration; a floating base stays where the file has it."""
        import warp

        q = self.model.joint_q.numpy().copy()
        for i in self.tree:
            name, start = self.named(self.builder.joint_label[i]), self.builder.joint_q_start[i]
            if self.kind(i) == JointKind.BALL:
                yaw, pitch, roll = (float(at.get(one, 0.0)) for one in self.request.balls.get(name, ("", "", "")))
                w, x, y, z = quaternion_from_rotation(rotation_from_rpy((roll, pitch, yaw)))
                q[start : start + 4] = x, y, z, w
            elif self.kind(i) != JointKind.FIXED:
                q[start] = float(at.get(name, 0.0))
        self.model.joint_q.assign(q)
        state = self.model.state()
        self.engine.eval_fk(self.model, warp.array(q, dtype=float, device="cpu"), self.model.joint_qd, state)
        return state


def _pose(transform: Any) -> Pose:
    """A transform of Warp: position, then quaternion (x, y, z, w)."""
    x, y, z, qx, qy, qz, qw = (float(value) for value in transform)
    return Pose.from_quaternion((qw, qx, qy, qz), (x, y, z))
