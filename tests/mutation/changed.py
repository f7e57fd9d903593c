"""Makes the section of ``docs/mutation.md`` on changed numbers: ``python -m tests.mutation.changed [--of-each N]``."""

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from stepbot.jobs.library import library_robot
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.stages import convert
from stepbot.robot.model import Robot

from .page import CHANGED, PAGE
from .reasons import reason_for_change
from .siblings import FORMATS, Noticed, trials

WANTED = 0.97
"""The share of changes that has to be noticed, in all formats together."""
LIBRARY = ("ur5e", "diff_drive", "2f85", "delta", "quadruped")
"""Robots with drives, sensors, sites, keyframes, mimics, loops and ball joints."""
OF_EACH = 20

_HEAD = """
One number at a time is changed in one of the three files of a robot: one part in a hundred more, or the other sign. The
changes are drawn at random, the same in every run; those within the tolerance of their quantity, and zeros, are not
drawn. `stepbot verify` compares the three files with each other, and the verification of a conversion compares the
changed file with the robot. Engines of the core install and stepbot's own parsers, which share no code with the
writers, read the files. This section is made by `{command}`; robots: {robots}.

| format | changed | noticed by `verify` | noticed by the conversion | wanted |
| --- | --- | --- | --- | --- |
"""
_LOST = """
Changes that nobody notices:

| format | what is changed | not noticed by | how often | why |
| --- | --- | --- | --- | --- |
"""


def library_builds(names: Sequence[str]) -> dict[str, Callable[[], Robot]]:
    """What reads robots of the library."""
    return {name: partial(_build, name) for name in names}


def _build(name: str) -> Robot:
    robot = convert(library_robot(name).sidecar, Options(Path(name), verify=False)).robot
    assert robot is not None
    return robot


def share(found: Sequence[Noticed], by: str) -> float:
    """The share of changes that is noticed ``by_verify`` or ``by_conversion``."""
    return sum(bool(getattr(one, by)) for one in found) / len(found)


def section(found: Sequence[Noticed], command: str) -> str:
    """The section below its heading."""
    robots = ", ".join(f"`{name}`" for name in dict.fromkeys(one.robot for one in found))
    text = _HEAD.format(command=command, robots=robots)
    rows = {name: [one for one in found if one.format == name] for name in FORMATS} | {"all": list(found)}
    for name, of_format in rows.items():
        rates = " | ".join(f"{share(of_format, by):.1%}" for by in ("by_verify", "by_conversion"))
        text += f"| {name} | {len(of_format)} | {rates} | {f'{WANTED:.0%}' if name == 'all' else ''} |\n"
    lost = Counter(
        (one.format, one.change.kind, words)
        for one in found
        for words, noticed in (("`verify`", one.by_verify), ("the conversion", one.by_conversion))
        if not noticed
    )
    text += _LOST if lost else ""
    for (name, kind, words), count in sorted(lost.items(), key=lambda entry: (-entry[1], entry[0])):
        text += f"| {name} | `{kind}` | {words} | {count} | {reason_for_change(name, kind)} |\n"
    return text


def main() -> int:
    """Write the section, and report missed shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--of-each", type=int, default=OF_EACH, metavar="N")
    parser.add_argument("--robots", nargs="+", default=list(LIBRARY), metavar="NAME")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = list(trials(library_builds(given.robots), Path(folder), given.of_each))
    command = f"python -m tests.mutation.changed --of-each {given.of_each} --robots {' '.join(given.robots)}"
    before = PAGE.read_text(encoding="utf-8").partition(CHANGED)[0]
    PAGE.write_text(before + CHANGED + section(found, command), encoding="utf-8", newline="\n")
    missed = [by for by in ("by_verify", "by_conversion") if share(found, by) < WANTED]
    sys.stderr.write("".join(f"missed: {one}\n" for one in missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
