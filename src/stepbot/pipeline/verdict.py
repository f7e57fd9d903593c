"""The verdict on a robot in words: what it is, and which of its files are proven by which engines."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from stepbot.engines import engine_of, engines
from stepbot.formats import FORMATS
from stepbot.geometry.fixed_point import exact_sum
from stepbot.report import Summary
from stepbot.report.results import Check, Results, Status
from stepbot.report.words import mass_words, weak_joints
from stepbot.robot.closures import degrees_of_freedom
from stepbot.robot.model import Robot

_OF_THE_FILE = ("load", "warnings")
"""Quantities that are about the file and not about the robot."""


def summary_of(robot: Robot, results: Results, source: str) -> Summary:
    """What the default output prints about a conversion.

    Args:
        source: What the files are compared with, in words: ``the CAD``.
    """
    words = robot_words(robot, results.degrees_of_freedom)
    return Summary(words, proof_words(results, source), weak_joints(results.joint_table))


def robot_words(robot: Robot, freedom: int | None = None) -> str:
    """``four_bar: 4 links, 4 joints (1 closes a loop), 1 degree of freedom, 3.13 kg``; None computes the freedom."""
    closures = len(robot.closures)
    loops = f" ({closures} {'closes a loop' if closures == 1 else 'close loops'})" if closures else ""
    freedom = degrees_of_freedom(robot) if freedom is None else freedom
    facts = (
        _counted(len(robot.links), "link"),
        f"{_counted(len(robot.joints) + closures, 'joint')}{loops}",
        "1 degree of freedom" if freedom == 1 else f"{freedom} degrees of freedom",
        mass_words(exact_sum(link.mass_properties.mass for link in robot.links)),
    )
    return f"{robot.name}: {', '.join(facts)}"


def proof_words(results: Results, source: str) -> tuple[str, ...]:
    """Which formats which engines confirm, what failed, and what stepbot's own parsers alone confirm; one line each.

    Args:
        source: What the files are compared with.
    """
    if not results.checks:
        return ("not verified: no engine loaded the files",)
    by_format: dict[str, list[Check]] = {}
    for check in results.checks:
        by_format.setdefault(check.format, []).append(check)
    written = {name: _with(checks, Status.PASSED) for name, checks in by_format.items() if name in FORMATS}
    proven = {
        name: checks
        for name, checks in written.items()
        if _by_engines(checks, results.own_parsers) and not _with(by_format[name], Status.FAILED)
    }
    lines = list(_failures(by_format, len(_with(results.checks, Status.FAILED, Status.PASSED)), source))
    if proven:
        confirmed = [check for checks in proven.values() for check in checks]
        lines.append(
            f"proven: {_joined(map(_title, proven))} {'matches' if len(proven) == 1 else 'match'} {source} in "
            f"{_engines(_by_engines(confirmed, results.own_parsers))} ({_counted(len(confirmed), 'check')})"
        )
    for name, passed in written.items():
        if name not in proven and not _with(by_format[name], Status.FAILED):
            readers = "only stepbot's own parser" if passed else "no installed engine"
            lines.append(f"not proven: {_title(name)}: {readers} reads it{_advice(by_format[name])}")
    return (*lines, *_read_back(written, results))


def compared_words(results: Results, paths: Sequence[Path]) -> tuple[str, ...]:
    """The verdict of a comparison of files with each other, or of one file in several engines."""
    files, seen = [path.name for path in paths], {check.file for check in results.checks}
    compared = _with(results.checks, Status.PASSED, Status.FAILED)
    failed = _with(results.checks, Status.FAILED)
    if not compared:
        return ("not verified: no engine could load " + _joined(files),)
    if failed:
        what = _joined(dict.fromkeys(check.quantity for check in failed))
        where = _joined(dict.fromkeys(check.file for check in failed if check.file)) or "the robot"
        return (f"different: {where}: {what} ({len(failed)} of {_counted(len(compared), 'check')})",)
    if unread := [path.name for path in paths if path.as_posix() not in seen]:
        return (f"not compared: {_joined(unread)} could not be read",)
    same = "is the same robot" if len(files) == 1 else "are the same robot"
    names = _by_engines(compared, results.own_parsers)
    confirmed = _engines(names) if names else "stepbot's own parser alone"
    return (f"equal: {_joined(files)} {same} in {confirmed} ({_counted(len(compared), 'check')})",)


def _failures(by_format: Mapping[str, Sequence[Check]], compared: int, source: str) -> Iterator[str]:
    for name, checks in by_format.items():
        if failed := _with(checks, Status.FAILED):
            quantities = _joined(dict.fromkeys(check.quantity for check in failed))
            engines = _engines(dict.fromkeys(check.engine for check in failed))
            subject = f"{_title(name)} differs from {source} in {engines}" if name else "the robot itself"
            yield f"NOT PROVEN: {subject}: {quantities} ({len(failed)} of {_counted(compared, 'check')} failed)"


def _read_back(written: Mapping[str, Sequence[Check]], results: Results) -> Iterator[str]:
    """What stepbot's own parsers alone confirm in formats that engines read, and which packages add engines."""
    own: dict[str, list[str]] = {}
    for name, checks in written.items():
        engines = {check.quantity for check in checks if check.engine not in results.own_parsers}
        alone = [check.quantity for check in checks if check.quantity not in engines]
        if engines and (listed := [one for one in dict.fromkeys(alone) if one not in _OF_THE_FILE]):
            own[name] = listed
    if not own:
        return
    phrases = [f"{_joined(quantities)} of {_title(name)}" for name, quantities in own.items()]
    yield f"  by stepbot's parsers alone: {'; '.join(phrases)}{_advice(results.checks)}"


def _advice(checks: Iterable[Check]) -> str:
    """``; `pip install 'stepbot[verify]'` adds Drake``: the engines that pip would install; empty without any."""
    by_command: dict[str, dict[str, None]] = {}
    for check in checks:
        if check.status is Status.NOT_RUN and check.why.endswith("is not installed"):
            command = engine_of(check.engine).install or f"pip install {check.engine}"
            by_command.setdefault(command, {})[check.engine] = None
    return "".join(
        f"; `{command}` adds {_engines(added)}" for command, added in by_command.items() if command.startswith("pip ")
    )


def _by_engines(checks: Iterable[Check], own_parsers: Sequence[str]) -> dict[str, None]:
    """Names of the engines that compared something, stepbot's own parsers aside."""
    return dict.fromkeys(
        name for check in checks if check.file for name in check.engine.split(", ") if name not in own_parsers
    )


def _with(checks: Iterable[Check], *statuses: Status) -> list[Check]:
    return [check for check in checks if check.status in statuses]


def _engines(names: Iterable[str]) -> str:
    titles = {engine.name: engine.title or engine.name for engine in engines()}
    return _joined(titles.get(name, name) for name in names)


def _title(name: str) -> str:
    return FORMATS[name].title if name in FORMATS else name


def _joined(names: Iterable[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _counted(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
