"""The table of diagnostic codes, one module per range.

SB0xx files and environment, SB1xx sidecar syntax and schema, SB2xx STEP, SB3xx component paths, SB4xx kinematics,
SB5xx mass and inertia, SB6xx meshes, SB7xx format limitations, SB8xx verification in engines, SB9xx internal errors.
A code is never reused; ``renamed.py`` has those of earlier versions.
"""

from bisect import bisect
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from importlib import import_module
from typing import cast

from .code import Code, Severity
from .renamed import RENAMED

_RANGES = {
    "SB0": "environment",
    "SB1": "sidecar",
    "SB2": "assembly",
    "SB3": "binding",
    "SB4": "kinematics",
    "SB5": "mass",
    "SB6": "meshes",
    "SB7": "formats",
    "SB8": "simulators",
    "SB9": "environment",
}
"""The module of each range, by the start of its first code, in order; a range ends where the next one starts."""


class _Codes(Mapping[str, Code]):
    """All codes. Their texts take about 100 kB: looking up a code imports those of its range."""

    def __getitem__(self, code: str) -> Code:
        index = bisect(self._starts, code)
        if not index:
            raise KeyError(code)
        name, _, feature = code.partition(":")
        found = _codes_of(_RANGES[self._starts[index - 1]])[name]
        if code != name and feature not in found.features.split():
            raise KeyError(code)
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._codes)

    def __len__(self) -> int:
        return len(self._codes)

    _starts = tuple(_RANGES)

    @cached_property
    def _codes(self) -> dict[str, Code]:
        return {name: code for module in dict.fromkeys(_RANGES.values()) for name, code in _codes_of(module).items()}


@cache
def _codes_of(module: str) -> Mapping[str, Code]:
    """The codes of one module."""
    codes = cast(tuple[Code, ...], import_module(f"{__name__}.{module}").CODES)
    return {code.id: code for code in codes}


CODES: Mapping[str, Code] = _Codes()


def current(code: str) -> tuple[str, ...]:
    """The codes that a code stands for: itself, or those that took the place of an earlier version's; none if unknown."""
    return (code,) if code in CODES else tuple(RENAMED.get(code, "").split())


def selects(code: str, other: str) -> bool:
    """Whether a code, as a user gives it, stands for a diagnostic's code: without a feature, for all its features."""
    return any(other == one or other.startswith(f"{one}:") for one in current(code))


__all__ = ["CODES", "RENAMED", "Severity", "current", "selects"]
