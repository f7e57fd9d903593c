"""An experiment: one kind of hostile input or event, tried many times, each with a verdict."""

from collections.abc import Callable, Iterator
from pathlib import Path

from msgspec import Struct


class Trial(Struct, frozen=True):
    """One trial."""

    name: str
    """Its name, from which, with the seed, the trial is repeated."""
    outcome: str
    """The outcome, as in the page's table."""
    faults: tuple[str, ...] = ()
    """The defect found; empty if there is none."""


class Setting(Struct, frozen=True):
    """Settings of a run of an experiment."""

    folder: Path
    """An empty folder to work in."""
    seed: int
    """Seed of all random choices."""
    count: int
    """Number of trials; experiments with a list of cases try that many of them."""
    jobs: int = 1
    """Number of processes to keep busy."""
    names: tuple[str, ...] = ()
    """Trials to repeat, instead of those of the seed; for experiments whose trials have no list."""


class Experiment(Struct, frozen=True):
    """One kind of hostile input or event."""

    name: str
    """Name for ``--only``."""
    title: str
    """For the page: the input or event."""
    expected: str
    """For the page: the required outcome."""
    run: Callable[[Setting], Iterator[Trial]]
    """Run the trials; yields each as it ends."""
    short: int
    """Number of trials of the short form."""
    long: int
    """Number of trials of the long form."""
    repaired: tuple[str, ...] = ()
    """Defects that the experiment found; each is fixed."""
