"""Compares any URDF, SDFormat or MJCF files: the observations of all engines for each file, and all files.

The expected content is unknown, so engines are compared with each other: within a file with the engine that reports
most, across files with the first file.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import Engine, engine_of
from stepbot.engines.description.statements import Statement
from stepbot.engines.file_references import first_element, openable
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.engines.prestart import started_engine_server
from stepbot.engines.workers import Engines, Fate, Outcome, check_required, check_started
from stepbot.formats import FORMATS
from stepbot.report.robot import Report
from stepbot.robot.joint_table import JointRow
from stepbot.robot.kinematics import configurations, rates
from stepbot.robot.model import Link, Robot
from stepbot.robot.renaming import NewNames
from stepbot.runtime.file import open_regular
from stepbot.runtime.temporary import run_folder
from stepbot.runtime.worker import DEFAULT_WORKERS, Workers

from .admission import admitted, is_robot_file, located
from .compare import QuantityComparison
from .correspondence import Correspondence
from .counterparts import counterparts, with_new_names, with_old_names
from .deviation import TOLERANCES, Deviations
from .expectation import CONFIGURATIONS, SECONDS, SEED
from .joint_rows import joint_rows
from .judging import UNCHANGED, Asked, checks_within, compared_with_first, judge, ranked, report_of, report_unread
from .merged_observation import Gathered, gather
from .naming import Naming, moved
from .probe import Probe, Probed, in_a_process
from .shapes import link_pairs

_Value = TypeVar("_Value")
_SIGNATURE = 16
"""Number of bytes that signatures of formats are within."""
_UNREAD = ("SB801", "SB802", "SB901")
"""Codes of engines that rejected a file, crashed, or failed."""
_LENIENT = "correct this line; engines are more lenient, and accept files that are not XML"


def verify_files(
    paths: Sequence[Path],
    diagnostics: Diagnostics,
    *,
    require: Iterable[str] = (),
    workers: Workers = DEFAULT_WORKERS,
    packages: Iterable[Path] = (),
    xacro: Iterable[tuple[str, str]] = (),
) -> Report:
    """Load every file in every engine that reads it, and compare the observations.

    Args:
        paths: The files; the others are compared with the first.
        diagnostics: Receives the diagnostics: unreadable files, engines that reject a file or crash, differences.
        require: Engines whose absence is an error.
        packages: Folders of the packages that the files name, or the folders that contain them.
        xacro: Name and value of arguments of the files with macros.
    """
    required = tuple(require)
    check_required(required, diagnostics)
    asked, outcomes = observed(paths, diagnostics, workers, packages=tuple(packages), xacro=xacro)
    check_started(required, outcomes, diagnostics)
    compared = Diagnostics()
    checks = judge(outcomes, asked, compared)
    diagnostics.extend(one.after("verify") for one in compared)
    return report_of(checks, outcomes, joint_table=_named(asked.joint_table, outcomes))


def _named(table: Sequence[JointRow], outcomes: Iterable[Outcome]) -> tuple[JointRow, ...]:
    """The joint table of the first file, with names that its engine lacks from others: MuJoCo drops fixed joints."""
    seen = [(outcome.key, outcome.observation) for outcome in outcomes if outcome.observation is not None]
    names = {joint.child: joint.name for key, one in seen if key == seen[0][0] for joint in one.joints if joint.name}
    return tuple(row if row.name or row.is_closure else replace(row, name=names.get(row.child, "")) for row in table)


def compare_two(
    old: Path,
    new: Path,
    diagnostics: Diagnostics,
    workers: Workers,
    packages: Iterable[Path] = (),
    xacro: Iterable[tuple[str, str]] = (),
) -> "tuple[QuantityComparison, ...] | None":
    """Compare one file with another in everything that engines report of both; None if either cannot be read.

    Args:
        diagnostics: Receives the errors of files that cannot be read, and of engines that cannot read one of them;
            SB815 for a file that no engine reads, or that only an engine that reports more reads.
        packages: Folders of the packages that the files name, or the folders that contain them.
        xacro: Name and value of arguments of the files with macros.
    """
    reported = Diagnostics()
    asked, outcomes = observed(
        (old, new), reported, workers, count=1, seconds=0.0, packages=tuple(packages), xacro=tuple(xacro)
    )
    of_file = {_key(path): [outcome for outcome in outcomes if outcome.key == _key(path)] for path in (old, new)}
    for outcome in outcomes:
        if outcome.fate in (Fate.REFUSED, Fate.DIED) and (witness := _witness(outcome, of_file)):
            of_file[outcome.key].remove(outcome)
            message = f"not compared in {outcome.engine}, only in {witness}: {outcome.reason}"
            help = f"`stepbot verify {outcome.key}` lists what each engine reports"
            diagnostics.add("SB815", message, Span(outcome.key), help=[help])
    for key, some in of_file.items():
        list(checks_within(key, some, reported))
    seen = [seen_by for path in (old, new) if (seen_by := ranked(of_file[_key(path)]))]
    errors = [one.after("verify") for one in reported if one.severity == "error"]
    diagnostics.extend(error for error in errors if len(seen) < 2 or error.code in _UNREAD)
    if len(seen) < 2:
        if not diagnostics.has_errors:
            for key, some in of_file.items():
                if some and not ranked(some):
                    report_unread(key, some, diagnostics)
        return None
    ours, theirs = map(gather, seen)
    results = compared_with_first(ours, theirs, asked)
    return (*results, *_of_one_alone(ours, theirs)) if ours.format == theirs.format else results


def _witness(failed: Outcome, of_file: Mapping[str, Sequence[Outcome]]) -> str:
    """An engine that reports more than one that failed, and has loaded both files; empty if there is none."""
    loaded = [{one.engine for one in some if one.fate is Fate.OBSERVED} for some in of_file.values()]
    both = (engine_of(name) for name in set[str].intersection(*loaded))
    able = [one for one in both if not one.own_parser and one.order < engine_of(failed.engine).order]
    return min(able, key=lambda one: one.order).name if able else ""


def _of_one_alone(ours: Gathered, theirs: Gathered) -> tuple[QuantityComparison, ...]:
    """What one of two files of a format has alone: named frames, sizes of shapes, where engines report both's."""
    frames, sizes = (Deviations(TOLERANCES[one]) for one in (Quantity.FRAMES, Quantity.MESHES))
    a, b = ours.observation, theirs.observation
    if a.frames is not None and b.frames is not None:
        for name in dict.fromkeys((*a.frames, *b.frames)):
            wrong = f"frame '{name}' is {'missing' if name in a.frames else 'not in the robot'}"
            frames.equal(name in a.frames and name in b.frames, wrong)
    for one, other in link_pairs(a, b) if a.engine == b.engine else ():
        for side in ("visual", "collision"):
            has = [getattr(link, f"{side}_bounds") is not None for link in (one, other)]
            wrong = f"size of the {side} of link '{one.name}' is {'missing' if has[0] else 'new'}"
            sizes.equal(has[0] == has[1], wrong)
    return QuantityComparison(Quantity.FRAMES, frames), QuantityComparison(Quantity.MESHES, sizes)


def observed(
    paths: Sequence[Path],
    diagnostics: Diagnostics,
    workers: Workers,
    *,
    count: int = CONFIGURATIONS,
    seconds: float = SECONDS,
    renamed: Mapping[str, NewNames] | None = None,
    packages: Iterable[Path] | None = None,
    included: Sequence[Path] = (),
    xacro: Iterable[tuple[str, str]] = (),
) -> "tuple[Asked, Sequence[Outcome]]":
    """Load every file in every engine that reads it.

    Args:
        paths: The files; the same motions are asked of all, in the coordinates of the first.
        diagnostics: Receives the errors of files that cannot be read.
        seconds: Duration [s] of the passive simulation.
        renamed: By absolute path, the names under which files are compared.
        packages: Folders of packages; None for files whose meshes every engine finds.
        included: Then folders from which an MJCF may include files, in addition to its own.
        xacro: Name and value of arguments of the files with macros.
    """
    names = dict(renamed or {})
    formats = {path: name for path in dict.fromkeys(paths) if (name := format_of(path, diagnostics)) is not None}
    with ExitStack() as running:
        server = started_engine_server()
        if server is not None:
            workers = workers._replace(start=running.enter_context(server).fork)
        if packages is None:
            formats = admitted(formats, diagnostics, workers, included)
            places, texts = {path: path for path in formats}, dict[Path, tuple[Statement, ...]]()
        else:
            copies = Path(running.enter_context(TemporaryDirectory(dir=run_folder())))
            places, texts = located(formats, packages, copies, diagnostics, workers, xacro)
            formats = {path: formats[path] for path in places}
        keys = {_key(path): name for path, name in formats.items()}
        engines = running.enter_context(Engines(keys, workers.memory_limit, workers.start))
        observe = in_a_process(workers)

        def observe_renamed(engine: Engine, request: Request) -> Observation | None:
            name = names.get(request.file, UNCHANGED)
            seen = observe(engine, with_old_names(request, name))
            return seen and with_new_names(seen, name)

        # The files are probed while the engines start.
        probe = Probe(observe_renamed)
        probed = probe.files(formats, places)
        paired = _paired(probed) if renamed is None else {}
        for path, ours in paired.items():
            probed[path] = probed[path].renamed(ours)
            names[probed[path].asked.file] = ours
        asked = ask(formats, places, probe, probed, count=count, seconds=seconds)
        asked = replace(asked, paired=_by_key(paired), texts=_by_key(texts))
        engines.submit(
            {key: with_old_names(one, names.get(one.file, UNCHANGED)) for key, one in asked.requests.items()}
        )
        outcomes = engines.results(workers.timeout)
        return asked, [
            replace(outcome, observation=outcome.observation and with_new_names(outcome.observation, new))
            if (new := names.get(asked.requests[outcome.key].file))
            else outcome
            for outcome in outcomes
        ]


def _paired(probed: Mapping[Path, Probed]) -> dict[Path, NewNames]:
    """Names that the first file has for links and joints of others that name some in another way."""
    files = list(probed.items())
    paired = {path: counterparts(files[0][1].seen, other.seen) for path, other in files[1:]}
    return {path: one for path, one in paired.items() if one.links or one.joints}


def format_of(path: Path, diagnostics: Diagnostics) -> str | None:
    """Format of a file by its first bytes or its root element; None, and a diagnostic, if it has none."""
    from lxml import etree

    span = Span(_key(path))
    if not is_robot_file(path, diagnostics):
        return None
    if not path.stat().st_size:
        diagnostics.add("SB814", "the file is empty", span)
        return None
    # Format of a file that is not XML, by its first bytes.
    with open_regular(path) as file:
        start = file.read(_SIGNATURE)
    signed = next((one.name for one in FORMATS.values() if one.signatures and start.startswith(one.signatures)), None)
    if signed is not None:
        return signed
    try:
        element = first_element(path)
    except etree.XMLSyntaxError as error:
        diagnostics.add("SB814", f"not XML: {error.msg}", Span(_key(path), error.lineno or 0), help=[_LENIENT])
        return None
    by_root = {written.root: written.name for written in FORMATS.values() if written.root}
    name = by_root.get(str(element.tag))
    if name is None:
        diagnostics.add("SB814", f"root element <{element.tag}>, expected one of: {', '.join(by_root)}", span)
    return name


def _key(path: Path) -> str:
    """The user's path of the file, with forward slashes."""
    return path.as_posix()


def _by_key(values: Mapping[Path, _Value]) -> dict[str, _Value]:
    return {_key(path): value for path, value in values.items()}


def ask(
    formats: Mapping[Path, str],
    places: Mapping[Path, Path],
    probe: Probe,
    probed: Mapping[Path, Probed],
    *,
    count: int = CONFIGURATIONS,
    seconds: float = SECONDS,
) -> Asked:
    """The same poses and motions for all files, in the coordinates of each.

    Args:
        places: Where engines find each file.
        probed: What one engine reports of each file that it can load: the requests depend on the joints.
        seconds: Duration [s] of the passive simulation.
    """
    by = {path: probe.correspondence(next(iter(probed.values())), other) for path, other in list(probed.items())[1:]}
    joints = moved(one.naming for one in probed.values())
    drawn = _clear_of_locks(configurations(joints, count, SEED), by.values())
    moving = [(_followed(v, by.values()), _followed(a, by.values())) for v, a in rates(joints, count, SEED)]
    requests = {}
    for path, name in formats.items():
        corresponds = by.get(path, Correspondence(()))
        names = probed[path].naming if path in probed else Naming(Robot("", (Link(""),), ()))
        requests[_key(path)] = Request(
            str(openable(places[path])),
            name,
            configurations=tuple(corresponds.moved(q) for q in drawn),
            rates=tuple(corresponds.moving(q, one) for q, one in zip(drawn, moving, strict=True)),
            initial=(probed[path].seen.initial if path in probed else None) or {},
            simulate=seconds,
            balls=names.balls,
            universals=names.universals,
            compiled=list(formats.values()).count(name) > 1,
        )
    table = next((joint_rows(one.seen) for one in probed.values()), ())
    return Asked(requests, _by_key(by), drawn, table)


def _followed(rate: Mapping[str, float], by: Iterable[Correspondence]) -> Mapping[str, float]:
    for correspondence in by:
        rate = correspondence.following(rate)
    return rate


def _clear_of_locks(
    drawn: Iterable[Mapping[str, float]], by: Collection[Correspondence]
) -> tuple[Mapping[str, float], ...]:
    """Configurations without gimbal lock of any ball joint in any file: there, speeds of the angles are unbounded."""
    random = np.random.Generator(np.random.PCG64(SEED + 2))
    clear = []
    for q in drawn:
        while locked := next((correspondence for correspondence in by if not correspondence.is_clear(q)), None):
            q = locked.turned_elsewhere(q, random)  # it alone is known to have a ball joint to turn
        clear.append(q)
    return tuple(clear)
