"""Runs fault injection experiments against stepbot, and reports forbidden outcomes.

python -m tests.hostile                         all experiments in their long form, hours
python -m tests.hostile --short                 a few trials of each, a minute
python -m tests.hostile --only NAME [--count N] [--seed N]
python -m tests.hostile --only mutants --repeat TRIAL --keep DIR        one trial, whose files stay in DIR
python -m tests.hostile --page                  all, and writes the results to benchmarks/RELIABILITY.md
"""

import argparse
import importlib
import math
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from stepbot.runtime.cache.sources import own_code

from . import page
from .experiment import Experiment, Setting, Trial

NAMES = ("mutants", "sidecars", "steps", "names", "kills", "caches", "disks", "concurrent", "descriptions", "trees")
"""Modules, each with an ``EXPERIMENT``."""
_REPORT_EVERY = 500


def experiment(name: str) -> Experiment:
    """The experiment of a name."""
    found = importlib.import_module(f"{__package__}.{name}").EXPERIMENT
    assert isinstance(found, Experiment)
    return found


def trials_of(chosen: Experiment, count: int, arguments: argparse.Namespace) -> list[Trial]:
    """Run an experiment until it ends or the time is up; defects are printed as they are found."""
    trials: list[Trial] = []
    minutes = arguments.minutes
    end = time.monotonic() + 60.0 * minutes
    with tempfile.TemporaryDirectory(prefix=f"hostile-{chosen.name}-") as folder:
        place = Path(arguments.keep or folder).resolve()
        running = chosen.run(Setting(place, arguments.seed, count, arguments.jobs, tuple(arguments.repeat)))
        for trial in running:
            trials.append(trial)
            if time.monotonic() > end:
                _say(f"{chosen.name}: stopped after {minutes:g} minutes")
                break
            if trial.faults:
                _say(f"FAULT {chosen.name} {trial.name}\n" + "\n".join(trial.faults))
            if len(trials) % _REPORT_EVERY == 0:
                _say(f"{chosen.name}: {len(trials)} of {count}")
    return trials


def _code() -> str:
    """Hash of stepbot's current code: trials compare bytes with those of the first run of an experiment."""
    own_code.cache_clear()
    return own_code()


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="a few trials of each")
    parser.add_argument("--only", action="append", choices=NAMES, help="this experiment; may be repeated")
    parser.add_argument("--count", type=int, help="how many trials of each")
    parser.add_argument("--seed", type=int, default=1, help="of the random choices (1)")
    parser.add_argument("--jobs", type=int, default=2, help="how many processes at once (2)")
    parser.add_argument("--minutes", type=float, default=math.inf, help="stop each experiment after so many")
    parser.add_argument("--repeat", nargs="+", default=[], metavar="TRIAL", help="mutants to repeat")
    parser.add_argument("--keep", metavar="DIR", help="work in this folder, which stays")
    parser.add_argument("--page", action="store_true", help="write the results to benchmarks/RELIABILITY.md")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    """Run experiments; returns 1 if any finds a defect, 2 if the code has changed meanwhile."""
    arguments = _arguments(argv)
    faults = 0
    for name in arguments.only or NAMES:
        chosen = experiment(name)
        count = arguments.count or (chosen.short if arguments.short else chosen.long)
        before = _code()
        trials = trials_of(chosen, count, arguments)
        if _code() != before:
            _say(f"{name}: stepbot's code has changed during the run, so what it found does not count")
            return 2
        found = sum(bool(trial.faults) for trial in trials)
        faults += found
        _say(f"{name}: {len(trials):,} trials: {page.summary(trials)}; {found} found a fault")
        if arguments.page:
            page.write_row(chosen, trials, [experiment(one) for one in NAMES])
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
