"""Decides whether two chains are the same joint in different representations; and if not, why not.

Single joints must be in the same order and of the same types; their axes are compared later, like those of all joints.
A ball joint is anything that reaches every rotation about its centre: three revolute joints without limits about axes
through it, with the second perpendicular to the first and to the third.
"""

from collections.abc import Sequence
from math import atan2, isfinite, pi

import numpy as np
from msgspec import Struct, field

from stepbot.engines.observation import Quantity
from stepbot.geometry.spatial import Array, rotation_about

from .chains import Chain, Step, common_point, direction, foot
from .deviation import TOLERANCES


class BallAngles:
    """Rotations, their rates, and the conversion from a rotation to the angles."""

    def __init__(self, axes: Array) -> None:
        """Store the axes, unit vectors, shape (3, 3), one per row."""
        self.axes = axes

    @property
    def slant(self) -> tuple[float, float]:
        """Deviation [rad] from perpendicularity of the second axis to the first, and of the third to the second."""
        first, second, third = self.axes
        return abs(float(np.arcsin(first @ second))), abs(float(np.arcsin(second @ third)))

    def rotation(self, angles: Sequence[float]) -> Array:
        """The rotation (3, 3) at three angles [rad]."""
        R = np.eye(3)
        for axis, angle in zip(self.axes, angles, strict=True):
            R = R @ rotation_about(axis, angle)
        return R

    def rates(self, angles: Sequence[float]) -> Array:
        """Angular velocity [rad/s] per unit speed of each angle, shape (3, 3), one column per angle."""
        R, columns = np.eye(3), []
        for axis, angle in zip(self.axes, angles, strict=True):
            columns.append(R @ axis)
            R = R @ rotation_about(axis, angle)
        return np.column_stack(columns)

    def bias(self, angles: Sequence[float], speeds: Sequence[float]) -> Array:
        """Angular acceleration (3,) [rad/s^2] at constant speeds [rad/s] of the angles."""
        w, bias = np.zeros(3), np.zeros(3)
        for axis, speed in zip(self.rates(angles).T, speeds, strict=True):
            bias = bias + np.cross(w, axis) * speed  # an axis moves with the angles before it
            w = w + axis * speed
        return bias

    def clearance(self, angles: Sequence[float]) -> float:
        """Distance of the axes from gimbal lock, which is at 0; at most 1."""
        return abs(float(np.linalg.det(self.rates(angles))))

    def angles(self, R: Array) -> tuple[float, float, float]:
        """One of the two sets of angles [rad] of a rotation (3, 3)."""
        first, second, third = self.axes
        normal = np.cross(first, second)
        # The second angle carries the first axis into the third at `offset`, where the two sets of axes meet.
        offset = atan2(-float(third @ normal), float(third @ first))
        turned = R @ third
        across = float(np.hypot(turned @ second, turned @ normal))
        a = atan2(float(turned @ second), -float(turned @ normal)) if across > 0.0 else 0.0
        b = atan2(across, float(turned @ first)) - offset
        rest = (rotation_about(first, a) @ rotation_about(second, b)).T @ R
        c = atan2(float(np.cross(second, rest @ second) @ third), float(second @ rest @ second))
        return a, (b + pi) % (2.0 * pi) - pi, c


_ANGLE = TOLERANCES[Quantity.AXES].absolute
"""Maximum deviation [rad] of axes that should be perpendicular."""
_DISTANCE = TOLERANCES[Quantity.POSES].absolute
"""Maximum distance [m] of axes from the centre of a ball joint, and of two centres."""


class NotTheSame(Exception):
    """Two chains are different joints; the message states the difference."""


class Segment(Struct, frozen=True, eq=False):
    """Corresponding steps of two chains."""

    ours: tuple[Step, ...]
    theirs: tuple[Step, ...]
    balls: tuple[BallAngles, BallAngles] | None = None
    """The angles of either side of a ball joint; None for a single joint."""
    R_zero: Array = field(default_factory=lambda: np.eye(3))
    """The zero rotation of the other side relative to this one: it is arbitrary for a ball joint."""


def segments(ours: Chain, theirs: Chain, distance: float = _DISTANCE) -> tuple[Segment, ...]:
    """Pair the steps of two chains, from the parent on.

    Args:
        distance: Maximum distance [m] of two axes, and of two centres: the accuracy of the engines that saw them.

    Raises:
        NotTheSame: They are different joints.
    """
    pieces: list[Segment] = []
    a, b = list(ours.steps), list(theirs.steps)
    while a and b:
        if "ball" in (a[0].kind, b[0].kind):
            segment = _ball(a, b, distance)
        elif a[0].kind == b[0].kind:
            _check_place(a[0], b[0], distance)
            segment = Segment((a[0],), (b[0],))
        else:
            raise NotTheSame(f"'{a[0].names[0]}' and '{b[0].names[0]}' are of different kinds")
        pieces.append(segment)
        a, b = a[len(segment.ours) :], b[len(segment.theirs) :]
    for step in (*a, *b):
        raise NotTheSame(f"'{step.joint.name}' has no counterpart")
    if len(pieces) == 1 and pieces[0].balls is not None:
        (ball,) = pieces
        return (Segment(ball.ours, ball.theirs, ball.balls, ours.X_PC.R @ theirs.X_PC.R.T),)
    return tuple(pieces)


def _check_place(a: Step, b: Step, distance: float) -> None:
    """Check that parallel axes coincide; the angle between others is compared later."""
    (one,), (other,) = a.twists, b.twists
    if a.kind == "slide" or float(np.linalg.norm(np.cross(direction(one), direction(other)))) > _ANGLE:
        return
    apart = float(np.linalg.norm(foot(other) - foot(one)))
    if apart > distance:
        raise NotTheSame(f"the axes of {_listed(list(dict.fromkeys(a.names + b.names)))} are {apart:.3g} m apart")


def _ball(a: Sequence[Step], b: Sequence[Step], distance: float) -> Segment:
    """The ball joint at the beginning of both chains."""
    ours, theirs = _turning_freely(a), _turning_freely(b)
    centres = [common_point(_twists(side))[0] for side in (ours, theirs)]
    apart = float(np.linalg.norm(centres[1] - centres[0]))
    if apart > distance:
        raise NotTheSame(f"the centres are {apart:.3g} m apart")
    return Segment(ours, theirs, (_angles(ours), _angles(theirs)))


def _turning_freely(steps: Sequence[Step]) -> tuple[Step, ...]:
    """The steps that form a ball joint at the beginning of a chain."""
    taken = tuple(steps[: 1 if steps[0].kind == "ball" else 3])
    names = [step.joint.name for step in taken]
    if steps[0].kind != "ball" and [step.kind for step in taken] != ["turn"] * 3:
        raise NotTheSame(f"{_listed(names)} do not rotate as a ball joint does")
    for step in taken:
        limit = step.joint.limit
        if limit is not None and (isfinite(limit.lower) or isfinite(limit.upper)):
            raise NotTheSame(f"the limits of '{step.joint.name}' are not those of a ball joint")
    if len(taken) == 1:
        return taken
    for one, other, slant in zip(names, names[1:], _angles(taken).slant, strict=False):
        if slant > _ANGLE:
            raise NotTheSame(f"the axes of '{one}' and '{other}' are {slant:.3g} rad from perpendicular")
    _, astray = common_point(_twists(taken))
    if astray > _DISTANCE:
        raise NotTheSame(f"the axes of {_listed(names)} miss each other by {astray:.3g} m")
    return taken


def _twists(steps: Sequence[Step]) -> Array:
    return np.vstack([step.twists for step in steps])


def _angles(steps: Sequence[Step]) -> BallAngles:
    axes = _twists(steps)[:, :3]
    return BallAngles(axes / np.linalg.norm(axes, axis=1, keepdims=True))


def _listed(names: Sequence[str]) -> str:
    quoted = [f"'{name}'" for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"
