"""The table of diagnostic codes, which is the page ``docs/diagnostics.md``: what users read is what the program has.

SB0xx files and environment, SB1xx sidecar syntax and schema, SB2xx STEP, SB3xx component paths, SB4xx kinematics,
SB5xx mass and inertia, SB6xx meshes, SB7xx format limitations, SB8xx verification in engines, SB9xx internal errors.
A code is never reused; the end of the page lists those of earlier versions.
"""

import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple, cast

Severity = Literal["error", "warning", "note"]

_PACKAGE = Path(__file__).resolve().parents[1]
PAGE = next(
    (page for folder in (_PACKAGE, _PACKAGE.parents[1]) if (page := folder / "docs" / "diagnostics.md").is_file()),
    _PACKAGE / "docs" / "diagnostics.md",
)
"""In an installed package, or in a checkout."""
_SECTION = re.compile(
    r"^### (SB\d{3}): (.+)\n\n\*(error|warning|note)(, exit code 2)?\*\n\n(.+)\n\n\*\*Fix\.\*\* (.+)\n"
    r"(?:\n\*\*Features\.\*\* (.+)\n)?",
    re.MULTILINE,
)
_EARLIER = re.compile(r"^\| (SB\d{3}) \| (.+) \|$", re.MULTILINE)
_CODE = re.compile(r"SB\d{3}[\w:-]*")


class Code(NamedTuple):
    """One kind of diagnostic, with the text that ``stepbot explain`` prints."""

    id: str
    """``SB`` and three digits."""
    severity: Severity
    title: str
    """Noun phrase, without a full stop."""
    explanation: str
    """The condition that is reported, and its consequence for the robot or the run."""
    fix: str
    """Remedy."""
    could_not_run: bool = False
    """Whether the run could not start (exit code 2)."""
    features: tuple[str, ...] = ()
    """Words after a colon that tell the diagnostics of the code apart, as in ``SB760:armature``."""


class _Codes(Mapping[str, Code]):
    """All codes; the page is read when the first one is looked up."""

    def __getitem__(self, code: str) -> Code:
        name, _, feature = code.partition(":")
        entry = self._codes[name]
        if code != name and feature not in entry.features:
            raise KeyError(code)
        return entry

    def __iter__(self) -> Iterator[str]:
        return iter(self._codes)

    def __len__(self) -> int:
        return len(self._codes)

    @cached_property
    def page(self) -> str:
        return PAGE.read_text(encoding="utf-8")

    @cached_property
    def _codes(self) -> dict[str, Code]:
        codes = {}
        for name, title, severity, exit_code, explanation, fix, features in _SECTION.findall(self.page):
            words = tuple(re.findall(r"`(.+?)`", features))
            codes[name] = Code(name, cast(Severity, severity), title, explanation, fix, bool(exit_code), words)
        return codes


CODES = _Codes()


def renamed() -> dict[str, tuple[str, ...]]:
    """For each code of earlier versions the codes that took its place, some with a feature; none for one without."""
    return {old: tuple(_CODE.findall(new)) for old, new in _EARLIER.findall(CODES.page)}


def full_code(given: str) -> str:
    """A code of diagnostics in capitals, and with its letters if only the number is given: ``407`` is ``SB407``."""
    name, *feature = given.split(":", 1)
    number = f"SB{name}" if name.isdecimal() and len(name) == 3 else name.upper()
    return ":".join([number, *map(str.lower, feature)])


def current(code: str) -> tuple[str, ...]:
    """The codes that a code stands for: itself, or those in place of an earlier version's; none if unknown."""
    return (code,) if code in CODES else renamed().get(code, ())


def selects(code: str, other: str) -> bool:
    """Whether a code, as a user gives it, stands for a diagnostic's code: without a feature, for all its features."""
    return any(other == one or other.startswith(f"{one}:") for one in current(code))
