"""Where curves cross the lines at which a surface is not smooth, by closed forms of a circle and a line."""

import numpy as np
import pytest

from stepbot.geometry.spatial import Array
from stepbot.step.quadrature.contours import _divided
from stepbot.step.quadrature.curves import Curve

U = np.array([-2.0, -0.5, 0.1, 0.6, 2.0])
V = np.array([-2.0, 0.3, 2.0])


def circle(start: float) -> Curve:
    """The unit circle, once around from an angle."""

    def at(t: Array) -> tuple[Array, Array]:
        points = np.column_stack([np.cos(t), np.sin(t)])
        return points, np.column_stack([-np.sin(t), np.cos(t)])

    return Curve(at, start + 0.5 * np.pi * np.arange(5), False, start, start + 2.0 * np.pi)


@pytest.mark.parametrize("start", [0.0, 0.7, 1.9, 3.0, 5.5])
def test_a_circle_is_divided_where_it_crosses_breaks(start: float) -> None:
    """At u = cos t and at v = sin t, twice each; the first and last break bound the surface and divide nothing."""
    found = _divided(circle(start), (U, V))
    across = [sign * np.arccos(u) for u in U[1:-1] for sign in (-1, 1)]
    across += [np.arcsin(V[1]), np.pi - np.arcsin(V[1])]
    wanted = start + np.mod(np.array(across) - start, 2.0 * np.pi)
    assert np.allclose(np.min(np.abs(found[:, None] - wanted[None]), axis=0), 0.0, atol=1e-8)
    assert len(found) == 5 + 8
    assert (found[0], found[-1]) == (start, start + 2.0 * np.pi)


def test_a_line_is_divided_where_it_crosses_breaks() -> None:
    """From (0.9, -1) to (-0.9, 1)."""

    def at(t: Array) -> tuple[Array, Array]:
        return np.column_stack([0.9 - 1.8 * t, -1.0 + 2.0 * t]), np.tile([-1.8, 2.0], (len(t), 1))

    found = _divided(Curve(at, np.empty(0), True, 0.0, 1.0), (U, V))
    assert found == pytest.approx([0.0, 0.3 / 1.8, 0.8 / 1.8, 0.65, 1.4 / 1.8, 1.0], abs=1e-12)
