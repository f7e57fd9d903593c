"""What a drive test measures."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

from msgspec import Struct

from stepbot.engines.simulation import Cube

_POINTS = 80
Series = tuple[tuple[float, ...], tuple[float, ...]]
"""Horizontal and vertical values of a curve."""


class Measure(Struct, frozen=True):
    """One number of a test, in the unit of its name in :data:`stepbot.driving.limits.UNITS`."""

    quantity: str
    value: float
    where: str = ""
    """The joint, closure or pose at which it is largest."""


class Loss(StrEnum):
    """How a gripper lost its cube."""

    PUSHED = "pushed out"
    """Before it had its weight."""
    FREE = "not held"
    """It fell freely as it got its weight."""
    SLIPPED = "slipped out"


class Grip(Struct, frozen=True):
    """What became of the cube, or of the object in its place, in one gripper."""

    joint: str
    """The joint of its first motor."""
    links: frozenset[str]
    cube: Cube
    gaps: tuple[float, float]
    """Narrowest and widest gap [m] without the cube."""
    slip: float
    """Largest way [mm] of the cube; up to its loss."""
    effort: float | None
    """Effort of the first motor on the cube without weight, relative to its limit; None without a limit."""
    loss: Loss | None = None
    seconds: float = 0.0
    """Time [s] from its weight to its loss."""


class Spin(Struct, frozen=True):
    """What the wheel did that turned least, of the way that was asked for."""

    joint: str
    share: float
    """Angle, relative to the one asked for."""
    kv: float
    """Gain of its motor in the file."""
    effort: float | None
    """Largest effort of its motor, relative to its limit; None without a limit."""
    standing: tuple[str, ...] = ()
    """Links that touched the floor while the wheels turned, other than wheels and their rollers."""
    dragged: tuple[str, ...] = ()
    """Those of them that roll, but were moved along their axles."""


class Plot(Struct, frozen=True):
    """The curves of a test."""

    x: str
    """Label of the horizontal axis, with its unit."""
    y: str
    curves: Mapping[str, Series]


class Result(Struct, frozen=True):
    """The outcome of one test in one engine."""

    test: str
    measures: tuple[Measure, ...]
    plot: Plot
    grips: tuple[Grip, ...] = ()
    """Of the grip test."""
    spin: Spin | None = None
    """Of the tests of a wheeled base."""
    steps: int = 0
    seconds: float = 0.0
    """Time [s] of the engine's steps by the clock: never in a file."""

    @property
    def steps_per_second(self) -> float:
        """Simulated steps per second of the engine's own time."""
        return self.steps / self.seconds if self.seconds > 0.0 else 0.0


def thinned(times: Sequence[float], values: Sequence[float]) -> Series:
    """About :data:`_POINTS` points of a curve, evenly spaced, the last one included."""
    stride = max(1, len(times) // _POINTS)
    chosen = [*range(0, len(times), stride)]
    if times and chosen[-1] != len(times) - 1:
        chosen.append(len(times) - 1)
    return tuple(times[i] for i in chosen), tuple(values[i] for i in chosen)


def largest(quantity: str, values: Mapping[str, float]) -> tuple[Measure, ...]:
    """The largest of the values by place as a measure; none without values."""
    if not values:
        return ()
    where = max(values, key=lambda name: values[name])
    return (Measure(quantity, values[where], where),)
