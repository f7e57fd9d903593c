"""The comments that `stepbot init` writes about a joint or link: the evidence for it, and what to review."""

import re
from collections.abc import Callable, Container, Iterator, Sequence
from math import isfinite, radians
from typing import Any

from msgspec import Struct
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from .text import is_number

_EVIDENCE = re.compile(r" *# (score \d|limits: |stop found by collision |stops: |REVIEW: )")
_CONTINUED = re.compile(r" *#   \S")
_REVIEW = re.compile(r" *# REVIEW: (.*)")
_BESIDE = re.compile(r"(?<=[\w}\]\"'])  # (?:REVIEW: (.*)|as above)$")
"""A REVIEW comment behind a value, or a reference to the one before."""
_STOP = re.compile(r" *# stop found by collision at (.*)")
_POSITION = re.compile(r"(\S+) (deg|rad|mm): (.*?)(?:; a limit may be closer)?$")
_UNITS = {"deg": radians(1.0), "rad": 1.0, "mm": 1e-3}
_NAME = r"\"[^\"]*\"|'[^']*'|[^,}]*"
_ACTUATOR = re.compile(rf"#   (\S.*?): (\{{joint: ({_NAME})(?:, motor: ({_NAME}))?.*?\}})(?:  # REVIEW: (.*))?")
_SCALAR = r"\"(?:[^\"\\]|\\.)*\"|[^\"\s].*?"
_QUESTION = re.compile(rf"  # ({_SCALAR}): ({_SCALAR})  # as drafted; or (.*)")
_FUSED = re.compile(r"  # fused: (.*)")
_FREED = re.compile(rf"  # ({_SCALAR}): (\{{.*\}})(?:  # score (\d.*))?")
_FUSED_HEAD = "  # Fused parts that look movable."
_SCORE = re.compile(r" *# score \d")
_ENTRY = re.compile(r"  (\S.*?):(?: .*)?$")


def above(lines: Sequence[str], entry: int) -> tuple[int, ...]:
    """Indices of the draft's comment lines above an entry, among comments of the user."""
    start = entry
    while start > 0 and lines[start - 1].lstrip(" ").startswith("#"):
        start -= 1
    numbers: list[int] = []
    for at in range(start, entry):
        if _EVIDENCE.match(lines[at]) or (numbers and numbers[-1] == at - 1 and _CONTINUED.match(lines[at])):
            numbers.append(at)
    return tuple(numbers)


def below(lines: Sequence[str], after: int, name: str) -> int:
    """Index behind the alternatives of the draft to a joint, each in a comment from index ``after`` on."""
    alternative = re.compile(rf" *# {re.escape(name)}: \{{.*\}}  # (alternative|a guess), score ")
    while after < len(lines) and alternative.match(lines[after]):
        after += 1
    return after


class DraftedStop(Struct, frozen=True):
    """A stop of a joint that `stepbot init` found by collision."""

    position: float
    """From the drawn pose [rad] or [m]."""
    parts: str
    """The two parts, quoted: ``'base/pad' and 'jaw/pad'``."""


def drafted_reviews(text: str) -> dict[str, str]:
    """The REVIEW comments of each joint and closure that still has its score from the draft; empty without any."""
    return {name: "; ".join(_texts(written, _REVIEW)) for name, written in _drafted(text)}


def reviews(text: str) -> Iterator[tuple[int, str]]:
    """The line, from 1, of each entry with REVIEW comments above or beside it, and what they say."""
    lines, last = text.split("\n"), ""
    for index, line in enumerate(lines):
        if line.strip() and not line.lstrip(" ").startswith("#"):
            beside = [last := match[1] or last for match in _BESIDE.finditer(line)]
            words = [*_texts([lines[at] for at in above(lines, index)], _REVIEW), *beside]
            if any(words):
                yield index + 1, "; ".join(words)


class DraftedActuator(Struct, frozen=True):
    """An actuator that `stepbot init` left in a comment."""

    name: str
    joint: str
    values: str
    """The mapping of the entry, as YAML."""
    models: tuple[str, ...]
    """Motors that it could be; empty if unknown."""
    review: str


def drafted_actuators(text: str) -> tuple[DraftedActuator, ...]:
    """The actuators in comments; what the draft states once of equal motors holds for each."""
    actuators: list[DraftedActuator] = []
    reviews: dict[str, str] = {}
    for entry in filter(None, map(_ACTUATOR.fullmatch, text.split("\n"))):
        name, joint, model = (_unquoted(entry[at]) for at in (1, 3, 4))
        review = reviews.setdefault(model, entry[5] or "")
        listed = review.partition("; one of ")[2]
        models = tuple(listed.split(", ")) if listed else (model,) if model else ()
        actuators.append(DraftedActuator(name, joint, entry[2], models, review))
    return tuple(actuators)


class DraftedQuestion(Struct, frozen=True):
    """A question that `stepbot init` left in comments."""

    name: str
    """By which the sidecar keeps the answer."""
    text: str
    drafted: str
    """The answer that the draft has taken."""
    others: tuple[str, ...]


def drafted_questions(text: str) -> tuple[DraftedQuestion, ...]:
    """The questions in comments: those of `init --interactive` that have no answer yet."""
    questions: list[DraftedQuestion] = []
    words: list[str] = []
    for line in text.split("\n"):
        if (entry := _QUESTION.fullmatch(line)) and words:
            others = tuple(entry[3].split(", "))
            name, drafted = (_scalar(one) for one in (entry[1], entry[2]))
            questions.append(DraftedQuestion(name, " ".join(words), drafted, others))
            words = []
        elif line.startswith("  # "):
            words = [*(words if line.startswith("  #   ") else ()), line[4:].strip()]
        else:
            words = []
    return tuple(questions)


def without_questions(lines: Sequence[str]) -> Sequence[str | None]:
    """A file without its questions, what is above them, and the empty line below if nothing else is there."""
    gone: set[int] = set()
    for at, line in enumerate(lines):
        if line == "# answers:" or line.startswith("# What decides most: "):
            gone.add(at)
        elif _QUESTION.fullmatch(line):
            start = at - 1
            while lines[start].startswith("  #   "):
                start -= 1
            gone.update(range(start, at + 1))
    if gone and not lines[min(gone) - 1] and lines[max(gone) + 1 : max(gone) + 2] == [""]:
        gone.add(max(gone) + 1)
    return [None if at in gone else line for at, line in enumerate(lines)]


def without_actuators(joints: Container[str]) -> "Rewrite":
    """Removes the actuators of some joints from the comments of a file, and what is above them with the last one."""

    def rewrite(lines: Sequence[str]) -> Sequence[str | None]:
        entries = {at: _unquoted(one[3]) for at, line in enumerate(lines) if (one := _ACTUATOR.fullmatch(line))}
        gone = [at for at, joint in entries.items() if joint in joints]
        if entries and len(gone) == len(entries):
            start = gone[0]
            while start > 0 and lines[start - 1].startswith("# "):
                start -= 1
            gone += range(start - (start > 0 and not lines[start - 1]), gone[0])
        return [None if at in gone else line for at, line in enumerate(lines)]

    return rewrite


class DraftedFused(Struct, frozen=True):
    """A part that looks movable and that `stepbot init` drafted as fixed, with the entries in comments that free it."""

    link: str
    parts: tuple[str, ...]
    joint: str
    values: dict[str, Any]
    """Of the joint."""
    held: str
    """Between which parts, and what holds them."""
    score: str
    """Of the joint, with the evidence for it."""


def drafted_fused(text: str) -> tuple[DraftedFused, ...]:
    """The fused parts in comments; one whose entry was changed by hand is not among them."""
    return tuple(one for one, _ in _fused(text.split("\n")))


def without_fused(links: Container[str]) -> "Rewrite":
    """Removes the entries that would free some links from the comments of a file, and with the last one the heads."""

    def rewrite(lines: Sequence[str]) -> Sequence[str | None]:
        entries = list(_fused(lines))
        gone = {at for one, places in entries if one.link in links for at in places}
        if gone and all(one.link in links for one, _ in entries):
            gone |= {at for at, line in enumerate(lines) if line == "# joints:" or line.startswith(_FUSED_HEAD)}
        return [None if at in gone else line for at, line in enumerate(lines)]

    return rewrite


def _fused(lines: Sequence[str]) -> Iterator[tuple[DraftedFused, set[int]]]:
    """Fused parts, and the lines about each: its link, the reason, its joint."""
    entries = {at: match for at, line in enumerate(lines) if (match := _FREED.fullmatch(line))}
    values = {at: _mapping(match[2]) for at, match in entries.items()}
    links = {_scalar(match[1]): at for at, match in entries.items() if set(values[at]) == {"parts"}}
    for start, line in enumerate(lines):
        if not (match := _FUSED.fullmatch(line)):
            continue
        at, held = start + 1, match[1]
        while at < len(lines) and _CONTINUED.match(lines[at]):
            held += f" {lines[at].lstrip(' #')}"
            at += 1
        joint = values.get(at, {})
        link = str(joint.get("child"))
        if link in links and entries[at][3]:
            parts = values[links[link]]["parts"]
            fused = DraftedFused(link, tuple(parts), _scalar(entries[at][1]), joint, held, entries[at][3])
            yield fused, {links[link], *range(start, at + 1)}


def _mapping(text: str) -> dict[str, Any]:
    """A mapping of a comment; an empty one for a text that is none."""
    document = _loaded(text)
    return document if isinstance(document, dict) else {}


def _scalar(text: str) -> str:
    """A YAML scalar of a comment; a text that is none as it is."""
    value = _loaded(text)
    return text if value is None else str(value)


def _loaded(text: str) -> Any:
    """The value of YAML on one line; None for what is not YAML."""
    try:
        return YAML(typ="safe", pure=True).load(text)
    except YAMLError:
        return None


def _unquoted(name: str | None) -> str:
    return (name or "").strip("\"'")


def drafted_stops(text: str) -> dict[str, tuple[DraftedStop, ...]]:
    """The stops of each joint that still has its score from the draft, in the order of their comments."""
    return {
        name: tuple(
            DraftedStop(float(match[1]) * _UNITS[match[2]], match[3])
            for stop in _texts(written, _STOP)
            if (match := _POSITION.match(stop)) and is_number(match[1]) and isfinite(float(match[1]))
        )
        for name, written in _drafted(text)
    }


Rewrite = Callable[[Sequence[str]], Sequence[str | None]]
"""Gives the new text of each line of the draft's comments above an entry and of its own; None removes the line."""


def without_reviews(lines: Sequence[str]) -> Sequence[str | None]:
    """Comments without REVIEW."""
    return [line if line is None else _BESIDE.sub("", line) for line in _without(lines, _REVIEW)]


def without_stops(lines: Sequence[str]) -> Sequence[str | None]:
    """Comments without stops."""
    return _without(lines, _STOP)


def mirrored_stops(lines: Sequence[str]) -> Sequence[str | None]:
    """Comments with the stops of an axis in the other direction."""
    return [re.sub(r"^( *# stop found by collision at )(-?)(\S)", _mirrored, line) for line in lines]


def _mirrored(match: re.Match[str]) -> str:
    return f"{match[1]}{'' if match[2] else '-'}{match[3]}"


def _without(lines: Sequence[str], kind: re.Pattern[str]) -> Sequence[str | None]:
    kept: list[str | None] = []
    is_gone = False
    for line in lines:
        is_gone = kind.match(line) is not None or (is_gone and _CONTINUED.match(line) is not None)
        kept.append(None if is_gone else line)
    return kept


def _drafted(text: str) -> Iterator[tuple[str, list[str]]]:
    """Name and comments of each entry that still has its score from the draft."""
    lines = text.split("\n")
    for index, line in enumerate(lines):
        entry = _ENTRY.match(line)
        if entry is None or line.lstrip(" ").startswith("#"):
            continue
        written = [lines[at] for at in above(lines, index)]
        if any(map(_SCORE.match, written)):
            yield entry[1].strip("\"'"), written


def _texts(lines: Sequence[str], kind: re.Pattern[str]) -> list[str]:
    """The texts of comments of one kind, with the lines that continue them."""
    texts: list[str] = []
    is_open = False
    for line in lines:
        if match := kind.match(line):
            texts.append(match[1])
            is_open = True
        elif is_open := is_open and _CONTINUED.match(line) is not None:
            texts[-1] += f" {line.lstrip(' #')}"
    return texts
