"""The ``stepbot`` command as an observed process: how it ends, what it prints, and what it leaves behind."""

import os
import re
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from msgspec import Struct, field

LONGEST = 120.0
"""Seconds after which a command counts as hung."""
_MARK = "STEPBOT_HOSTILE_TRIAL"
"""Environment variable that identifies the processes of a trial; child processes inherit it."""
_GONE_AFTER = 10.0
"""Seconds within which all processes of a command must end after it."""
_TRACEBACK = re.compile(r"^Traceback \(most recent call last\)", re.MULTILINE)


class Ended(Struct, frozen=True):
    """The end of a command."""

    code: int
    """Exit code; negative for a signal."""
    out: bytes
    err: bytes
    seconds: float
    left: tuple[str, ...]
    """Processes, temporary files and shared memory left behind."""

    @property
    def text(self) -> str:
        """Both streams."""
        return self.out.decode("utf-8", "replace") + self.err.decode("utf-8", "replace")

    def faults(self, codes: Sequence[int] = (0, 1, 2)) -> tuple[str, ...]:
        """Outcomes that are forbidden for any command and input."""
        shown = self.text[-2000:]
        found = [f"left behind: {one}" for one in self.left]
        if self.code not in codes:
            found.append(f"exit code {self.code}\n{shown}")
        if _TRACEBACK.search(self.text) or "SB901" in self.text:
            found.append(f"a traceback, or an internal error\n{shown}")
        if 0 in codes and self.code in (1, 2) and not re.search(r"SB\d\d\d|^Usage|^Error", self.text, re.MULTILINE):
            found.append(f"exit code {self.code} without a diagnostic\n{shown}")
        return tuple(found)


class Running(Struct):
    """A running command."""

    process: "subprocess.Popen[bytes]"
    mark: str
    temporary: Path
    began: float
    shared: frozenset[str] = field(default_factory=frozenset)

    def wait(self) -> Ended:
        """Wait for the command, and look for what it leaves behind; processes that still run are killed."""
        try:
            out, err = self.process.communicate(timeout=LONGEST)
            code, left = self.process.returncode, []
        except subprocess.TimeoutExpired:
            self.process.kill()
            out, err = self.process.communicate()
            code, left = self.process.returncode, [f"itself: hangs for {LONGEST:g} s"]
        seconds = time.monotonic() - self.began
        left += [f"process {one}" for one in _ended(self.mark)]
        left += [f"temporary file {path.name}" for path in self.temporary.rglob("*")]
        left += [f"shared memory {name}" for name in _shared_memory() - self.shared if not _is_open(name)]
        return Ended(code, out, err, seconds, tuple(left))


def start(
    *arguments: str | Path,
    folder: Path,
    temporary: Path,
    environment: Mapping[str, str] | None = None,
    wrapper: Sequence[str] = (),
) -> Running:
    """Start ``stepbot`` in a folder, as the head of a group of processes.

    Args:
        arguments: Its arguments.
        folder: The current folder.
        temporary: Its folder for temporary files, which should be empty.
        environment: Variables to change.
        wrapper: Command that starts it.
    """
    mark = uuid.uuid4().hex
    temporary.mkdir(parents=True, exist_ok=True)
    changed = {"TMPDIR": str(temporary), _MARK: mark, "PYTHONIOENCODING": "utf-8", **(environment or {})}
    before = {name: value for name, value in os.environ.items() if name != "STEPBOT_NO_CACHE"}
    process = subprocess.Popen(
        [*wrapper, sys.executable, "-m", "stepbot_cli", *map(str, arguments)],
        cwd=folder,
        env={**before, **changed},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    return Running(process, mark, temporary, time.monotonic(), _shared_memory())


def stepbot(*arguments: str | Path, folder: Path, temporary: Path, **options: Mapping[str, str]) -> Ended:
    """Run ``stepbot`` to its end; see :func:`start`."""
    return start(*arguments, folder=folder, temporary=temporary, **options).wait()


@contextmanager
def full_disk(folder: Path, size: int) -> Iterator[bool]:
    """Mount a file system of ``size`` bytes at ``folder``; returns False without permission to mount."""
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    try:
        mounted = sys.platform == "linux" and subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        mounted = False
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], capture_output=True, check=True)


def _ended(mark: str) -> list[str]:
    """Kill the processes of a trial that do not end in time, and return them."""
    deadline = time.monotonic() + _GONE_AFTER
    while (alive := _processes(mark)) and time.monotonic() < deadline:
        time.sleep(0.05)
    for pid in alive:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            continue
    return [f"{pid} ({name})" for pid, name in alive.items()]


def _processes(mark: str) -> dict[int, str]:
    """Processes of a trial with their commands; empty if the system has no ``/proc``."""
    wanted, found = f"{_MARK}={mark}".encode(), {}
    for path in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (path / "environ").read_bytes().split(b"\0"):
                found[int(path.name)] = (path / "comm").read_text().strip()
        except OSError:  # the process has ended, or belongs to another user
            continue
    return found


def _shared_memory() -> frozenset[str]:
    folder = Path("/dev/shm")
    return frozenset(path.name for path in folder.iterdir()) if folder.is_dir() else frozenset()


def _is_open(name: str) -> bool:
    """Whether some process has mapped a piece of shared memory, which then is in use, or it is gone.

    It is found by its inode: a semaphore of another process is mapped under the name that it had before ``sem_open``
    renamed it.
    """
    try:
        inode = str((Path("/dev/shm") / name).stat().st_ino)
    except FileNotFoundError:
        return True
    for path in Path("/proc").glob("[0-9]*/maps"):
        try:
            mapped = (line.split(maxsplit=5) for line in path.read_text().splitlines())
            if any(fields[4] == inode and fields[-1].startswith("/dev/shm/") for fields in mapped):
                return True
        except OSError:
            continue
    return False
