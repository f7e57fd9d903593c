"""Sums that are the same on every Python: the built-in ``sum`` compensates for rounding from 3.12 on, not before."""

from collections.abc import Iterable
from math import fsum


def exact_sum(values: Iterable[float]) -> float:
    """The exact sum of numbers, rounded once; infinite or NaN if adding them one by one is."""
    numbers = list(values)
    try:
        return fsum(numbers)
    except (OverflowError, ValueError):  # overflow, or infinities of both signs
        result = 0.0
        for number in numbers:
            result += number
        return result
