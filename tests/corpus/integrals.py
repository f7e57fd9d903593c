"""Table of the accuracy of mass properties: ``python -m tests.corpus.integrals FOLDER [FILE...]``.

One row per file: number of solids, of those integrated by the kernel alone, and estimated errors of the others.
"""

import sys
from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import read_assembly

SIMPLE = 1e-9
"""Estimated error of solids that only the kernel integrates."""


def row(step: Path) -> str:
    """The row of one file."""
    assembly = read_assembly(step, ReadOptions(), Diagnostics())
    solids = [body for body in assembly.bodies if body.exact is not None and body.exact_error] if assembly else []
    others = sorted(body.exact_error for body in solids if body.exact_error > SIMPLE)
    middle, largest = (f"{others[at]:.0e}" for at in (len(others) // 2, -1)) if others else ("", "")
    return f"| `{step.name}` | {len(solids)} | {len(solids) - len(others)} | {middle} | {largest} |"


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1])
    sys.stdout.write("| file | solids | by the kernel alone | median error of the others | largest |\n")
    sys.stdout.write("| --- | --: | --: | --: | --: |\n")
    for step in [folder / name for name in sys.argv[2:]] or sorted(folder.glob("*.step")):
        sys.stdout.write(row(step) + "\n")


if __name__ == "__main__":
    main()
