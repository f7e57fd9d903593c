"""Coordinates of a MuJoCo model, converted to those of the reference: three angles per ball, one per screw."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from stepbot.geometry.spatial import Array, rotation_from_rpy, rpy_from_rotation
from stepbot.geometry.spatial import quaternion_from_rotation as quaternion
from stepbot.geometry.spatial import rotation_from_quaternion as rotation

from ..ball_coordinates import Velocities
from .joints import screw_pitch

if TYPE_CHECKING:
    from .model import NamedModel

Balls = Mapping[str, tuple[str, str, str]]


class Coordinates:
    """Positions and velocities of a model's joints as functions of named coordinates.

    MuJoCo stores the rotation of a ball as a quaternion, and its velocity as the angular velocity in the child's frame.
    """

    def __init__(self, compiled: "NamedModel", balls: Balls) -> None:
        """Classify the joints.

        Args:
            balls: The coordinates yaw, pitch and roll of each ball joint; a ball without coordinates does not move.
        """
        engine, model = compiled.engine, compiled.model
        self._model = model
        self._single: dict[str, int] = {}
        self._screws: list[tuple[int, str, float]] = []
        self._balls: dict[tuple[str, str, str], int] = {}
        names: list[str] = []
        for joint in range(model.njnt):
            kind, name = compiled.joint_type(joint), compiled.name("JOINT", joint)
            pitch = screw_pitch(compiled, joint) if kind == engine.mjtJoint.mjJNT_SLIDE else None
            if pitch is not None:
                self._screws.append((joint, compiled.name("JOINT", joint + 1), pitch))
            elif kind in (engine.mjtJoint.mjJNT_HINGE, engine.mjtJoint.mjJNT_SLIDE):
                self._single[name] = joint
                names.append(name)
            elif kind == engine.mjtJoint.mjJNT_BALL and name in balls:
                self._balls[balls[name]] = joint
                names += balls[name]
        self.names = tuple(names)
        address = model.jnt_dofadr.tolist()
        single = [(address[joint], name, 1.0) for name, joint in self._single.items()]
        single += [(address[joint], leader, pitch) for joint, leader, pitch in self._screws]
        turning = [(names, address[joint]) for names, joint in self._balls.items()]
        self.velocities = Velocities(model.nv, self.names, single, turning)

    def place(self, qpos: Any, q: Mapping[str, float]) -> None:
        """Set the joints to ``q``; missing coordinates are 0."""
        address = self._model.jnt_qposadr
        for name, joint in self._single.items():
            qpos[address[joint]] = q.get(name, 0.0)
        for joint, leader, pitch in self._screws:
            qpos[address[joint]] = pitch * q.get(leader, 0.0)
        for names, joint in self._balls.items():
            yaw, pitch, roll = (q.get(name, 0.0) for name in names)
            start = address[joint]
            qpos[start : start + 4] = quaternion(rotation_from_rpy((roll, pitch, yaw)))

    def read(self, qpos: Any) -> dict[str, float]:
        """The coordinates of the current configuration; a screw's slide joint is not among them, only its hinge."""
        address = self._model.jnt_qposadr
        q = {name: float(qpos[address[joint]]) for name, joint in self._single.items()}
        for names, joint in self._balls.items():
            roll, pitch, yaw = rpy_from_rotation(rotation(qpos[address[joint] : address[joint] + 4].tolist()))
            q.update(zip(names, (yaw, pitch, roll), strict=True))
        return {name: q[name] for name in self.names}


NEAR_LOCK = 0.5
"""Volume spanned by the three unit axes, below which a motion towards the lock is reversed: 30 degrees from it."""
_LIGHT = 1e-6
"""Maximum mass of a body between hinges, as a share of the mass that it carries."""
_SAME_PLACE = 1e-6
"""Distance [m] up to which axes intersect in one point."""


class Gimbals:
    """The series of three hinges of a model, monitored during simulation."""

    def __init__(self, compiled: "NamedModel", data: Any) -> None:
        rows = _rows(compiled, data)
        self._compiled = compiled
        self._names = [", ".join(f"'{compiled.name('JOINT', joint)}'" for joint in row) for row in rows]
        self._rows = np.array(rows, dtype=np.intp).reshape(-1, 3)
        self._volumes = self._spanned(data)
        self._reversed: set[str] = set()

    @property
    def notes(self) -> tuple[str, ...]:
        """The changes made to the motion, for messages."""
        return tuple(
            f"motion reversed where hinges {names} approach gimbal lock; the ball joint they replace has no gimbal lock"
            for names in self._names
            if names in self._reversed
        )

    def turn_back(self, data: Any) -> None:
        """Reverse all velocities if a series approaches its lock too closely."""
        if not len(self._rows):
            return
        before, self._volumes = self._volumes, self._spanned(data)
        closing = (self._volumes < NEAR_LOCK) & (self._volumes < before)
        if closing.any():
            data.qvel[:] = -data.qvel
            self._reversed.update(names for names, near in zip(self._names, closing, strict=True) if near)

    def _spanned(self, data: Any) -> Array:
        """Volume spanned by the axes of each series: 1 if they are orthogonal, 0 in the lock."""
        # a step leaves the axes as they were at its start
        self._compiled.engine.mj_kinematics(self._compiled.model, data)
        return np.asarray(np.abs(np.linalg.det(np.array(data.xaxis)[self._rows])))


def _rows(compiled: "NamedModel", data: Any) -> list[tuple[int, int, int]]:
    """Every series of three hinges with intersecting axes and nearly massless bodies in between that is not locked."""
    rows = []
    for last in range(compiled.model.njnt):
        middle = _before(compiled, last)
        first = None if middle is None else _before(compiled, middle)
        if first is None or middle is None:
            continue
        row = (first, middle, last)
        anchors, axes = np.array(data.xanchor)[list(row)], np.array(data.xaxis)[list(row)]
        meet = float(np.abs(anchors - anchors[0]).max()) < _SAME_PLACE
        if meet and abs(float(np.linalg.det(axes))) >= NEAR_LOCK:
            rows.append(row)
    return rows


def _before(compiled: "NamedModel", joint: int) -> int | None:
    """The hinge before a hinge, in its body or in a massless parent; None if there is none."""
    model, hinge = compiled.model, compiled.engine.mjtJoint.mjJNT_HINGE
    if compiled.joint_type(joint) != hinge:
        return None
    body = int(model.jnt_bodyid[joint])
    before = joint - 1
    if joint == model.body_jntadr[body]:
        above = int(model.body_parentid[body])
        if not model.body_jntnum[above] or model.body_mass[above] > _LIGHT * model.body_subtreemass[above]:
            return None
        before = int(model.body_jntadr[above] + model.body_jntnum[above]) - 1
    return before if compiled.joint_type(before) == hinge else None
