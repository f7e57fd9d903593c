"""The drive tests of a robot: run on the files that were written, shown on its page, drawn in drive.svg.

Limits of a robot's own are in its expected.json. A comment in drive.svg has the hash of its inputs, by which an
outdated picture is found.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from . import fingerprints

if TYPE_CHECKING:
    from stepbot.diagnostics import Diagnostics
    from stepbot.driving.driving import Driven
    from stepbot.driving.judgement import Verdict

PICTURE = "drive.svg"
_LIMITS = "expected.json"
_MADE_FROM = re.compile(r"<!-- made from ([0-9a-f]+) -->")
_SMALLEST = 1e-4
"""Smallest number shown: less is rounding, which differs between processors."""
_SECONDS = 1800.0
"""Time limit [s] of each engine: several robots are made at the same time."""


def driven(folder: Path, output: Path) -> "tuple[Diagnostics, Driven | None]":
    """Drive the files in a robot's output folder, by the limits of the robot."""
    from stepbot.diagnostics import Diagnostics
    from stepbot.driving.plan import ENGINES
    from stepbot.pipeline.driving import DriveOptions, drive
    from stepbot.pipeline.stages import Options

    diagnostics = Diagnostics()
    chosen = DriveOptions(engines=tuple(ENGINES), limits=folder / _LIMITS)
    return diagnostics, drive(output, Options(output, timeout=_SECONDS), chosen, diagnostics)


def section(driven: "Driven") -> list[str]:
    """The section on drive tests of a robot's page."""
    lines = ["## Drive tests", "", f"![Curves of the drive tests]({PICTURE})", ""]
    lines += ["| test | engine | result | numbers, and their limits |", "| --- | --- | --- | --- |"]
    lines += [f"| {v.test} | {v.engine} | {v.status.value} | {_numbers(v)} |" for v in driven.verdicts]
    lines += ["", *(f"- {test}: does not apply, {reason}" for test, reason in driven.inapplicable.items()), ""]
    return lines


def _numbers(verdict: "Verdict") -> str:
    from stepbot.driving.limits import UNITS

    if verdict.result is None:
        return verdict.why
    words = []
    for one in verdict.result.measures:
        place = f" of {one.where}" if one.where else ""
        limit = (verdict.bounds or {}).get(one.quantity)
        bound = f" (limit {limit:g})" if limit is not None else ""
        value = one.value if one.value >= _SMALLEST else 0.0
        words.append(f"{one.quantity}{place} {value:.3g} {UNITS[one.quantity]}".rstrip() + bound)
    return "; ".join(words)


def draw(driven: "Driven", folder: Path) -> None:
    """Write drive.svg."""
    from stepbot.driving.plots import sheet

    made_from = f"<!-- made from {fingerprints.drives(folder)} -->\n"
    (folder / PICTURE).write_text(sheet(driven).decode() + made_from, encoding="utf-8", newline="\n")


def stale(folder: Path) -> bool:
    """Whether drive.svg is missing, or its inputs have changed."""
    picture = folder / PICTURE
    found = _MADE_FROM.search(picture.read_text(encoding="utf-8")) if picture.is_file() else None
    return found is None or found[1] != fingerprints.drives(folder)
