"""What one run of a command costs: time on the wall, processor time of all its processes, memory of all of them."""

import os
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_BETWEEN_SAMPLES = 0.02
"""Seconds between two looks at the memory of a tree of processes."""


@dataclass(frozen=True)
class Cost:
    """What a run cost."""

    wall: float
    """[s]."""
    cpu: float
    """User and system time [s] of the command and of all processes that it started and waited for."""


class CommandFailed(Exception):
    """A command that is to be timed does not work; the message ends with what it printed."""


def timed(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Cost:
    """Run a command in a folder and take its times.

    Raises:
        CommandFailed: Its exit code is not 0.
    """
    with tempfile.TemporaryFile() as told:
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=told, stderr=told)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        _check(command, process.returncode, told)
    return Cost(wall, usage.ru_utime + usage.ru_stime)


def peak_memory(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> float:
    """Most memory [MiB] that a command and its processes held at a time, as proportional set sizes; on Linux.

    Pages that several processes share count once, unlike in a sum of resident set sizes.

    Raises:
        CommandFailed: Its exit code is not 0.
    """
    with tempfile.TemporaryFile() as told:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=told, stderr=told)
        peak = 0.0
        while process.poll() is None:
            peak = max(peak, sum(map(_proportional_set_size, _tree(process.pid))))
            time.sleep(_BETWEEN_SAMPLES)
        _check(command, process.returncode, told)
    return peak / 1024.0


def _check(command: Sequence[str], code: int, told: "tempfile._TemporaryFileWrapper[bytes]") -> None:
    if code:
        told.seek(0)
        raise CommandFailed(f"{' '.join(command)}: exit code {code}\n{told.read()[-2000:].decode('utf-8', 'replace')}")


def _tree(pid: int) -> list[int]:
    """A process and all below it that are still there."""
    found, left = [], [pid]
    while left:
        found.append(left.pop())
        try:
            for thread in Path(f"/proc/{found[-1]}/task").iterdir():
                left += map(int, (thread / "children").read_text().split())
        except OSError:  # it has ended meanwhile
            continue
    return found


def _proportional_set_size(pid: int) -> int:
    """[KiB]; 0 for a process that has ended."""
    try:
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:"))
