"""Converts comparisons to checks of the report and diagnostics."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import engine_of
from stepbot.engines.observation import Quantity
from stepbot.engines.workers import Fate, Outcome
from stepbot.report.robot import Check, Status

from .compare import Compared

_OTHER_ROBOT = "SB803"
_CODES = {Quantity.CLOSURES: "SB808", Quantity.SIMULATION: "SB811"}
"""Codes of failed checks of which more can be said than that the file describes another robot; warnings have one for
stepbot's files and one for others."""

MOST_NOTES = 8
"""Maximum number of deviations, after the worst, that a diagnostic lists."""


@dataclass(frozen=True)
class Subject:
    """The file, the engine, and what the file is compared with."""

    file: str
    format: str
    engine: str
    against: str = "model"

    @property
    def words(self) -> str:
        """Prefix of a message."""
        return self.engine if self.against == "model" else f"{self.engine} against {self.against}"

    def check(
        self,
        quantity: str,
        status: Status,
        deviation: float | None = None,
        tolerance: float | None = None,
        unit: str = "",
        where: str = "",
        why: str = "",
    ) -> Check:
        """A check of this subject."""
        of = (self.file, self.format, self.engine, quantity, status, deviation, tolerance, unit, where)
        return Check(*of, why=why, against=self.against)


def check_of(subject: Subject, compared: Compared) -> Check:
    """The check of a comparison."""
    worst, quantity = compared.deviations.worst, compared.quantity.value
    if compared.not_run or worst is None:
        return subject.check(quantity, Status.NOT_RUN, why=compared.not_run)
    failures = compared.deviations.failures
    shown = failures[0] if failures else worst
    untold = ", ".join(dict.fromkeys(compared.deviations.untold))
    why = (
        "; ".join(str(deviation) for deviation in failures[:2]) if failures else (untold and f"not reported: {untold}")
    )
    where = shown.where if shown.unit or failures else ""
    amount, allowed = (shown.amount, shown.allowed) if shown.unit else (None, None)
    status = Status.FAILED if failures else Status.PASSED
    return subject.check(quantity, status, amount, allowed, shown.unit, where, why)


def report_failure(subject: Subject, compared: Compared, warning_code: str, found: Diagnostics) -> None:
    """A diagnostic of a failed comparison; its first line is complete, the rest are notes."""
    failures = compared.deviations.failures
    if not failures or compared.not_run:
        return
    code = warning_code if compared.quantity is Quantity.WARNINGS else _CODES.get(compared.quantity, _OTHER_ROBOT)
    notes = [str(deviation) for deviation in failures[1 : 1 + MOST_NOTES]]
    if len(failures) > 1 + MOST_NOTES:
        notes.append(f"and {len(failures) - 1 - MOST_NOTES} more")
    message = f"{subject.words}: {compared.quantity.value}: {failures[0]}"
    found.add(code, message, Span(subject.file), notes=notes)


def report_unread(file: str, outcomes: Sequence[Outcome], found: Diagnostics) -> None:
    """A diagnostic of a file that no engine read, with what to install (SB815)."""
    reasons = "; ".join(f"{outcome.engine}: {outcome.reason}" for outcome in outcomes)
    absent = [engine_of(outcome.engine) for outcome in outcomes if outcome.fate is Fate.ABSENT]
    help = dict.fromkeys(engine.install for engine in absent if engine.install)
    found.add("SB815", f"no engine read the file: {reasons}", Span(file), help=tuple(help))


def checks_without_observation(
    subject: Subject, outcome: Outcome, quantities: Sequence[Quantity], found: Diagnostics
) -> list[Check]:
    """Checks for an engine without an observation; a rejection or a crash fails ``load``, and is reported."""
    failed = outcome.fate in (Fate.REFUSED, Fate.DIED, Fate.BROKEN)
    words = {Fate.REFUSED: "refused", Fate.DIED: "died", Fate.BROKEN: "failed"}.get(outcome.fate, "")
    reason = f"{words}: {outcome.reason}" if words else outcome.reason
    checks = [
        subject.check(
            quantity.value,
            Status.FAILED if failed and quantity is Quantity.LOAD else Status.NOT_RUN,
            why=reason if quantity is Quantity.LOAD or not failed else f"{subject.engine} did not load the file",
        )
        for quantity in quantities
    ]
    if failed:
        code = {Fate.REFUSED: "SB801", Fate.DIED: "SB802"}.get(outcome.fate, "SB901")
        first, *more = outcome.reason.splitlines() or [""]
        found.add(code, f"{subject.engine}: {first}", Span(subject.file), notes=[*more, *outcome.last_lines])
    return checks


def versions(outcomes: Iterable[Outcome]) -> dict[str, str]:
    """The engines that ran, and their versions."""
    ran = {outcome.engine: outcome.observation.version for outcome in outcomes if outcome.observation}
    return dict(sorted(ran.items()))


def distributions(outcomes: Iterable[Outcome]) -> dict[str, str]:
    """The engines that ran, and the installed distribution that each comes from."""
    ran = {one.engine: one.observation.distribution for one in outcomes if one.observation}
    return {name: distribution for name, distribution in sorted(ran.items()) if distribution}
