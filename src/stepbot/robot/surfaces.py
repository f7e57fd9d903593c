"""Contact properties of collision shapes."""

from math import acos, cos, exp, pi, sqrt, tan

from msgspec import Struct

DEAD = exp(-2.0)
"""Restitution of a critically damped contact, the least that a spring and a damper below have."""

_LEAST = 1e-6
"""Damping ratio of an impact that loses nothing: with 0, contacts would have no time constant."""


class Surface(Struct, frozen=True):
    """How a shape behaves against what it touches; None leaves a property to the simulator."""

    friction: float | None = None
    """Coefficient of sliding friction, of the shape and what it touches."""
    torsional: float | None = None
    """Torque against spinning / normal force [m]."""
    rolling: float | None = None
    """Torque against rolling / normal force [m]."""
    restitution: float | None = None
    """Speed after an impact / speed before it."""
    softness: float | None = None
    """Time constant [s] with which a contact pushes shapes apart."""

    @property
    def is_stated(self) -> bool:
        """Whether any property is given."""
        return self != PLAIN


PLAIN = Surface()
SURFACE_FIELDS = Surface.__struct_fields__


def damping_ratio(restitution: float) -> float:
    """The damping ratio of a spring and damper that only push, whose impact has a restitution of at least :data:`DEAD`.

    The shapes part when the force is zero: e = exp(-2 phi / tan(phi)) with the damping ratio cos(phi). Schwager and
    Poeschel, "Coefficient of restitution and linear-dashpot model revisited", Granular Matter 9 (2007) 465.
    """
    low, high = 0.0, pi / 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if exp(-2.0 * middle / tan(middle)) < restitution else (low, middle)
    return max(cos(high), _LEAST)


def restitution_of(ratio: float) -> float:
    """The restitution of an impact with a damping ratio below 1."""
    return exp(-2.0 * ratio * acos(ratio) / sqrt(1.0 - ratio * ratio))
