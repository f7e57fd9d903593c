"""Roles that part names indicate: words in a dozen languages, standards, catalogue numbers (``vocabulary.toml``).

A name is a hint, not proof: a pin may be a header, a shaft an arm. Results that rest on a name alone are marked for
review.
"""

import re
import tomllib
import unicodedata
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

from stepbot.step.structure.naming import is_machine_made


class Role(StrEnum):
    """The purpose of a part; words are matched in this order."""

    SEAL = "seal"
    BEARING = "bearing"
    HORN = "horn"
    """A part turned by a motor: horn, idler, rotor, output flange."""
    FASTENER = "fastener"
    WHEEL = "wheel"
    ELECTRIC = "electric"
    MOTOR = "motor"
    JAW = "jaw"
    GEAR = "gear"
    SLIDE = "slide"
    BEAM = "beam"
    """An extruded profile with slots, that frames are screwed together of."""
    PIN = "pin"
    BASE = "base"


SMALL_PARTS = frozenset({Role.FASTENER, Role.SEAL})
"""Roles of parts that move with their host and form no joint."""

_STANDARDS = (
    ("iso", r"(?:din|en|iso|din[\s_\-]*en[\s_\-]*iso|nf[\s_\-]*en)[\s_\-]*(?:{})(?!\d)"),
    ("gb", r"gb[\s_/\-]*t?[\s_\-]*(?:{})(?!\d)"),
    ("jis", r"jis[\s_\-]*b[\s_\-]*(?:{})(?!\d)"),
)
_METRIC = re.compile(
    r"(?<![a-z\d.])m\d+(?:[.,_]\d+)?[\s_]*[x×*\-][\s_]*\d+"
    r"|(?:^|[\s_])m\d{1,2}(?:[.,]5)?[\s_\-]+(?:hex|nut|bolt|screw|washer|socket|cap|flat)",
    re.IGNORECASE,
)
_CATALOGUE = re.compile(r"(?:^|[\s_])9\d{4}a\d{3}", re.IGNORECASE)
"""Fasteners of McMaster-Carr: 91290A115."""
_SOLID_OF_MOTOR = re.compile(r"dummy|dc\d{2}_a", re.IGNORECASE)
"""Robotis names the solids of its motors DC15_A01_CASE_M_DUMMY."""
_CJK = re.compile(r"[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7af]")
_VERSION = re.compile(r" v\d+(?=(?::\d+)?$)")
_COUNTER = re.compile(r":\d+$")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_MOJIBAKE = re.compile(r"[\x80-\x9f\ufffd]|\?\?|[ÃÂÐÑ][\u0080-\u00bf]")
"""Bytes of one code page read as another, or lost."""
_LATIN = str.maketrans(
    {"ß": "ss", "ø": "o", "Ø": "O", "ł": "l", "Ł": "L", "đ": "d", "æ": "ae", "Æ": "Ae", "œ": "oe", "ı": "i", "µ": "u"}
)
"""Latin letters that do not decompose."""
_SPOKEN = 3
"""Number of ASCII letters from which the rest of a name in another script is a name."""


def is_spoken(name: str) -> bool:
    """Whether the name was given by a person or a catalogue, as part numbers are."""
    return name.isdecimal() or not is_machine_made(name)


def plain(name: str) -> str:
    """A name normalized for matching: composed, words separated, without the version and counter that CAD appends."""
    name = _VERSION.sub("", unicodedata.normalize("NFC", _encoded_once(name)))
    return _CAMEL.sub(" ", _COUNTER.sub("", name))


def _encoded_once(name: str) -> str:
    """A name that was written as UTF-8 twice, as exporters without wide characters do, read as it was meant."""
    if name.isascii():
        return name
    try:
        return name.encode("latin-1").decode("utf-8")
    except UnicodeError:
        return name


def portable(name: str) -> str:
    """A name in ASCII letters, digits and ``_``: without accents, by its role in another script; may be empty."""
    text = plain(name).strip()
    if _MOJIBAKE.search(text):
        text = re.sub(r"[^ -~]|\?", "_", text)
    text = text.translate(_LATIN)
    kept = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    if any(c.isalpha() and not c.isascii() for c in kept):
        role = next((role.value for role in roles(name) if role not in SMALL_PARTS), "")
        if role or len(re.findall(r"[A-Za-z]", kept)) < _SPOKEN:
            return role
    return re.sub(r"[^A-Za-z0-9]+", "_", kept).strip("_")


@cache
def roles(name: str) -> tuple[Role, ...]:
    """All roles that a name indicates, those from a standard first."""
    text = plain(name)
    patterns = _patterns()
    matching = [role for role, pattern in patterns.standards if pattern.search(text)]
    matching += [role for role, pattern in patterns.words if pattern.search(text)]
    if Role.MOTOR in matching and patterns.mount.search(text) and not _SOLID_OF_MOTOR.search(text):
        matching.remove(Role.MOTOR)
    if Role.WHEEL in matching and patterns.held.search(text):
        matching.remove(Role.WHEEL)
    if Role.BASE in matching and patterns.carried.search(text):
        matching.remove(Role.BASE)
    if Role.FASTENER in matching and is_drive(name):
        matching = [Role.SLIDE if role == Role.FASTENER else role for role in matching]
    return tuple(dict.fromkeys(matching))


def is_belt(name: str) -> bool:
    """Whether a name is that of a belt, and not of a pulley for one."""
    text, patterns = plain(name), _patterns()
    return bool(patterns.belt.search(text)) and not patterns.pulley.search(text)


def is_drive(name: str) -> bool:
    """Whether a name is that of a drive screw or its nut."""
    return bool(_patterns().drive.search(plain(name)))


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
        self.belt, self.pulley = (_whole_words(table[Role.GEAR][key]) for key in ("belt", "pulley"))
        self.held = _whole_words(table[Role.WHEEL]["held"])
        self.carried = _whole_words(table[Role.BASE]["carried"])
        self.drive = _whole_words(table[Role.SLIDE]["drive"])


@cache
def _patterns() -> _Patterns:
    return _Patterns()


def _whole_words(words: list[str]) -> re.Pattern[str]:
    """A pattern that matches words: a CJK word anywhere, others at word boundaries."""
    either = "|".join(words)
    anywhere = "|".join(word for word in words if _CJK.search(word)) or r"(?!)"
    begins, ends = r"(?:(?<![^\W\d_])|(?<=[_\W])|(?<=\d))", r"(?:(?![^\W\d_])|(?=[_\W\d]))"
    return re.compile(rf"{begins}(?:{either}){ends}|(?:{anywhere})", re.IGNORECASE)
