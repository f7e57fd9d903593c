"""B-splines as arrays: many points of a curve or a surface at once, with first derivatives.

Reading one point with its derivatives through the Python binding costs three microseconds; here it is a fraction of
one. After L. Piegl and W. Tiller, *The NURBS Book*, algorithms A2.1 to A2.3.
"""

from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.fixed_point import distinct
from stepbot.geometry.spatial import Array

Indices = NDArray[np.int64]


class Basis(Struct, frozen=True, eq=False, dict=True):
    """The B-spline basis functions of one parameter."""

    degree: int
    knots: Array
    """Shape (n + degree + 1,), nondecreasing."""
    period: float
    """0 where the spline is not periodic."""

    @cached_property
    def distinct(self) -> Array:
        """Knots of the domain, each once."""
        return distinct(self.knots[self.degree : len(self.knots) - self.degree])

    def breaks(self, rational: bool) -> Array:
        """Parameters between which a spline is smooth, and near to a polynomial; of a periodic one over three periods.

        A rational function is nearer to one on half a span.
        """
        values = self.distinct
        if rational:
            values = np.sort(np.concatenate([values, 0.5 * (values[1:] + values[:-1])]))
        if self.period:
            values = distinct(np.concatenate([values + k * self.period for k in (-1, 0, 1)]))
        return values

    def at(self, t: Array) -> tuple[Indices, Array, Array]:
        """Evaluate the functions that are not zero at each parameter; beyond the domain the last polynomial goes on.

        Args:
            t: Shape (m,).

        Returns:
            Number of the first such function (m,), values (m, degree + 1), derivatives (m, degree + 1).
        """
        degree, knots, distinct = self.degree, self.knots, self.distinct
        if self.period:
            t = distinct[0] + np.mod(t - distinct[0], self.period)
        interval = np.clip(np.searchsorted(distinct, t, side="right") - 1, 0, len(distinct) - 2)
        span = self._spans[interval]
        near = knots[span[:, None] + np.arange(1 - degree, degree + 1)]
        t = t[:, None]
        values, lower = np.ones((len(t), 1)), np.zeros((len(t), 0))
        for p in range(1, degree + 1):
            below, above = near[:, degree - p : degree], near[:, degree : degree + p]
            lower = values / (above - below)
            values = np.zeros((len(t), p + 1))
            values[:, :-1] = (above - t) * lower
            values[:, 1:] += (t - below) * lower
        derivatives = np.zeros_like(values)
        derivatives[:, :-1] = -degree * lower
        derivatives[:, 1:] += degree * lower
        return span - degree, values, derivatives

    @cached_property
    def _spans(self) -> Indices:
        """For each interval of distinct knots the last place of its lower one."""
        return np.searchsorted(self.knots, self.distinct, side="right") - 1


def is_rational(poles: Array) -> bool:
    """Whether homogeneous poles have weights that are not one."""
    return bool((poles[..., -1] != 1.0).any())


def curve_at(basis: Basis, poles: Array, t: Array) -> tuple[Array, Array]:
    """Points and derivatives, each (m, d), of a B-spline curve at parameters (m,).

    Args:
        poles: Shape (n, d + 1), homogeneous: the last column is the weight.
    """
    first, values, derivatives = basis.at(t)
    value, derivative = _sums(poles, first, values), _sums(poles, first, derivatives)
    weight = value[..., -1:]
    point = value[..., :-1] / weight
    return point, (derivative[..., :-1] - point * derivative[..., -1:]) / weight


class SplineSurface(Struct, frozen=True, eq=False):
    """A B-spline surface."""

    u: Basis
    v: Basis
    poles: Array
    """Shape (n, m, 4), homogeneous."""

    @property
    def breaks(self) -> tuple[Array, Array]:
        """See :meth:`Basis.breaks`, of u and v."""
        rational = is_rational(self.poles)
        return self.u.breaks(rational), self.v.breaks(rational)

    def sections(self, u: Array) -> tuple[Array, Array]:
        """Poles of the curves along v at parameters (k,), and their derivatives by u.

        Both have shape (3, m, k); homogeneous poles of a rational surface have shape (4, m, k).
        """
        poles = self.poles if is_rational(self.poles) else self.poles[..., :3]
        first, values, derivatives = self.u.at(u)
        both = _sums(poles, first, values), _sums(poles, first, derivatives)
        return np.ascontiguousarray(both[0].T), np.ascontiguousarray(both[1].T)

    def at(self, sections: tuple[Array, Array], rows: Indices, v: Array) -> tuple[Array, ...]:
        """Points and derivatives by u and v, each (3, n, m), of the numbered sections (m,).

        Args:
            sections: As of :meth:`sections`.
            rows: Shape (m,).
            v: Shape (n, m), or (n, 1) for the same parameters on all; those of a section are between the same knots.
        """
        first, values, derivatives = self.v.at(v.reshape(-1))
        first = first.reshape(v.shape)[0]
        weights, slopes = (each.T.reshape(-1, *v.shape) for each in (values, derivatives))
        point, by_u, by_v = 0.0, 0.0, 0.0
        for k, (weight, slope) in enumerate(zip(weights, slopes, strict=True)):
            pole, turn = (section[:, first + k, rows][:, None] for section in sections)
            point, by_u, by_v = point + weight * pole, by_u + weight * turn, by_v + slope * pole
        return _divided(np.asarray(point), np.asarray(by_u), np.asarray(by_v))


def _divided(value: Array, *derivatives: Array) -> tuple[Array, ...]:
    """Points and derivatives (3, ...) from homogeneous ones (4, ...); points without weights unchanged."""
    if len(value) == 3:
        return value, *derivatives
    point = value[:3] / value[3]
    return point, *((derivative[:3] - point * derivative[3]) / value[3] for derivative in derivatives)


def _sums(poles: Array, first: Indices, weights: Array) -> Array:
    """Sums (m, ...) of consecutive poles (n, ...), from ``first`` (m,) on, by weights (m, degree + 1)."""
    total = np.zeros((len(first), *poles.shape[1:]))
    for k in range(weights.shape[1]):
        total += weights[:, k].reshape(-1, *(1,) * (poles.ndim - 1)) * poles[first + k]
    return total
