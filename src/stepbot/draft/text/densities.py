"""Typical densities of materials by their names in CAD programs (``densities.toml``)."""

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

_COATING = re.compile(r"\b[\w-]+[ -](plated|coated|clad|galvani[sz]ed|painted|verzinkt)\b")
"""A material that is only on the surface of another one: copper-plated steel."""
_SEPARATORS = re.compile(r"[_/(),;:]+|(?<=\w)\.(?=\s|$)")


class TypicalDensity(NamedTuple):
    """A density and the material that it is typical of."""

    density: float
    """[kg/m^3]."""
    material: str


def typical_density(material: str) -> TypicalDensity | None:
    """The typical density of a material by its name: that of the longest known word in it; None without one."""
    name = " ".join(_SEPARATORS.sub(" ", material.casefold()).split())
    for text in (_COATING.sub(" ", name), name):
        for patterns in _vocabulary():
            matches = [(len(match[0]), typical) for pattern, typical in patterns for match in pattern.finditer(text)]
            if matches:
                return max(matches, key=lambda one: one[0])[1]
    return None


def typical_densities() -> dict[str, float]:
    """The typical density [kg/m^3] of each material."""
    return {name: float(entry["density"]) for name, entry in _entries().items()}


@cache
def _entries() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("densities.toml").read_text(encoding="utf-8"))


@cache
def _vocabulary() -> tuple[tuple[tuple[re.Pattern[str], TypicalDensity], ...], ...]:
    """Patterns of words, and of numbers that other materials have as well."""
    return tuple(
        tuple(
            (re.compile(rf"(?<![^\W_])(?:{pattern})(?![^\W_])"), TypicalDensity(float(entry["density"]), name))
            for name, entry in _entries().items()
            for pattern in entry.get(key, ())
        )
        for key in ("words", "numbers")
    )
