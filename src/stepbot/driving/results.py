"""What a drive test measures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Series = tuple[tuple[float, ...], tuple[float, ...]]
"""Horizontal and vertical values of a curve."""


@dataclass(frozen=True)
class Measure:
    """One number of a test, in the unit of its name in :data:`stepbot.driving.limits.UNITS`."""

    quantity: str
    value: float
    where: str = ""
    """The joint, closure or pose at which it is largest."""


@dataclass(frozen=True)
class Plot:
    """The curves of a test."""

    x: str
    """Label of the horizontal axis, with its unit."""
    y: str
    curves: Mapping[str, Series]


@dataclass(frozen=True)
class Result:
    """The outcome of one test in one engine."""

    test: str
    measures: tuple[Measure, ...]
    plot: Plot
    steps: int = 0
    seconds: float = 0.0
    """Time [s] of the engine's steps by the clock: never in a file."""

    @property
    def steps_per_second(self) -> float:
        """Simulated steps per second of the engine's own time."""
        return self.steps / self.seconds if self.seconds > 0.0 else 0.0


def thinned(times: Sequence[float], values: Sequence[float], count: int = 80) -> Series:
    """About ``count`` points of a curve, evenly spaced, the last one included."""
    stride = max(1, len(times) // count)
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
