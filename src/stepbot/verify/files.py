"""Any URDF, SDFormat or MJCF files, ours or not: each as all engines see it, and all of them with each other.

Nobody says what such a file should hold, so engines are compared with engines: within a file with the one that tells
most, across files with the first file.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from ..diagnostics import Diagnostics, Span
from ..expect import CONFIGURATIONS, SECONDS, SEED
from ..isolation import DEFAULT_TIMEOUT, RemoteError, Worker, WorkerDied
from ..kinematics import configurations, rates
from ..model import Joint, JointKind, Limit, Link, Robot
from ..report import Check, Report
from ..simulators import engines_for
from ..simulators.observation import Observation, Quantity, Request
from ..simulators.workers import Engines, Fate, Outcome, check_required, check_started
from .alike import alike
from .checks import Subject, check_of, checks_without_observation, report_failure
from .compare import Compared, compare

ENGINE_WARNING = "SB813"

_FORMATS = {"robot": "urdf", "sdf": "sdf", "mujoco": "mjcf"}
_PREFERRED = ("mujoco", "reader", "drake", "pybullet", "pinocchio", "yourdfpy")
"""Engines by how much they tell; one that is not named comes after these."""
_SCOUTS = ("mujoco", "reader", "yourdfpy", "pybullet", "pinocchio", "drake")
"""Engines in the order in which they are asked for the joints: those that read mimics first."""
_OWN = (Quantity.LOAD, Quantity.SIMULATION, Quantity.WARNINGS)
"""What an engine says without a second one to compare with."""


def verify_files(
    paths: Sequence[Path],
    found: Diagnostics,
    *,
    require: Iterable[str] = (),
    timeout: float = DEFAULT_TIMEOUT,
    memory_limit: int | None = None,
) -> Report:
    """Load every file in every engine that reads it, and compare what they see.

    Args:
        paths: The files; the first is the one that the others are compared with.
        found: Takes the diagnostics: files that cannot be read, engines that refuse or die, differences.
        require: Engines whose absence is an error.
        timeout: Seconds that each engine may take.
        memory_limit: Address space [bytes] of each engine; None for no limit.
    """
    required = tuple(require)
    check_required(required, found)
    formats = {path: name for path in dict.fromkeys(paths) if (name := format_of(path, found)) is not None}
    keys = {_key(path): name for path, name in formats.items()}
    with Engines(keys, memory_limit) as engines:
        # What to ask depends on the joints: one engine per file is asked for them before, while the others start.
        scouted = [seen for path, name in formats.items() if (seen := _scout(path, name, timeout, memory_limit))]
        moved = _moved(scouted)
        engines.submit({_key(path): _request(path, name, moved) for path, name in formats.items()})
        outcomes = engines.results(timeout)
    check_started(required, outcomes, found)
    by_file = {_key(path): [outcome for outcome in outcomes if outcome.key == _key(path)] for path in formats}
    checks: list[Check] = []
    references = {key: _reference(of_file) for key, of_file in by_file.items()}
    for key, of_file in by_file.items():
        checks += _checks_within(key, of_file, references[key], found)
    checks += _checks_across(references, found)
    versions = {outcome.engine: outcome.observation.version for outcome in outcomes if outcome.observation}
    notes = {f"{o.key} in {o.engine}": o.observation.notes for o in outcomes if o.observation and o.observation.notes}
    return Report(tuple(checks), dict(sorted(versions.items())), notes=notes)


def format_of(path: Path, found: Diagnostics) -> str | None:
    """Format of a file by its first element; None, and a diagnostic, where it has none."""
    from lxml import etree

    span = Span(_key(path))
    if not path.is_file():
        found.add("SB001", f"no file '{_key(path)}'", span)
        return None
    try:
        with path.open("rb") as file:
            for _, element in etree.iterparse(file, events=("start",), resolve_entities=False, no_network=True):
                name = _FORMATS.get(str(element.tag))
                if name is None:
                    found.add("SB814", f"first element <{element.tag}>, expected one of: {', '.join(_FORMATS)}", span)
                return name
    except etree.XMLSyntaxError as error:
        found.add("SB814", f"not XML: {error.msg}", Span(_key(path), error.lineno or 0))
        return None
    found.add("SB814", "the file is empty", span)
    return None


def _key(path: Path) -> str:
    """What the user called the file, with forward slashes."""
    return path.as_posix()


def _request(path: Path, written_in: str, moved: Robot) -> Request:
    return Request(
        str(path.resolve()),
        written_in,
        configurations=configurations(moved, CONFIGURATIONS, SEED),
        rates=rates(moved, CONFIGURATIONS, SEED),
        simulate=SECONDS,
    )


def _rank(engine: str, order: Sequence[str] = _PREFERRED) -> int:
    return order.index(engine) if engine in order else len(order)


def _scout(path: Path, written_in: str, timeout: float, memory_limit: int | None) -> Observation | None:
    """What the first engine sees that can load the file; what the others say of it is asked later."""
    for engine in sorted(engines_for(written_in), key=lambda engine: _rank(engine.NAME, _SCOUTS)):
        if engine.available() is not None:
            continue
        with Worker(f"{engine.__name__}:observe", memory_limit=memory_limit) as worker:
            try:
                seen: Observation = worker.submit(Request(str(path.resolve()), written_in, simulate=0.0)).result(
                    timeout
                )
            except (RemoteError, WorkerDied):  # the engine is asked again below, and its failure reported there
                continue
            return seen
    return None


def _moved(scouted: Sequence[Observation]) -> Robot:
    """All joints of all files, within the limits of each, to draw configurations of."""
    joints: dict[str, Joint] = {}
    for joint in (joint for observation in scouted for joint in observation.joints):
        if not joint.name or joint.kind not in ("revolute", "continuous", "prismatic"):
            continue
        limit = joint.limit or Limit()
        known = joints.get(joint.name)
        if known is not None:
            lower, upper = max(limit.lower, known.limit.lower), min(limit.upper, known.limit.upper)
            limit = Limit(lower, upper) if lower <= upper else known.limit
        mimic = joint.mimic or (known.mimic if known else None)
        child = f"{len(joints)}" if known is None else known.child
        joints[joint.name] = Joint(joint.name, JointKind(joint.kind), "", child, limit=limit, mimic=mimic)
    links = (Link(""), *(Link(joint.child) for joint in joints.values()))
    return Robot("", links, tuple(joints.values()))


def _reference(outcomes: Sequence[Outcome]) -> Outcome | None:
    """What the engine says that tells most."""
    seen = [outcome for outcome in outcomes if outcome.fate is Fate.OBSERVED]
    return min(seen, key=lambda outcome: _rank(outcome.engine), default=None)


def _checks_within(
    key: str, outcomes: Sequence[Outcome], reference: Outcome | None, found: Diagnostics
) -> Iterator[Check]:
    """Every engine of a file against the one that tells most; that one only for what it says by itself."""
    if reference is None and all(outcome.fate in (Fate.ABSENT, Fate.UNREADABLE) for outcome in outcomes):
        reasons = "; ".join(f"{outcome.engine}: {outcome.reason}" for outcome in outcomes)
        found.add("SB815", f"no engine read the file: {reasons}", Span(key))
    for outcome in outcomes:
        alone = reference is None or outcome is reference
        against = "itself" if alone or reference is None else reference.engine
        subject = Subject(key, outcome.format, outcome.engine, against)
        if outcome.observation is None:
            yield from checks_without_observation(subject, outcome, _OWN, found)
            continue
        assert reference is not None
        assert reference.observation is not None
        pair = alike(reference.observation, outcome.observation)
        results = [one for one in compare(*pair) if not alone or one.quantity in _OWN]
        yield from _reported(subject, results, found)


def _checks_across(references: Mapping[str, Outcome | None], found: Diagnostics) -> Iterator[Check]:
    """Every further file against the first, both as the engine sees them that tells most."""
    seen = {key: outcome for key, outcome in references.items() if outcome is not None}
    if len(seen) < 2:
        return
    (first, reference), *others = seen.items()
    for key, outcome in others:
        assert reference.observation is not None
        assert outcome.observation is not None
        subject = Subject(key, outcome.format, outcome.engine, f"{first} ({reference.engine})")
        pair = alike(reference.observation, outcome.observation)
        yield from _reported(subject, [one for one in compare(*pair) if one.quantity not in _OWN], found)


def _reported(subject: Subject, results: Iterable[Compared], found: Diagnostics) -> Iterator[Check]:
    for compared in results:
        report_failure(subject, compared, ENGINE_WARNING, found)
        yield check_of(subject, compared)
