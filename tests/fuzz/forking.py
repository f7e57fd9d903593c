"""Calls a function for many inputs, each in a forked process that costs milliseconds.

The kernel takes a second to load. The server loads it once and forks for every call; the forked process behaves as a
worker of :mod:`stepbot.runtime.worker`: same function, memory limit, answers and failures. On systems that cannot fork
safely, :func:`can_fork` is False and callers use workers instead.
"""

import contextlib
import faulthandler
import importlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any, BinaryIO

from stepbot.runtime import worker as isolation
from stepbot.runtime.processes import can_fork
from stepbot.runtime.worker import OutOfTime, RemoteError, WorkerDied

__all__ = ["ForkServer", "ForkedCall", "can_fork"]

_POLL = 0.002
"""Seconds between two polls of a forked process."""


class ForkServer:
    """A process that has loaded a function and forks for every call of it."""

    def __init__(self, function: str, folder: Path, *, memory_limit: int) -> None:
        """Start the server, which imports at once.

        Args:
            function: ``package.module:function``.
            folder: For the answers of the forked processes.
            memory_limit: Address space [bytes] of each.
        """
        self._folder = folder
        command = [sys.executable, "-m", "tests.fuzz.forking", function, str(folder), str(memory_limit)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=isolation.worker_environment()
        )

    def call(self, *arguments: Any) -> "ForkedCall":
        """A call of the function with these arguments; it starts when its result is requested."""
        return ForkedCall(self, arguments)

    def ask(self, arguments: tuple[Any, ...], timeout: float) -> tuple[bool, int]:
        """Fork, call and wait; returns whether it timed out, and how the forked process ended."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        pickle.dump((arguments, timeout), self._process.stdin, protocol=5)
        self._process.stdin.flush()
        timed_out, status = pickle.load(self._process.stdout)
        return bool(timed_out), int(status)

    def close(self) -> None:
        """End the server."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.kill()
        self._process.wait()
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.stdout.close()

    @property
    def answer(self) -> Path:
        """File for the answer of the forked process."""
        return self._folder / "answer"

    @property
    def printed(self) -> Path:
        """File for the output of the forked process."""
        return self._folder / "printed"


class ForkedCall(isolation.Worker):
    """One call of a server's function, with the answers and failures of a worker."""

    def __init__(self, server: ForkServer, arguments: tuple[Any, ...]) -> None:
        self._server, self._arguments = server, arguments

    def result(self, timeout: float = isolation.DEFAULT_TIMEOUT) -> Any:
        """Wait for the function's result.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
            RemoteError: The function raised.
        """
        timed_out, status = self._server.ask(self._arguments, timeout)
        lines = self._server.printed.read_text(encoding="utf-8", errors="replace").splitlines()
        last_lines = tuple(line.rstrip() for line in lines if line.strip())[-isolation._LAST_LINES :]
        if timed_out:
            raise OutOfTime(timeout, last_lines)
        output = self._server.answer.read_bytes()
        if status != 0 or not output:
            raise WorkerDied(isolation._death(status, last_lines), last_lines)
        outcome, value = pickle.loads(output)
        if outcome == "raised":
            raise RemoteError(*value)
        return value

    def close(self) -> None:
        """Do nothing: the server ends what it forks."""


def _serve(function: str, folder: Path, memory_limit: int) -> None:
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    module, _, name = function.partition(":")
    loaded = getattr(importlib.import_module(module), name)
    while True:
        try:
            arguments, timeout = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        with (folder / "printed").open("wb") as printed, (folder / "answer").open("wb") as answer:
            child = os.fork()
            if child == 0:
                _answer(loaded, arguments, memory_limit, printed, answer)
            outcome = _wait(child, timeout)
        pickle.dump(outcome, replies, protocol=5)
        replies.flush()


def _answer(function: Any, arguments: tuple[Any, ...], memory_limit: int, printed: BinaryIO, answer: BinaryIO) -> None:
    """Run the call in the forked process; never returns."""
    os.setpgid(0, 0)
    os.dup2(printed.fileno(), 1)
    os.dup2(printed.fileno(), 2)
    faulthandler.enable(printed)  # to identify the call in which the kernel dies
    isolation._limit_memory(memory_limit)
    outcome: tuple[str, Any]
    try:
        outcome = ("returned", function(*arguments))
    except MemoryError:
        os.write(2, b"MemoryError\n")
        os._exit(1)
    except Exception as error:  # noqa: BLE001 - it is handed over
        outcome = ("raised", (type(error).__name__, str(error), traceback.format_exc()))
    answer.write(pickle.dumps(outcome, protocol=5))
    answer.flush()
    os._exit(0)


def _wait(child: int, timeout: float) -> tuple[bool, int]:
    """Whether a process had to be ended, and its exit status; its own child processes end with it."""
    with contextlib.suppress(OSError):  # it may have ended already
        os.setpgid(child, child)
    deadline = time.monotonic() + timeout
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        timed_out = not ended and time.monotonic() > deadline
        if timed_out:
            os.killpg(child, signal.SIGKILL)
            _, status = os.waitpid(child, 0)
        if ended or timed_out:
            break
        time.sleep(_POLL)
    with contextlib.suppress(ProcessLookupError):  # no process is left, as expected
        os.killpg(child, signal.SIGKILL)
    return timed_out, os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    tempfile.tempdir = sys.argv[2]  # files of dead forked processes are removed with the folder
    _serve(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
