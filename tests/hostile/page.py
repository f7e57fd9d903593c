"""Writes ``docs/reliability.md``: one row per experiment, made anew when that experiment has run."""

from collections import Counter
from collections.abc import Sequence

from tests.conftest import ROOT

from .experiment import Experiment, Trial

PAGE = ROOT / "docs" / "reliability.md"

_HEAD = """\
# Reliability: what was done to stepbot, and what came of it

`make hostile` harms stepbot in the ways below, as often as the table says, and writes the table: trials, how
they ended, and how many of them found a fault in that run. In brackets is the number of trials of the long form, which
takes hours; where fewer are shown, the row is of a shorter run. `python -m tests.hostile --only NAME --count N` runs
one experiment, `--seed N` with other random choices; a few trials of each run in every `make test`. A fault is whatever
must not come of it: a traceback, an internal error (SB901), a hang, an exit code other than 0, 1 and 2, a diagnostic
without place or remedy, a file that is neither old nor new, a process or temporary file that is left over, bytes that
differ.

| experiment | what is done | what must come of it | trials (long form) | outcomes | faults |
| --- | --- | --- | --: | --- | --: |
"""
_REPAIRED = """
## Faults that the experiments found

Each is repaired, and held by a test of its own beside the experiment.

"""


def summary(trials: Sequence[Trial]) -> str:
    """How many trials ended how."""
    outcomes = Counter(trial.outcome for trial in trials)
    return ", ".join(f"{count:,} {outcome}" for outcome, count in sorted(outcomes.items()))


def write_row(experiment: Experiment, trials: Sequence[Trial], known: Sequence[Experiment]) -> None:
    """Replace the row of an experiment in the page; rows of others stay as they are.

    Args:
        experiment: What has run.
        trials: What came of it.
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
    """The rows that the page has, by experiment."""
    if not PAGE.exists():
        return {}
    lines = PAGE.read_text(encoding="utf-8").splitlines(keepends=True)
    return {line.split("`")[1]: line for line in lines if line.startswith("| `")}
