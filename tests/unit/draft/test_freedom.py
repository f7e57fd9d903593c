"""Degrees of freedom that contacts leave, against those of the classical joints."""

import numpy as np
import pytest

from stepbot.draft.contacts.contacts import Fit, FitKind, Patch, Socket
from stepbot.draft.contacts.freedom import FreedomKind, freedom
from stepbot.draft.parts.axis import Axis
from stepbot.geometry.spatial import Array

X, Y, Z = np.eye(3)


def shaft(point: Array, direction: Array) -> Fit:
    """A shaft of r 4 mm, 20 mm in its bore."""
    return Fit(0, 1, FitKind.SHAFT, Axis(point, direction), 4e-3, 4e-3, 0.02, 0)


def face(point: Array, normal: Array) -> Patch:
    """A square of 10 mm."""
    return Patch(0, 1, point, normal, 1e-4, point[None, :], (), -normal, 0.0)


def ball(point: Array) -> Socket:
    """A ball of r 5 mm."""
    return Socket(0, 1, point, 5e-3)


AT = np.array([0.1, -0.2, 0.3])
CASES = [
    ("cylindrical", [shaft(AT, Z)], [], []),
    ("revolute", [shaft(AT, Z)], [face(AT, Z)], []),
    ("prismatic", [shaft(AT, Z), shaft(AT + 0.03 * X, Z)], [], []),
    ("prismatic", [], [face(AT, X), face(AT, Y)], []),
    ("planar", [], [face(AT, Z)], []),
    ("ball", [], [], [ball(AT)]),
    ("revolute", [], [], [ball(AT), ball(AT + 0.05 * Z)]),
    ("rigid", [shaft(AT, Z), shaft(AT + 0.03 * X, Z)], [face(AT, Z)], []),
    ("loose", [], [], []),
]


@pytest.mark.parametrize(("kind", "fits", "patches", "sockets"), CASES)
def test_freedom_of_classical_joints(kind: str, fits: list[Fit], patches: list[Patch], sockets: list[Socket]) -> None:
    """A pin, a pin with a shoulder, two rods, a groove, a table, a ball, two balls, and a lock."""
    found = freedom(fits, patches, sockets, AT, 0.03)
    assert found.kind == kind


def test_axis_of_a_hinge_of_two_balls_runs_through_both() -> None:
    """The axis of two balls is the line through their centres."""
    found = freedom([], [], [ball(AT), ball(AT + 0.05 * Z)], AT + 0.01 * Z, 0.05)
    assert found.kind == FreedomKind.REVOLUTE
    assert found.point is not None
    assert found.direction is not None
    axis = Axis(found.point, found.direction)
    assert axis.is_along(Z, 1e-9)
    assert axis.distance(AT) < 1e-12


def test_a_ball_turns_about_its_centre_wherever_it_is_compared() -> None:
    """Not about the point near the contacts to which lengths are relative."""
    found = freedom([], [], [ball(AT)], AT + 0.02 * X - 0.01 * Y, 0.05)
    assert found.kind == FreedomKind.BALL
    assert found.point is not None
    assert np.allclose(found.point, AT, atol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 60])
@pytest.mark.parametrize(("angle", "kind"), [(1.2e-3, "cylindrical"), (2.5e-3, "rigid")])
def test_tilted_shafts_lock_whatever_their_number(count: int, angle: float, kind: str) -> None:
    """Two shafts on one line, tilted to both sides, lock from 2 mrad / sqrt(2), and many pairs as one does."""
    shafts = [shaft(AT, np.array([np.sin(sign * angle), 0.0, np.cos(angle)])) for sign in (-1, 1) for _ in range(count)]
    assert freedom(shafts, [], [], AT, 0.03).kind == kind


def test_what_touches_nothing_is_free() -> None:
    """A body without contacts has the six freedoms of a body."""
    found = freedom([], [], [], AT, 0.03)
    assert (found.kind, found.dof) == (FreedomKind.LOOSE, 6)
