"""Pinocchio as an observer of URDF and MJCF: rigid body algorithms independent of those of the simulators.

It merges fixed links into their parent's inertia, and gives a continuous joint two coordinates, cosine and sine.
https://github.com/stack-of-tasks/pinocchio
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from math import cos, inf, sin
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Pose, matrix3, quaternion_from_rotation, rotation_from_rpy, vector3
from stepbot.robot.dynamics import GRAVITY, Rates
from stepbot.robot.model import JointDynamics, Limit, Mimic

from ..ball_coordinates import Velocities, inner_joints
from ..captured_output import printed
from ..distribution import provider
from ..observation import (
    Dynamics,
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedJoint,
    ObservedLink,
    Quantity,
    Request,
)
from ..xml import xml_root
from . import ENGINE

_NOT_RUN: Mapping[Quantity, str] = {
    Quantity.MESHES: "checked by the simulating engines only",
    Quantity.SIMULATION: "Pinocchio does not simulate",
    Quantity.CLOSURES: "checked by the simulating engines only",
    Quantity.ACTUATORS: "Pinocchio ignores actuators",
    Quantity.SENSORS: "Pinocchio ignores sensors",
}
_MJCF_NOT_RUN: Mapping[Quantity, str] = {
    Quantity.MIMIC: "Pinocchio ignores joint equalities",
    Quantity.LIMITS: "Pinocchio assumes other bounds where MJCF has none, and ignores actuatorfrcrange",
    Quantity.DYNAMICS: "Pinocchio interprets MJCF springs and friction differently",
}
_LATE = "worldbody[1]/following-sibling::*[self::compiler or self::default]"
_TURNING = ("R", "Revolute")


def prepare() -> None:
    """Import the engine's slow modules."""
    import pinocchio  # noqa: F401


def observe(request: Request) -> Observation:
    """Build the model and report its content.

    Raises:
        EngineRefused: Pinocchio does not build it.
        EngineCannotRead: Several joints in one body, whose names Pinocchio does not keep; defaults behind bodies of an
            MJCF; a URDF with planar joints, or with floating ones within the robot.
    """
    import pinocchio as engine

    unmoved = inner_joints(Path(request.file)) if request.format == "urdf" else ""
    if unmoved:
        raise EngineCannotRead(f"Pinocchio moves these joints by coordinates of its own: {unmoved}")
    if request.format == "mjcf" and (late := xml_root(Path(request.file)).xpath(_LATE)):
        raise EngineCannotRead(f"Pinocchio reads <{late[0].tag}> only in front of the bodies that it applies to")
    with printed() as lines:
        try:
            build = engine.buildModelFromUrdf if request.format == "urdf" else engine.buildModelFromMJCF
            model = build(request.file)
            built = _Built(engine, model, request)
            mimics = _mimics(engine, request)
        except (ValueError, RuntimeError, IndexError) as error:
            folder = f"{Path(request.file).parent.as_posix()}/"
            raise EngineRefused(str(error).replace(folder, "").strip()) from error
        observation = built.observation(mimics)
    return replace(observation, warnings=tuple(dict.fromkeys(lines)))


def _mimics(engine: Any, request: Request) -> dict[str, Mimic] | str:
    """The mimic of each joint that has one, from a model with mimics; or why they are not reported."""
    if request.format != "urdf":
        return _MJCF_NOT_RUN[Quantity.MIMIC]
    try:
        model = engine.buildModelFromUrdf(request.file, mimic=True)
    except (ValueError, RuntimeError) as error:
        return f"Pinocchio does not support mimics of mimics: {error}"
    mimics = {}
    for follower, leader in zip(model.mimicking_joints, model.mimicked_joints, strict=True):
        joint = model.joints[follower].extract()
        mimics[model.names[follower]] = Mimic(model.names[leader], float(joint.scaling), float(joint.offset))
    return mimics


class _Built(Struct, frozen=True, dict=True):
    """A model and the tree of its frames."""

    engine: Any
    model: Any
    request: Request

    def observation(self, mimics: dict[str, Mimic] | str) -> Observation:
        model, request = self.model, self.request
        columns = tuple(self.columns)
        model.gravity.linear = np.array(GRAVITY)
        model.armature[:] = 0.0  # compared separately, if an engine reports it
        data = model.createData()
        mjcf = request.format == "mjcf"
        not_run = {**_NOT_RUN, **(_MJCF_NOT_RUN if mjcf else {})}
        if isinstance(mimics, str):
            not_run[Quantity.MIMIC] = mimics
        return Observation(
            engine=ENGINE.name,
            **provider("pinocchio"),
            format=request.format,
            base=("floating" if self.floats else "fixed") if mjcf else None,
            links=tuple(self.link(body) for body in self.bodies.values()),
            joints=tuple(self.joints(mimics if isinstance(mimics, dict) else None)),
            coordinates=columns,
            poses=tuple(self.poses(data, q) for q in [*request.configurations, *request.closed]),
            dynamics=tuple(self.dynamics(data, *at) for at in request.moments),
            not_run=not_run,
        )

    @cached_property
    def bodies(self) -> dict[str, int]:
        """Frame of each link by name, the root first; a `world` in which the robot floats is none."""
        body, worlds = self.engine.FrameType.BODY, {"universe", *(("world",) if self.floats else ())}
        return {
            frame.name: index
            for index, frame in enumerate(self.model.frames)
            if frame.type == body and (frame.name not in worlds or frame.parentJoint)
        }

    @cached_property
    def above(self) -> dict[str, Any]:
        """Frame of the joint above each link, fixed or moving; the root has none."""
        types = self.engine.FrameType
        frames = {}
        for name, index in self.bodies.items():
            holder = self.model.frames[index].parentFrame
            frame = self.model.frames[holder]
            if holder and frame.type in (types.FIXED_JOINT, types.JOINT) and not self._frees(frame):
                frames[name] = frame
        return frames

    def _frees(self, frame: Any) -> bool:
        kind = str(self.model.joints[frame.parentJoint].shortname())
        return kind == "JointModelFreeFlyer" and bool(frame.type == self.engine.FrameType.JOINT)

    @cached_property
    def floats(self) -> bool:
        """Whether the root has a free joint."""
        return any(joint.shortname() == "JointModelFreeFlyer" for joint in self.model.joints)

    @cached_property
    def columns(self) -> dict[str, int]:
        """For each coordinate, its joint.

        Raises:
            EngineCannotRead: Several joints in one body.
        """
        columns: dict[str, int] = {}
        for index, joint in enumerate(self.model.joints):
            kind, name = joint.shortname(), self.model.names[index]
            if kind == "JointModelComposite":
                raise EngineCannotRead(f"Pinocchio drops the names of several joints in one body ({name})")
            if kind == "JointModelSpherical":
                columns |= dict.fromkeys(self.request.balls.get(name, ()), index)
            elif index and kind != "JointModelFreeFlyer":
                columns[name] = index
        return columns

    def link(self, index: int) -> ObservedLink:
        """A link; if others are fixed to it, Pinocchio keeps only the total inertia."""
        frame, types = self.model.frames[index], self.engine.FrameType
        above = self.above.get(frame.name)
        if above is None:
            inertia = frame.inertia if not self.floats else self._whole(frame.parentJoint)
        elif above.type == types.FIXED_JOINT:
            inertia = above.inertia
        else:
            inertia = self._whole(frame.parentJoint)
        if inertia is None:
            return ObservedLink(frame.name)
        return ObservedLink(frame.name, float(inertia.mass), vector3(inertia.lever), matrix3(np.array(inertia.inertia)))

    def _whole(self, joint: int) -> Any:
        """Inertia of the links that are fixed together; None if there is more than one."""
        mine = [name for name, index in self.bodies.items() if self.model.frames[index].parentJoint == joint]
        return self.model.inertias[joint] if len(mine) == 1 else None

    def joints(self, mimics: Mapping[str, Mimic] | None) -> Iterator[ObservedJoint]:
        """The joint above each link."""
        for child, frame in self.above.items():
            parent = self._link_above(frame)
            if frame.type == self.engine.FrameType.FIXED_JOINT:
                name = frame.name if self.request.format == "urdf" else ""
                yield ObservedJoint(name, "fixed", parent, child, mimic_read=mimics is not None)
            else:
                yield self._moving(frame, parent, child, mimics)

    def _link_above(self, frame: Any) -> str:
        """The link that is the parent of a joint's frame.

        Raises:
            EngineCannotRead: The joint moves a body of the world, which is no link of the model.
        """
        index = frame.parentFrame
        while index and self.model.frames[index].type != self.engine.FrameType.BODY:
            index = self.model.frames[index].parentFrame
        if not index:
            raise EngineCannotRead(f"Pinocchio keeps no world, to which '{frame.name}' is a joint")
        return str(self.model.frames[index].name)

    def _moving(self, frame: Any, parent: str, child: str, mimics: Mapping[str, Mimic] | None) -> ObservedJoint:
        model, joint = self.model, self.model.joints[frame.parentJoint]
        kind, v, q = joint.shortname().removeprefix("JointModel"), joint.idx_v, joint.idx_q
        if kind == "Spherical":
            return ObservedJoint(frame.name, "ball", parent, child, mimic_read=mimics is not None)
        endless = joint.nq == 2
        lower, upper = (-inf, inf) if endless else (model.lowerPositionLimit[q], model.upperPositionLimit[q])
        word = "prismatic" if not kind.startswith(_TURNING) else "continuous" if endless else "revolute"
        return ObservedJoint(
            frame.name,
            word,
            parent,
            child,
            axis=vector3(self._axis(joint, word)),
            limit=Limit(*map(float, (lower, upper, model.upperVelocityLimit[v], model.upperEffortLimit[v]))),
            dynamics=JointDynamics(float(model.damping[v]), float(model.upperDryFrictionLimit[v])),
            mimic=None if mimics is None else mimics.get(frame.name),
            mimic_read=mimics is not None,
        )

    def _axis(self, joint: Any, word: str) -> Array:
        """Axis in the child's frame: the child's velocity at unit joint speed, linear before angular."""
        data = joint.createData()
        joint.calc(data, self.engine.neutral(self.model))
        motion: Array = np.array(data.S).reshape(6)
        return motion[:3] if word == "prismatic" else motion[3:]

    def q(self, at: Mapping[str, float]) -> Array:
        """Pinocchio's configuration vector."""
        q: Array = np.array(self.engine.neutral(self.model))
        for name, index in self.columns.items():
            joint, value = self.model.joints[index], float(at.get(name, 0.0))
            if joint.nq == 1:
                q[joint.idx_q] = value
            elif joint.nq == 2:
                q[joint.idx_q : joint.idx_q + 2] = cos(value), sin(value)
        for names, start, _ in self._balls:
            yaw, pitch, roll = (float(at.get(name, 0.0)) for name in names)
            w, x, y, z = quaternion_from_rotation(rotation_from_rpy((roll, pitch, yaw)))
            q[start : start + 4] = x, y, z, w
        return q

    @cached_property
    def _balls(self) -> list[tuple[tuple[str, str, str], int, int]]:
        """Coordinates of each ball, and their offsets in q and in v."""
        balls = self.request.balls
        joints = {name: self.model.joints[index] for index, name in enumerate(self.model.names)}
        return [
            (names, joints[ball].idx_q, joints[ball].idx_v)
            for ball, names in balls.items()
            if ball in joints and joints[ball].shortname() == "JointModelSpherical"
        ]

    @cached_property
    def velocities(self) -> Velocities:
        """Pinocchio's velocities from those of the coordinates."""
        joints = {name: self.model.joints[index] for name, index in self.columns.items()}
        single = [(joint.idx_v, name, 1.0) for name, joint in joints.items() if joint.nv == 1]
        balls = [(names, start) for names, _, start in self._balls]
        return Velocities(self.model.nv, tuple(self.columns), single, balls)

    def poses(self, data: Any, at: Mapping[str, float]) -> dict[str, Pose]:
        """Pose of every link relative to the first."""
        self.engine.framesForwardKinematics(self.model, data, self.q(at))
        X_W = {name: Pose.of(data.oMf[i].rotation, data.oMf[i].translation) for name, i in self.bodies.items()}
        if not X_W:
            return {}
        X_RW = next(iter(X_W.values())).inverse()
        return {name: X_RW @ X for name, X in X_W.items()}

    def dynamics(self, data: Any, at: Mapping[str, float], rates: Rates) -> Dynamics:
        """Mass matrix, gravity forces and inverse dynamics in the coordinates."""
        engine, model, q = self.engine, self.model, self.q(at)
        E = self.velocities.rates(at)
        upper = np.triu(np.array(engine.crba(model, data, q)))
        M = upper + np.triu(upper, 1).T
        gravity = np.array(engine.computeGeneralizedGravity(model, data, q))
        inverse = np.array(engine.rnea(model, data, q, *self.velocities.moving(at, rates)))
        return Dynamics(E.T @ M @ E, E.T @ gravity, E.T @ inverse)
