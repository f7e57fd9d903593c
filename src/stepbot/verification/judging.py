"""Judges observations of files: the engines of a file against the one that reports most, then file against file.

Comparisons become checks of the report and diagnostics.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span, cut
from stepbot.engines import engine_of, own_parsers
from stepbot.engines.description.statements import Statement
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.engines.workers import Fate, Outcome
from stepbot.report.robot import Check, Report, Status
from stepbot.robot.joint_table import JointRow
from stepbot.robot.renaming import NewNames

from .compare import QuantityComparison, compare
from .correspondence import Correspondence, normalized_joints
from .merged_observation import Gathered, gather
from .normalized import normalized
from .text import compare_settings, compare_text

_OTHER_ROBOT = "SB803"
_CODES = {Quantity.CLOSURES: "SB808", Quantity.SIMULATION: "SB811"}
"""Codes of failed checks of which more is known than that the file describes another robot; warnings have one for
stepbot's files and one for others."""

MOST_NOTES = 8
"""Maximum number of deviations, after the worst, that a diagnostic lists."""


class Subject(Struct, frozen=True):
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
        fields = (self.file, self.format, self.engine, quantity, status, deviation, tolerance, unit, where)
        return Check(*fields, why=why, against=self.against)


ENGINE_WARNING = "SB813"


def judged(
    subject: Subject, compared: QuantityComparison, diagnostics: Diagnostics, warning_code: str = ENGINE_WARNING
) -> Check:
    """The check of a comparison; a failure is reported, with this code if it is a warning of the engine."""
    report_failure(subject, compared, warning_code, diagnostics)
    return check_of(subject, compared)


def check_of(subject: Subject, compared: QuantityComparison) -> Check:
    """The check of a comparison."""
    worst, quantity = compared.deviations.worst, compared.quantity.value
    if compared.not_run or worst is None:
        return subject.check(quantity, Status.NOT_RUN, why=compared.not_run)
    failures = compared.deviations.failures
    shown = failures[0] if failures else worst
    unreported = ", ".join(dict.fromkeys(compared.deviations.unreported))
    why = (
        "; ".join(str(deviation) for deviation in failures[:2])
        if failures
        else (unreported and f"not reported: {unreported}")
    )
    where = shown.where if shown.unit or failures else ""
    amount, allowed = (shown.amount, shown.allowed) if shown.unit else (None, None)
    status = Status.FAILED if failures else Status.PASSED
    return subject.check(quantity, status, amount, allowed, shown.unit, where, why)


def report_failure(subject: Subject, compared: QuantityComparison, warning_code: str, diagnostics: Diagnostics) -> None:
    """A diagnostic of a failed comparison; its first line is complete, the rest are notes."""
    failures = compared.deviations.failures
    if not failures or compared.not_run:
        return
    code = warning_code if compared.quantity is Quantity.WARNINGS else _CODES.get(compared.quantity, _OTHER_ROBOT)
    message = f"{subject.words}: {compared.quantity.value}: {failures[0]}"
    diagnostics.add(code, message, Span(subject.file), notes=cut([*map(str, failures[1:])], MOST_NOTES))


def report_unread(file: str, outcomes: Sequence[Outcome], diagnostics: Diagnostics) -> None:
    """A diagnostic of a file that no engine read, with what to install (SB815)."""
    reasons = "; ".join(f"{outcome.engine}: {outcome.reason}" for outcome in outcomes)
    absent = [engine_of(outcome.engine) for outcome in outcomes if outcome.fate is Fate.ABSENT]
    help = dict.fromkeys(engine.install for engine in absent if engine.install)
    diagnostics.add("SB815", f"no engine read the file: {reasons}", Span(file), help=tuple(help))


def checks_without_observation(
    subject: Subject, outcome: Outcome, quantities: Sequence[Quantity], diagnostics: Diagnostics
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
        notes = [*more, *outcome.last_lines]
        diagnostics.add(code, f"{subject.engine}: {first}", Span(subject.file), help=outcome.help, notes=notes)
    return checks


def report_of(
    checks: Iterable[Check], outcomes: Sequence[Outcome], names: Mapping[str, str] | None = None, **more: Any
) -> Report:
    """The report of checks, with the engines that ran.

    Args:
        names: Name of the file of each key of the outcomes; None for the keys.
        more: Further fields of the report.
    """
    ran = {outcome.engine: outcome.observation for outcome in outcomes if outcome.observation is not None}
    seen = [(outcome, outcome.observation) for outcome in outcomes if outcome.observation is not None]
    return Report(
        checks=tuple(checks),
        versions={engine: ran[engine].version for engine in sorted(ran)},
        distributions={engine: ran[engine].distribution for engine in sorted(ran) if ran[engine].distribution},
        notes={f"{(names or {}).get(o.key, o.key)} in {o.engine}": one.notes for o, one in seen if one.notes},
        own_parsers=own_parsers(),
        **more,
    )


UNCHANGED = NewNames()
OWN_RESULT = (Quantity.LOAD, Quantity.SIMULATION, Quantity.WARNINGS)
"""Diagnostics of an engine's own result, independent of others."""
_STILL = frozenset(
    {
        Quantity.GRAVITY_SETTINGS,
        Quantity.CLOSURES,
        Quantity.MESHES,
        Quantity.SHAPES,
        Quantity.CONTACTS,
        Quantity.FRAMES,
        Quantity.ACTUATORS,
        Quantity.SENSORS,
        Quantity.INITIAL,
        Quantity.TEXT,
    }
)
"""Quantities comparable between files whatever the configurations of the first file were."""


class Asked(Struct, frozen=True, eq=False):
    """The requests to the engines for all files."""

    requests: Mapping[str, Request]
    """For each file, by the user's path."""
    correspondences: Mapping[str, Correspondence]
    """Correspondence of each further file to the first."""
    configurations: Sequence[Mapping[str, float]]
    """Configurations of the joints of the first file."""
    joint_table: tuple[JointRow, ...]
    """The joints of the first file that an engine can load."""
    paired: Mapping[str, NewNames] = field(default_factory=dict)
    """Names of the first file for what has other names in a further file, by the path of that file."""
    texts: Mapping[str, tuple[Statement, ...]] = field(default_factory=dict)
    """What files that share a format contain, by path."""


def judge(outcomes: Sequence[Outcome], asked: Asked, diagnostics: Diagnostics) -> tuple[Check, ...]:
    """Compare the observations: within each file, and between files."""
    by_file = {key: [outcome for outcome in outcomes if outcome.key == key] for key in asked.requests}
    checks: list[Check] = []
    for key, of_file in by_file.items():
        checks += checks_within(key, of_file, diagnostics)
    seen = [seen_by for of_file in by_file.values() if (seen_by := ranked(of_file))]
    checks += _checks_across([gather(one) for one in seen], asked, diagnostics)
    return tuple(checks)


def ranked(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The outcomes with an observation of the file, the engine that reports most first."""
    seen = [outcome for outcome in outcomes if outcome.fate is Fate.OBSERVED]
    return sorted(seen, key=lambda outcome: engine_of(outcome.engine).order)


def checks_within(key: str, outcomes: Sequence[Outcome], diagnostics: Diagnostics) -> Iterator[Check]:
    """Every engine of a file against the one that reports most; that one only for its own result."""
    reference = next(iter(ranked(outcomes)), None)
    if reference is None and all(outcome.fate in (Fate.ABSENT, Fate.UNREADABLE) for outcome in outcomes):
        report_unread(key, outcomes, diagnostics)
    for outcome in outcomes:
        alone = reference is None or outcome is reference
        against = "itself" if alone or reference is None else reference.engine
        subject = Subject(key, outcome.format, outcome.engine, against)
        if outcome.observation is None:
            yield from checks_without_observation(subject, outcome, OWN_RESULT, diagnostics)
            continue
        assert reference is not None
        assert reference.observation is not None
        pair = normalized(reference.observation, outcome.observation)
        yield from (
            judged(subject, one, diagnostics) for one in compare(*pair) if not alone or one.quantity in OWN_RESULT
        )


def _checks_across(gathered: Sequence[Gathered], asked: Asked, diagnostics: Diagnostics) -> Iterator[Check]:
    """Every further file against the first, and for quantities that the first lacks against the files before it."""
    for number, theirs in enumerate(gathered):
        compared = set(OWN_RESULT)
        for ours in gathered[:number]:
            first = ours is gathered[0]
            results = [
                one
                for one in _compared_across(ours, theirs, asked, first=first)
                if one.quantity not in compared and (first or (one.quantity in _STILL and not one.not_run))
            ]
            compared |= {result.quantity for result in results if not result.not_run}
            if not ours.observation.gravity:  # another file may have one
                compared.discard(Quantity.GRAVITY_SETTINGS)
            for one in results:
                against = f"{ours.key} ({ours.engine(one.quantity)})"
                subject = Subject(theirs.key, theirs.format, theirs.engine(one.quantity), against)
                yield judged(subject, one, diagnostics)


def compared_with_first(
    ours: Gathered, theirs: Gathered, asked: Asked, *, springs_alone: bool = False
) -> tuple[QuantityComparison, ...]:
    """The comparison of a file with the first one.

    Args:
        springs_alone: Whether the rest of a joint without stiffness, of which nothing is written, does not count.
    """
    return _compared_across(ours, theirs, asked, first=True, whole=True, springs_alone=springs_alone)


def _without_rests(observation: Observation) -> Observation:
    joints = (
        replace(joint, dynamics=replace(joint.dynamics, spring_reference=0.0))
        if joint.dynamics is not None and not joint.dynamics.stiffness
        else joint
        for joint in observation.joints
    )
    return replace(observation, joints=tuple(joints))


def _compared_across(
    ours: Gathered, theirs: Gathered, asked: Asked, *, first: bool, whole: bool = False, springs_alone: bool = False
) -> tuple[QuantityComparison, ...]:
    pair = ours.observation, theirs.observation
    by = asked.correspondences.get(theirs.key, Correspondence(()))
    if first:
        pair = normalized_joints(*pair, by, asked.configurations)
    if springs_alone:
        pair = _without_rests(pair[0]), _without_rests(pair[1])
    results = compare(*normalized(*pair))
    if first:
        _add_other_names(results, asked.paired.get(theirs.key, UNCHANGED))
    if ours.format == theirs.format:
        equal = not any(
            result.deviations.failures for result in results if not result.not_run and result.quantity not in OWN_RESULT
        )
        texts = [asked.texts.get(key, ()) for key in (ours.key, theirs.key)]
        compiled = bool(ours.observation.compiled) and ours.observation.compiled == theirs.observation.compiled
        defaults = {place for one in (ours, theirs) for place in one.observation.stated_defaults}
        text = compare_text(*texts, equal=equal, whole=whole, compiled=compiled, defaults=defaults)
        results = results if text is None else (*results, text)
        if whole and equal and text is None and all(texts):
            results = (*results, QuantityComparison(Quantity.TEXT, compare_settings(*(one.settings for one in pair))))
    return results


def _add_other_names(results: Iterable[QuantityComparison], names: NewNames) -> None:
    """What was paired by structure has another name."""
    for result in results:
        renamed = {Quantity.LINKS: names.links, Quantity.JOINTS: names.joints}.get(result.quantity, {})
        for new, old in renamed.items():
            what = result.quantity.value.removesuffix("s")
            result.deviations.equal(False, f"{what} '{old}' is named '{new}', paired by structure")
