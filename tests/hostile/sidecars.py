"""Sidecars with damaged trees give a robot, or errors with place and remedy; nothing raises or hangs."""

from collections.abc import Iterator

from tests.fuzz.mutants import try_all

from .experiment import Experiment, Setting, Trial
from .sidecar_mutant import LIBRARY, SMALL, collect, plan


def run(setting: Setting) -> Iterator[Trial]:
    """Damage, check, and build a fourth of those without errors."""
    few = setting.count <= 2000
    names = SMALL if few else sorted(path.parent.name for path in LIBRARY.glob("*/*.robot.yaml"))
    bases = setting.folder / "bases"
    collect(names, bases)
    mutants = plan(names, setting.count, setting.seed)
    for trial in try_all(mutants, bases, jobs=setting.jobs, runner="tests.hostile.sidecar_runner"):
        yield Trial(trial.mutant.name, trial.verdict.outcome, trial.verdict.faults)


EXPERIMENT = Experiment(
    "sidecars",
    "damaged sidecars: keys dropped, doubled, renamed; types, units, references swapped; numbers, nesting, aliases",
    "a robot, or errors with place, code and remedy",
    run,
    short=90,
    long=20_000,
    repaired=(
        "numbers beyond 3.4e38 became infinite in OpenUSD, which stores single precision (SB125, SB414)",
        "a collision shape at 1e300 m raised an exception (SB125)",
        "computed gains of a joint between equal limits raised an exception",
        "`collision: {merge: ...}` in `defaults`, and lists there, printed a message of pydantic's",
    ),
)
