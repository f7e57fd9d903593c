"""Memory of a batch over its robots: flat if what a robot takes is freed before the next ones."""

import os
import re
from collections.abc import Sequence
from pathlib import Path
from statistics import mean

from stepbot.diagnostics import Diagnostics
from stepbot.jobs.discovery import find_sidecars

from .contenders import STEPBOT
from .named_step import named_step
from .timing import memory_samples

PARTS = 10
"""Number of equal parts of the elapsed time whose peaks are compared."""
_BETWEEN_SAMPLES = 0.2
"""Sampling interval [s]: a batch runs for minutes, and a sample takes milliseconds."""
_ROBOT = re.compile(r"^robot: *([\w.-]+)", re.MULTILINE)
_FIRST_LINE = b"ISO-10303-21;"


def distinct_copies(robots: Path, count: int, folder: Path) -> Path:
    """Copies of robots, in turn, each with other contents: its number in the robot's name and as a comment in the STEP.

    Args:
        robots: A folder or a list of sidecars.
        count: Number of copies in all.
        folder: Receives a folder for each.
    """
    sidecars = find_sidecars([robots], Diagnostics())
    if not sidecars:
        raise SystemExit(f"{robots}: no sidecars found")
    for number in range(count):
        sidecar = sidecars[number % len(sidecars)]
        text = sidecar.read_text(encoding="utf-8")
        step = named_step(text)
        if step is None:
            raise SystemExit(f"{sidecar}: names no STEP")
        content = (sidecar.parent / step).read_bytes()
        if not content.startswith(_FIRST_LINE):
            raise SystemExit(f"{step}: not a plain STEP file")
        place = folder / f"{number:05d}"
        (place / step).parent.mkdir(parents=True)
        (place / step).write_bytes(content.replace(_FIRST_LINE, _FIRST_LINE + b"\n/* %d */" % number, 1))
        renamed = _ROBOT.sub(rf"robot: \g<1>_{number:05d}", text, count=1)
        (place / sidecar.name).write_text(renamed, encoding="utf-8", newline="\n")
    return folder


def batch_memory(robots: Path, output: Path, jobs: int) -> list[tuple[float, float]]:
    """Memory over time of a verified batch without cache: elapsed time [s] and memory [MiB] of all its processes."""
    command = [*STEPBOT, "batch", str(robots), "-o", str(output), "-j", str(jobs), "--no-cache"]
    return memory_samples(command, output.parent, os.environ, _BETWEEN_SAMPLES)


def memory_table(samples: Sequence[tuple[float, float]]) -> str:
    """Mean and peak of each tenth of the elapsed time, as a Markdown table."""
    end = samples[-1][0]
    lines = ["| tenth of the time | until s | mean MiB | peak MiB |", "| --: | --: | --: | --: |"]
    for part in range(PARTS):
        low, high = end * part / PARTS, end * (part + 1) / PARTS
        within = [memory for elapsed, memory in samples if low <= elapsed <= high]
        values = f"{mean(within):.0f} | {max(within):.0f}" if within else "- | -"
        lines.append(f"| {part + 1} | {high:.0f} | {values} |")
    return "\n".join(lines)
