"""What a name hints that a part is: words in a dozen languages, standards, catalogue numbers (``vocabulary.toml``).

A name is a hint, never proof: a pin may be a header, a shaft an arm. What rests on a name alone is marked for review.
"""

import re
import tomllib
import unicodedata
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any


class Role(StrEnum):
    """What a part is for; words are sought in this order."""

    SEAL = "seal"
    BEARING = "bearing"
    HORN = "horn"
    """What a motor turns: horn, idler, rotor, output flange."""
    FASTENER = "fastener"
    WHEEL = "wheel"
    ELECTRIC = "electric"
    MOTOR = "motor"
    JAW = "jaw"
    GEAR = "gear"
    SLIDE = "slide"
    PIN = "pin"
    BASE = "base"


SMALL_PARTS = frozenset({Role.FASTENER, Role.SEAL})
"""Roles of parts that go with what holds them and make no joint."""

_STANDARDS = (
    ("iso", r"(?:din|en|iso|din[\s_\-]*en[\s_\-]*iso|nf[\s_\-]*en)[\s_\-]*(?:{})(?!\d)"),
    ("gb", r"gb[\s_/\-]*t?[\s_\-]*(?:{})(?!\d)"),
    ("jis", r"jis[\s_\-]*b[\s_\-]*(?:{})(?!\d)"),
)
_METRIC = re.compile(
    r"(?:^|[\s_\-(])m\d+(?:[.,_]\d+)?[\s_]*[x×*\-][\s_]*\d+"
    r"|(?:^|[\s_])m\d{1,2}(?:[.,]5)?[\s_\-]+(?:hex|nut|bolt|screw|washer|socket|cap|flat)",
    re.IGNORECASE,
)
_CATALOGUE = re.compile(r"(?:^|[\s_])9\d{4}a\d{3}", re.IGNORECASE)
"""Fasteners of McMaster-Carr: 91290A115."""
_SOLID_OF_MOTOR = re.compile(r"dummy|dc\d{2}_a", re.IGNORECASE)
"""Robotis calls the solids of its motors DC15_A01_CASE_M_DUMMY."""
_CJK = re.compile(r"[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7af]")
_VERSION = re.compile(r" v\d+(?=(?::\d+)?$)")
_COUNTER = re.compile(r":\d+$")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_MACHINE_MADE = "=>"
"""How names begin that the CAD's exporter made up."""


def is_spoken(name: str) -> bool:
    """Whether a person or a catalogue gave a name."""
    return bool(name) and not name.startswith(_MACHINE_MADE)


def plain(name: str) -> str:
    """A name ready to be searched: composed, words apart, without the version and the counter that CAD appends."""
    name = _VERSION.sub("", unicodedata.normalize("NFC", name))
    return _CAMEL.sub(" ", _COUNTER.sub("", name))


@cache
def roles(name: str) -> tuple[Role, ...]:
    """All roles that a name hints at, those by a standard first."""
    text = plain(name)
    patterns = _patterns()
    found = [role for role, pattern in patterns.standards if pattern.search(text)]
    found += [role for role, pattern in patterns.words if pattern.search(text)]
    if Role.MOTOR in found and patterns.mount.search(text) and not _SOLID_OF_MOTOR.search(text):
        found.remove(Role.MOTOR)
    return tuple(dict.fromkeys(found))


class _Patterns:
    """The vocabulary, compiled."""

    def __init__(self) -> None:
        path = Path(__file__).with_name("vocabulary.toml")
        table: dict[str, dict[str, list[Any]]] = tomllib.loads(path.read_text(encoding="utf-8"))
        self.standards: list[tuple[Role, re.Pattern[str]]] = [
            (Role(role), _whole_words([form.format("|".join(map(str, entry[key])))]))
            for role, entry in table.items()
            for key, form in _STANDARDS
            if key in entry
        ]
        self.standards += [(Role.FASTENER, _METRIC), (Role.FASTENER, _CATALOGUE)]
        self.words = [(role, _whole_words(table[role]["words"])) for role in Role]
        self.mount = _whole_words(table[Role.MOTOR]["mount"])


@cache
def _patterns() -> _Patterns:
    return _Patterns()


def _whole_words(words: list[str]) -> re.Pattern[str]:
    """A pattern that finds words: a CJK word anywhere, others where they begin and end one."""
    either = "|".join(words)
    anywhere = "|".join(word for word in words if _CJK.search(word)) or r"(?!)"
    begins, ends = r"(?:(?<![^\W\d_])|(?<=[_\W])|(?<=\d))", r"(?:(?![^\W\d_])|(?=[_\W\d]))"
    return re.compile(rf"{begins}(?:{either}){ends}|(?:{anywhere})", re.IGNORECASE)
