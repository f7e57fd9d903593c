"""Writes ``benchmarks/RELIABILITY.md``: one row per experiment, replaced when that experiment has run."""

from collections import Counter
from collections.abc import Sequence

from tests.conftest import ROOT

from .experiment import Experiment, Trial

PAGE = ROOT / "benchmarks" / "RELIABILITY.md"

_HEAD = """\
# Reliability: fault injection experiments and their results

`make hostile` runs the experiments below and updates the table: the number of trials, their outcomes, and the number
of trials that found a fault in that run. The number of trials of the long form, which takes hours, is in brackets; a
smaller number means a shorter run. `python -m tests.hostile --only NAME --count N` runs one experiment, `--seed N`
with other random choices; `make test` runs a few trials of most, and `make faults`, a part of `make all`, 2,000 of
`mutants`. `--only mutants --repeat TRIAL --keep DIR` repeats one, whose files stay in DIR. A trial of `mutants` takes
0.2 s of processor time, so that `make faults FAULTS=20000` takes less than an hour on two idle cores.
A fault is any forbidden outcome: a traceback, an
internal error (SB901), a hang, an exit code other than 0, 1 and 2, a diagnostic without place or remedy, a file that
is neither old nor new, a leftover process or temporary file, different bytes.

| experiment | injected faults | required outcome | trials (long form) | outcomes | faults |
| --- | --- | --- | --: | --- | --: |
"""
_REPAIRED = """
## Faults that the experiments found

Each is fixed, and has a regression test of its own.

"""


def summary(trials: Sequence[Trial]) -> str:
    """Number of trials per outcome."""
    outcomes = Counter(trial.outcome for trial in trials)
    return ", ".join(f"{count:,} {outcome}" for outcome, count in sorted(outcomes.items()))


def write_row(experiment: Experiment, trials: Sequence[Trial], known: Sequence[Experiment]) -> None:
    """Replace the row of an experiment in the page; other rows are unchanged.

    Args:
        experiment: The experiment that has run.
        trials: Its trials.
        known: All experiments, in the order of the page.
    """
    faults = sum(bool(trial.faults) for trial in trials)
    cells = (
        f"`{experiment.name}`",
        experiment.title,
        experiment.expected,
        f"{len(trials):,} ({experiment.long:,})",
        summary(trials),
        str(faults),
    )
    rows = {**_rows(), experiment.name: f"| {' | '.join(cells)} |\n"}
    table = "".join(rows[one.name] for one in known if one.name in rows)
    repaired = "".join(f"- `{one.name}`: {fault}\n" for one in known for fault in one.repaired)
    PAGE.write_text(_HEAD + table + _REPAIRED + repaired, encoding="utf-8", newline="\n")


def _rows() -> dict[str, str]:
    """The rows of the page, by experiment."""
    if not PAGE.exists():
        return {}
    lines = PAGE.read_text(encoding="utf-8").splitlines(keepends=True)
    return {line.split("`")[1]: line for line in lines if line.startswith("| `")}
