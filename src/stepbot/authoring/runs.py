"""Runs of elements, one after the other in one array."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]

_CHUNK = 1_000_000
"""Number of elements that are looked at at once."""


def starts_of(counts: Sequence[int] | Indices) -> Indices:
    """Where each of several runs begins."""
    sizes = np.asarray(counts, dtype=np.int64)
    return np.cumsum(sizes) - sizes


def expanded(counts: Indices) -> tuple[Indices, Indices]:
    """For runs of some lengths, the number of the run and the place in it of each element."""
    runs = np.repeat(np.arange(len(counts)), counts)
    return runs, np.arange(len(runs)) - starts_of(counts)[runs]


def chunks(counts: Indices) -> Iterator[Indices]:
    """Numbers of runs of some lengths, as many at once as memory should hold."""
    yield from np.split(np.arange(len(counts)), np.flatnonzero(np.diff(np.cumsum(counts) // _CHUNK)) + 1)
