"""Makes ``docs/mutation.md``: ``python -m tests.mutation.page [--of-each N]``; needs ``stepbot[verify]``."""

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from tests.robots import ROBOTS

from .reasons import reason_for
from .removal import UNREAD
from .trial import Verdict, verdicts

PAGE = Path(__file__).parents[2] / "docs" / "mutation.md"
CHANGED = "\n## Changed numbers\n"
"""Heading of the section that :mod:`tests.mutation.changed` writes, at the end of the page."""

CORE = {"urdf": ("yourdfpy", "mujoco", "pybullet"), "mjcf": ("mujoco",), "sdf": ("pybullet",)}
"""Engines of the core install, those first that answer soonest. The readers of stepbot's own do not count."""
ALL = {**CORE, "sdf": ("pybullet", "drake"), "drake.sdf": ("drake",)}
"""Drake in addition, where PyBullet noticed nothing."""


@dataclass(frozen=True)
class Row:
    """A format, and who looks at it."""

    title: str
    engines: str
    wanted: float
    """The share that they have to notice."""
    formats: tuple[str, ...]
    core: bool
    """Whether the engines of the core install alone count."""

    def counted(self, found: Sequence[Verdict]) -> list[tuple[Verdict, bool]]:
        """What this row counts, and whether it was noticed."""
        core = [one for one in found if not one.removal.unread and one.format in self.formats]
        return [(one, one.noticed.startswith(CORE[one.format]) if self.core else bool(one.noticed)) for one in core]


ROWS = (
    Row("URDF", "yourdfpy, MuJoCo, PyBullet", 0.97, ("urdf",), True),
    Row("MJCF", "MuJoCo", 0.98, ("mjcf",), True),
    Row("SDFormat", "PyBullet", 0.85, ("sdf",), True),
    Row("SDFormat", "PyBullet, Drake", 0.93, ("sdf", "drake.sdf"), False),
)

_HEAD = """\
# Mutation: what goes unnoticed when it is missing

A proof that cannot fail proves nothing. So elements and attributes are removed, one at a time, from every file that
stepbot writes of the robots in `tests/robots.py`, and engines that are not stepbot's are asked about what is left. A
removal is noticed if an engine refuses the file, dies over it, warns of it, or sees another robot than the one that was
to be written. Nothing is ever compared with the text of a file, and what stepbot's own readers notice does not count.

This page is made by `{command}`, which removes
{what}. Engines: {engines}.

| format | looked at by | removed | noticed | share | wanted |
| --- | --- | --- | --- | --- | --- |
"""
_UNREAD = """
SDFormat that no engine of the core install reads, for its joints, counts with Drake alone: {alone}.

## Blocks that no engine reads

`<ros2_control>`, `<gazebo>` and `<transmission>` in URDF, `<sensor>` and `<plugin>` in SDFormat are for other programs
than engines, and so is `<ambient>`, the colour that Gazebo gives to what lies in the shade and that Drake alone tells.
They are not in the counts above ({counts}); what checks them is `tests/simulators/test_device_blocks.py`,
`tests/simulators/test_wrong_files.py` and `tests/conformance/test_sdformat.py`.
"""
_SURVIVORS = """
## What nobody notices, and why

| format | looked at by | what is missing | how often | why |
| --- | --- | --- | --- | --- |
"""


def unread_by_core(found: Sequence[Verdict]) -> list[str]:
    """Robots whose SDFormat PyBullet does not read at all."""
    return sorted({one.robot for one in found if one.format == "sdf" and "pybullet" not in one.readers})


def counted(row: Row, found: Sequence[Verdict]) -> list[tuple[Verdict, bool]]:
    """The counted removals of a row, without files that none of its engines reads."""
    alone = set(unread_by_core(found)) if row.core and "sdf" in row.formats else set()
    return [(one, seen) for one, seen in row.counted(found) if one.robot not in alone]


def share(row: Row, found: Sequence[Verdict]) -> float:
    """The share of removals that is noticed."""
    seen = [noticed for _, noticed in counted(row, found)]
    return sum(seen) / len(seen)


def page(found: Sequence[Verdict], of_each: int | None) -> str:
    """The page."""
    engines = ", ".join(f"{name} {version(name)}" for name in ("yourdfpy", "mujoco", "pybullet", "drake"))
    command = "python -m tests.mutation.page" + (f" --of-each {of_each}" if of_each else "")
    what = f"{of_each} of each file, drawn at random and the same in every run" if of_each else "all of each file"
    text = _HEAD.format(command=command, what=what, engines=engines)
    for row in ROWS:
        seen = [noticed for _, noticed in counted(row, found)]
        text += f"| {row.title} | {row.engines} | {len(seen)} | {sum(seen)} | {share(row, found):.1%} | "
        text += f"{row.wanted:.0%} |\n"
    unread = Counter(one.format for one in found if one.removal.unread)
    counts = ", ".join(f"{unread[name]} in {name}" for name in UNREAD if unread[name]) or "none"
    alone = ", ".join(f"`{name}`" for name in unread_by_core(found)) or "none"
    text += _UNREAD.format(counts=counts, alone=alone) + _SURVIVORS
    return text + "".join(f"{line}\n" for row in ROWS for line in _survivors(row, found))


def _survivors(row: Row, found: Sequence[Verdict]) -> Iterator[str]:
    lost = Counter((one.format, one.removal.kind) for one, seen in counted(row, found) if not seen)
    for (format_, kind), count in sorted(lost.items(), key=lambda entry: (-entry[1], entry[0])):
        yield f"| {row.title} | {row.engines} | `{kind}` | {count} | {reason_for(format_, kind, core=row.core)} |"


def main() -> int:
    """Write the page, and report missed shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--of-each", type=int, default=None, metavar="N")
    of_each = parser.parse_args().of_each
    with tempfile.TemporaryDirectory() as folder:
        found = list(verdicts(ROBOTS, ALL, Path(folder), of_each))
    _, heading, changed = PAGE.read_text(encoding="utf-8").partition(CHANGED)
    PAGE.write_text(page(found, of_each) + heading + changed, encoding="utf-8", newline="\n")
    missed = [f"{row.title} by {row.engines}" for row in ROWS if share(row, found) < row.wanted]
    sys.stderr.write("".join(f"missed: {one}\n" for one in missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
