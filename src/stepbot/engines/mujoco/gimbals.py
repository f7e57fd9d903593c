"""Hinges in a row that stand for a ball joint, and the lock that such a row has and the ball joint has not."""

from typing import TYPE_CHECKING, Any

import numpy as np

from stepbot.geometry.spatial import Array

if TYPE_CHECKING:
    from .model import NamedModel

NEAR_LOCK = 0.5
"""Volume that the three unit axes span, below which a motion towards the lock is reversed: 30 degrees from it."""
_LIGHT = 1e-6
"""Mass of a body between hinges at most, as a share of all that it carries."""
_SAME_PLACE = 1e-6
"""Distance [m] within which axes meet in one point."""


class Gimbals:
    """The rows of three hinges of a model, watched while it moves."""

    def __init__(self, compiled: "NamedModel", data: Any) -> None:
        rows = _rows(compiled, data)
        self._compiled = compiled
        self._names = [_names(compiled, row) for row in rows]
        self._rows = np.array(rows, dtype=np.intp).reshape(-1, 3)
        self._volumes = self._spanned(data)
        self._reversed: set[str] = set()

    @property
    def notes(self) -> tuple[str, ...]:
        """What was done to the motion, for people."""
        return tuple(
            f"motion reversed where hinges {names} approach gimbal lock; the ball joint they replace has no gimbal lock"
            for names in self._names
            if names in self._reversed
        )

    def turn_back(self, data: Any) -> None:
        """Reverse all velocities where a row moves closer to its lock than it should."""
        if not len(self._rows):
            return
        before, self._volumes = self._volumes, self._spanned(data)
        closing = (self._volumes < NEAR_LOCK) & (self._volumes < before)
        if closing.any():
            data.qvel[:] = -data.qvel
            self._reversed.update(names for names, near in zip(self._names, closing, strict=True) if near)

    def _spanned(self, data: Any) -> Array:
        """Volume that the axes of each row span: 1 where they are normal to each other, 0 in the lock."""
        self._compiled.engine.mj_kinematics(self._compiled.model, data)  # a step leaves the axes where it began
        return np.asarray(np.abs(np.linalg.det(np.array(data.xaxis)[self._rows])))


def _rows(compiled: "NamedModel", data: Any) -> list[tuple[int, int, int]]:
    """Every three hinges in a row whose axes meet in a point, with no mass to speak of between, that are not locked."""
    found = []
    for last in range(compiled.model.njnt):
        middle = _before(compiled, last)
        first = None if middle is None else _before(compiled, middle)
        if first is None or middle is None:
            continue
        row = (first, middle, last)
        anchors, axes = np.array(data.xanchor)[list(row)], np.array(data.xaxis)[list(row)]
        meet = float(np.abs(anchors - anchors[0]).max()) < _SAME_PLACE
        if meet and abs(float(np.linalg.det(axes))) >= NEAR_LOCK:
            found.append(row)
    return found


def _before(compiled: "NamedModel", joint: int) -> int | None:
    """The hinge before a hinge, in its body or in one without mass that carries it; None where there is no such one."""
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


def _names(compiled: "NamedModel", row: tuple[int, int, int]) -> str:
    return ", ".join(f"'{compiled.name('JOINT', joint)}'" for joint in row)
