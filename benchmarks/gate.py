"""Compares the working tree with an earlier revision by processor time, and fails if it needs more than 5 % more.

Both run the same jobs in turn, in changing order, on the same packages: conversions of ten files, and of one of them
what the cache shortens, what verifies and what compares its files. Each round gives one ratio of processor times,
so that a machine that becomes slower concerns both. The median of the ratios is bounded by order statistics, which
assume no distribution: rounds are added until both bounds are on one side of the limit, or none are left.
"""

import compileall
import os
import random
import subprocess
from collections.abc import Callable, Sequence
from enum import Enum
from math import comb
from pathlib import Path
from statistics import median

from msgspec import Struct

from .contenders import ROOT, STEPBOT, Case
from .timing import timed

LIMIT = 1.05
"""Ratio of processor times above which the gate fails."""
CONFIDENCE = 0.95
"""One-sided confidence of each bound of the median."""
ROUNDS = (7, 14, 21)
"""Numbers of rounds after which the bounds are compared with the limit; after the last one the median decides."""
_CONTENT = ("src", "cli", "docs", "robot_library", "schemas")
"""What a wheel has, too: each diagnostic is read from the documentation."""


class Verdict(Enum):
    """What a number of rounds shows."""

    PASSED = "passed"
    FAILED = "FAILED"
    OPEN = "open"


class Source(Struct, frozen=True):
    """A stepbot to run."""

    name: str
    root: Path
    """Contains ``src`` and ``cli``."""

    def environment(self, case: Case) -> dict[str, str]:
        """Variables with which the command of this environment runs this source."""
        return {**case.environment, "PYTHONPATH": os.pathsep.join([str(self.root / "src"), str(self.root / "cli")])}


class Job(Struct, frozen=True):
    """One command to compare."""

    name: str
    command: tuple[str, ...]
    prepare: tuple[tuple[str, ...], ...] = ()
    """Commands that run once before."""
    edited: bool = False
    """Whether the sidecar changes before each run."""


def jobs(sidecar: str, *, only_cold: bool) -> tuple[Job, ...]:
    """The jobs of the gate for a sidecar."""
    convert = ("convert", sidecar, "-o", "out", "--no-verify")
    cold = Job("convert, cold", (*convert, "--no-cache"))
    if only_cold:
        return (cold,)
    return (
        Job("--help", ("--help",)),
        Job("check, unchanged", ("check", sidecar), (("check", sidecar),)),
        Job("convert, sidecar edited", convert, (convert,), edited=True),
        Job("convert, edited, verified", convert[:-1], (convert[:-1],), edited=True),
        Job("diff", ("diff", "out", "out"), (convert,)),
        cold,
    )


def last_tag() -> str | None:
    """The last tag before the current revision; None without one."""
    run = subprocess.run(
        ["git", "describe", "--tags", "--abbrev=0"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return run.stdout.strip() or None if run.returncode == 0 else None


def source_of(revision: str, folder: Path) -> Source:
    """stepbot at a revision, compiled like an installed one."""
    root = folder / "source"
    root.mkdir(parents=True)
    archive = subprocess.run(["git", "archive", revision, *_CONTENT], cwd=ROOT, check=True, capture_output=True)
    subprocess.run(["tar", "-x"], cwd=root, input=archive.stdout, check=True)
    compileall.compile_dir(root, quiet=1)
    return Source(revision, root)


def ratios(job: Job, ours: Source, theirs: Source, cases: tuple[Case, Case]) -> Callable[[int], float]:
    """A function that runs a round, by its number, and returns our processor time divided by theirs."""
    sides = list(zip((ours, theirs), cases, strict=True))
    for source, case in sides:
        for arguments in (*job.prepare, job.command):  # the last one for bytecode and files in memory
            timed([*STEPBOT, *arguments], case.folder, source.environment(case))

    def run(number: int) -> float:
        costs = {}
        for source, case in sides if number % 2 else reversed(sides):
            if job.edited:
                case.edit()
            costs[source] = timed([*STEPBOT, *job.command], case.folder, source.environment(case)).cpu
        return costs[ours] / costs[theirs]

    return run


def bounds(values: Sequence[float]) -> tuple[float, float]:
    """Bounds of the median, each with :data:`CONFIDENCE`; infinite where there are too few values.

    The k-th smallest of n values is above the median with the probability that fewer than k of n coins show heads: the
    sign test.
    """
    ordered, n = sorted(values), len(values)
    below, rank = 0.0, 0
    while rank < n and (below := below + comb(n, rank) / 2**n) <= 1.0 - CONFIDENCE:
        rank += 1
    return (ordered[rank - 1], ordered[n - rank]) if rank else (-float("inf"), float("inf"))


def verdict(values: Sequence[float]) -> Verdict:
    """What the ratios of some rounds show."""
    lower, upper = bounds(values)
    if lower > LIMIT:
        return Verdict.FAILED
    if upper <= LIMIT:
        return Verdict.PASSED
    if len(values) < ROUNDS[-1]:
        return Verdict.OPEN
    return Verdict.FAILED if median(values) > LIMIT else Verdict.PASSED


def decided(run: Callable[[int], float]) -> tuple[Verdict, list[float]]:
    """Run rounds until they decide."""
    values: list[float] = []
    for count in ROUNDS:
        values += [run(number) for number in range(len(values), count)]
        if (result := verdict(values)) is not Verdict.OPEN:
            return result, values
    raise AssertionError("the last number of rounds decides")


def line(job: str, result: Verdict, values: Sequence[float]) -> str:
    """The result of a job in words."""
    lower, upper = bounds(values)
    return (
        f"{job:36} {result.value:7} {median(values):.3f} of the processor time, between {lower:.3f} and {upper:.3f}"
        f" ({len(values)} rounds, limit {LIMIT:.2f})"
    )


def alarm_rates(values: Sequence[float], factors: Sequence[float], trials: int = 4000) -> dict[float, float]:
    """How often the gate would fail if each ratio were larger by a factor: drawn again from ratios of A against A.

    Args:
        values: Ratios of one revision to itself.
        factors: Factors of the processor time; 1.0 gives the rate of false alarms.
        trials: Number of simulated gates for each factor.
    """
    draw = random.Random(0)
    return {
        factor: sum(decided(lambda _: factor * draw.choice(values))[0] is Verdict.FAILED for _ in range(trials))  # noqa: B023
        / trials
        for factor in factors
    }
