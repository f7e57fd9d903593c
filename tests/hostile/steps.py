"""STEP files that are damaged as bytes, text and graph: the mutants of :mod:`tests.fuzz`."""

import subprocess
import sys
from collections.abc import Iterator

from tests.conftest import ROOT
from tests.fuzz import bases as base_files
from tests.fuzz.mutant import plan
from tests.fuzz.mutants import try_all

from .experiment import Experiment, Setting, Trial


def run(setting: Setting) -> Iterator[Trial]:
    """Read each mutant in a separate process, and convert it to a robot of one link."""
    bases = setting.folder / "bases"
    subprocess.run([sys.executable, "-m", "tests.fuzz.bases", str(bases)], cwd=ROOT, check=True)
    mutants = plan(base_files.names(bases), setting.count, setting.seed)
    for trial in try_all(mutants, bases, jobs=setting.jobs):
        yield Trial(trial.mutant.name, trial.verdict.outcome, trial.verdict.faults)


EXPERIMENT = Experiment(
    "steps",
    "damaged STEP files: cut off, bytes flipped, numbers, entities, references, keywords, strings, header",
    "a robot, or errors with place, code and remedy; the kernel may die, stepbot may not",
    run,
    short=4,
    long=5_000,
)
