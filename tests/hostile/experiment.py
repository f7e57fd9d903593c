"""What an experiment is: one way to harm stepbot, done many times, each time with a verdict."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Trial:
    """One try."""

    name: str
    """From which, and the seed, the same trial is made again."""
    outcome: str
    """What came of it, in the words of the page's table."""
    faults: tuple[str, ...] = ()
    """What must not be; empty where all is well."""


@dataclass(frozen=True)
class Setting:
    """What a run of an experiment is given."""

    folder: Path
    """An empty folder to work in."""
    seed: int
    """Of all random choices."""
    count: int
    """How many trials; experiments whose cases are listed try that many of them."""
    jobs: int = 1
    """How many processes to keep busy."""


@dataclass(frozen=True)
class Experiment:
    """One way to harm stepbot."""

    name: str
    """For ``--only``."""
    title: str
    """For the page: what is done to stepbot."""
    expected: str
    """For the page: what must come of it."""
    run: Callable[[Setting], Iterator[Trial]]
    """Tries; yields each trial as it ends."""
    short: int
    """Trials of the short form."""
    long: int
    """Trials of the long form."""
    repaired: tuple[str, ...] = ()
    """Faults that the experiment found; each is repaired."""
