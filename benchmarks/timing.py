"""The cost of one run of a command: elapsed time, processor time and memory of all its processes."""

import ctypes
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from msgspec import Struct

_PR_SET_CHILD_SUBREAPER = 36
"""Linux, ``prctl(2)``."""
_SIZE = re.compile(r"^(\w+): +(\d+) kB$", re.MULTILINE)
"""A line of ``/proc/PID/smaps_rollup``."""
_BETWEEN_SAMPLES = 0.02
"""Sampling interval [s] of the memory of a process tree."""


class Cost(Struct, frozen=True):
    """The cost of a run."""

    wall: float
    """[s]."""
    cpu: float
    """User and system time [s] of the command and of all its processes; on macOS of those that were waited for."""


class CommandFailed(Exception):
    """A timed command failed; the message ends with its output."""


def timed(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Cost:
    """Run a command in a folder and measure its times.

    Raises:
        CommandFailed: Its exit code is not 0.
    """
    with tempfile.TemporaryFile() as output, _adopted_orphans():
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=output, stderr=output, process_group=0)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        cpu = usage.ru_utime + usage.ru_stime + _time_of_orphans(process.pid)
        process.returncode = os.waitstatus_to_exitcode(status)
        _check(command, process.returncode, output)
    return Cost(wall, cpu)


@contextmanager
def _adopted_orphans() -> Iterator[None]:
    """Within it, processes below this one whose parent ends become its children, so that their time is counted."""
    if sys.platform != "linux":
        yield
        return
    prctl = ctypes.CDLL(None).prctl
    prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        yield
    finally:
        prctl(_PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)


def _time_of_orphans(group: int) -> float:
    """User and system time [s] of the processes that a command left to this one; waits for their end."""
    total = 0.0
    while True:
        try:
            _, _, usage = os.wait4(-group, 0)
        except ChildProcessError:
            return total
        total += usage.ru_utime + usage.ru_stime


def peak_memory(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> float:
    """Peak memory [MiB] of a command and its processes, as if nothing else ran; on Linux.

    Pages that its processes share count once, unlike in a sum of resident set sizes, and pages of libraries that other
    programs have loaded count as a whole, unlike in proportional set sizes.

    Raises:
        CommandFailed: Its exit code is not 0.
    """
    return max(memory for _, memory in memory_samples(command, folder, environment))


def memory_samples(
    command: Sequence[str], folder: Path, environment: Mapping[str, str], between: float = _BETWEEN_SAMPLES
) -> list[tuple[float, float]]:
    """Elapsed times [s], and the memory [MiB] of a command and its processes then, as :func:`peak_memory` counts it.

    Raises:
        CommandFailed: Its exit code is not 0.
    """
    samples = [(0.0, 0.0)]
    with tempfile.TemporaryFile() as output:
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=output, stderr=output)
        while process.poll() is None:
            samples.append((time.perf_counter() - start, _memory(_tree(process.pid)) / 1024.0))
            time.sleep(between)
        _check(command, process.returncode, output)
    return samples


def _check(command: Sequence[str], code: int, output: "tempfile._TemporaryFileWrapper[bytes]") -> None:
    if code:
        output.seek(0)
        raise CommandFailed(
            f"{' '.join(command)}: exit code {code}\n{output.read()[-2000:].decode('utf-8', 'replace')}"
        )


def _tree(pid: int) -> list[int]:
    """A process and its running descendants."""
    found, left = [], [pid]
    while left:
        found.append(left.pop())
        try:
            for thread in Path(f"/proc/{found[-1]}/task").iterdir():
                left += map(int, (thread / "children").read_text().split())
        except OSError:  # it has ended meanwhile
            continue
    return found


def _memory(pids: Iterable[int]) -> int:
    """[KiB] of processes: their own pages, those of forks shared out, and the files of the one that maps most."""
    own, mapped = 0, [0]
    for pid in pids:
        try:
            rollup = Path(f"/proc/{pid}/smaps_rollup").read_text()
        except OSError:  # it has ended meanwhile
            continue
        sizes = {name: int(size) for name, size in _SIZE.findall(rollup)}
        own += sizes["Pss_Anon"] + sizes["Pss_Shmem"]
        mapped.append(sizes["Rss"] - sizes["Anonymous"])
    return own + max(mapped)
