"""Runs functions on foreign data in separate processes, so that a crash becomes a diagnostic.

A :class:`Worker` starts at once and imports the module of its function while the caller is still busy; ``submit`` sends
the arguments, ``result`` waits; then another call may follow. Output of native code to file descriptor 1 is redirected
to the worker's standard error, so that it cannot corrupt the result. Arguments and results are pickled: data classes
and arrays only.
"""

import contextlib
import gc
import importlib
import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import IO, Any, BinaryIO, NamedTuple, NoReturn, Protocol

from .memory import DEFAULT_TIMEOUT, is_out_of_memory
from .processes import end_with_parent, interpreter, start_process, worker_environment

_LAST_LINES = 12
_LENGTH = struct.Struct("<q")
"""Marks the start of an outcome."""


class WorkerDied(Exception):
    """A worker ended without a result.

    Attributes:
        reason: Signal, exit code, timeout or out of memory.
        last_lines: The last lines of its output.
    """

    def __init__(self, reason: str, last_lines: tuple[str, ...]) -> None:
        self.reason, self.last_lines = reason, last_lines
        super().__init__(reason)


class OutOfTime(WorkerDied):
    """A worker was stopped because it had no result in time."""

    def __init__(self, seconds: float, last_lines: tuple[str, ...]) -> None:
        super().__init__(f"no result after {seconds:g} s", last_lines)


class RemoteError(Exception):
    """The function raised an exception in the worker.

    Attributes:
        kind: Name of the exception's type.
        text: Its message.
        trace: The traceback in the worker.
    """

    def __init__(self, kind: str, text: str, trace: str) -> None:
        self.kind, self.text, self.trace = kind, text, trace
        super().__init__(f"{kind}: {text}\n{trace}")


class Process(Protocol):
    """The process interface that a worker needs: a part of :class:`subprocess.Popen`."""

    @property
    def pid(self) -> int: ...  # noqa: D102

    @property
    def stdin(self) -> IO[bytes] | None: ...  # noqa: D102

    @property
    def stdout(self) -> IO[bytes] | None: ...  # noqa: D102

    def poll(self) -> int | None: ...  # noqa: D102

    def wait(self) -> int: ...  # noqa: D102

    def kill(self) -> None: ...  # noqa: D102


Start = Callable[[str, int | None, BinaryIO], Process]
"""Starts a process for a function, with a memory limit [bytes] or None, and a file for its output."""


class Worker:
    """A process that calls one function, once or repeatedly."""

    def __init__(self, function: str, *, memory_limit: int | None = None, start: Start | None = None) -> None:
        """Start the process, which begins to import at once.

        Args:
            function: ``package.module:function``.
            memory_limit: Address space [bytes] if the system can limit it (POSIX); None for no limit.
            start: Starts the process; None for the one set by :func:`started_by`, or a new interpreter.
        """
        self._stderr: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the worker
        self._process = (start or _starts[-1])(function, memory_limit, self._stderr)
        self._writer: threading.Thread | None = None
        self._more = False

    @property
    def pid(self) -> int:
        """The worker's process id."""
        return self._process.pid

    def submit(self, *arguments: Any, more: bool = False) -> "Worker":
        """Send the arguments of a call; returns at once.

        Args:
            arguments: Arguments of the function.
            more: Whether another call may follow; if not, the process ends after its result.
        """
        self._more = more
        payload = pickle.dumps((arguments, more), protocol=5)
        self._writer = threading.Thread(target=self._feed, args=(payload,), daemon=True)
        self._writer.start()
        return self

    def result(self, timeout: float = DEFAULT_TIMEOUT) -> Any:
        """Wait for the function's result.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
            RemoteError: The function raised.
        """
        timed_out = threading.Event()

        def end() -> None:
            timed_out.set()
            self._process.kill()

        timer = threading.Timer(timeout, end)
        timer.daemon = True
        timer.start()
        try:
            output = self._answer()
            status = self._process.wait() if output is None else 0
        except BaseException:  # Ctrl-C: the process is no longer needed
            self.close()
            raise
        finally:
            timer.cancel()
        if self._writer is not None:
            self._writer.join()
        if output is None:
            last_lines = self._last_lines()
            self.close()
            raise (
                OutOfTime(timeout, last_lines)
                if timed_out.is_set()
                else WorkerDied(_death(status, last_lines), last_lines)
            )
        outcome, value = pickle.loads(output)
        if not self._more:
            self.close()
        if outcome == "raised":
            raise RemoteError(*value)
        return value

    def kill(self) -> None:
        """End the process, from any thread: :meth:`result` raises WorkerDied where it waits."""
        self._process.kill()

    def close(self) -> None:
        """End the process if it still runs; safe to call twice."""
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        for stream in (self._process.stdin, self._process.stdout, self._stderr):
            if stream is not None and not stream.closed:
                try:
                    stream.close()
                except BrokenPipeError:  # the worker died before it read its input: `result` reports that
                    continue

    def __enter__(self) -> "Worker":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _feed(self, payload: bytes) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(payload)
            self._process.stdin.flush()
        except (OSError, ValueError):  # the worker has ended, or was closed: `result` reports how it ended
            return

    def _answer(self) -> bytes | None:
        """The pickled outcome of the call; None if the process ended before writing it."""
        assert self._process.stdout is not None
        head = self._process.stdout.read(_LENGTH.size)
        if len(head) < _LENGTH.size:
            return None
        length = _LENGTH.unpack(head)[0]
        output = self._process.stdout.read(length)
        return output if len(output) == length else None

    def _last_lines(self) -> tuple[str, ...]:
        self._stderr.seek(0)
        text = self._stderr.read().decode("utf-8", "replace")
        return tuple(line.rstrip() for line in text.splitlines() if line.strip())[-_LAST_LINES:]


class Workers(NamedTuple):
    """How functions run in workers of their own."""

    timeout: float = DEFAULT_TIMEOUT
    """Time limit [s] of each call."""
    memory_limit: int | None = None
    """Address space [bytes] of each; None for no limit."""
    start: Start | None = None
    """Starts them; None for the one set by :func:`started_by`, or a new interpreter."""

    def call(self, function: str, *arguments: Any) -> Any:
        """Call ``package.module:function``; raises what :meth:`Worker.result` does."""
        with Worker(function, memory_limit=self.memory_limit, start=self.start) as worker:
            return worker.submit(*arguments).result(self.timeout)


DEFAULT_WORKERS = Workers()


def spawned(function: str, memory_limit: int | None, stderr: BinaryIO) -> Process:
    """Start a worker's process as a new interpreter; see :data:`Start`."""
    command = worker_command(function, memory_limit)
    return start_process(
        lambda: subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=stderr, env=worker_environment()
        )
    )


_starts: list[Start] = [spawned]
"""How workers start for which nothing else is requested: the last one counts."""


@contextmanager
def started_by(start: Start) -> Iterator[None]:
    """Within it, in all threads, ``start`` starts the workers for which nothing else is requested."""
    _starts.append(start)
    try:
        yield
    finally:
        del _starts[max(number for number, one in enumerate(_starts) if one == start)]  # it may be further out, too


def are_spawned() -> bool:
    """Whether workers for which nothing else is requested are new interpreters."""
    return _starts[-1] is spawned


def worker_command(function: str, memory_limit: int | None) -> list[str]:
    """Command line of a worker that is a separate interpreter and a child of this process."""
    command = interpreter("from stepbot.runtime.worker import _serve; _serve()", str(os.getpid()), function)
    return command if memory_limit is None else [*command, str(memory_limit)]


def _death(status: int, last_lines: tuple[str, ...]) -> str:
    if any("MemoryError" in line or "bad_alloc" in line for line in last_lines):
        return "out of memory"
    if status < 0:
        return f"killed by {signal_name(-status)}"
    return f"ended with exit code {status} and no result"


def signal_name(number: int) -> str:
    """``SIGSEGV``, or ``signal 64`` for one without a name."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _serve() -> NoReturn:
    """The main function of a worker in its own interpreter."""
    end_with_parent(int(sys.argv[1]))
    answer(sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else None)


def answer(function: str, memory_limit: int | None) -> NoReturn:
    """Serve calls in this process, then end it: import, read the arguments, call, write the outcome.

    Args:
        function: ``package.module:function``.
        memory_limit: Address space [bytes]; None for no limit.
    """
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # native code that prints to standard output must not corrupt the result
    sys.stdout = sys.stderr
    if memory_limit is not None:
        _limit_memory(memory_limit)
    more = True
    while more:
        more = False
        outcome: tuple[str, Any]
        try:
            call = _prepared(function)
            arguments, more = _next_call()
            outcome = ("returned", call(*arguments))
        except SystemExit as end:  # as Drake's bindings raise it, with the message of a failed assertion
            sys.stderr.write(f"{end}\n")
            sys.exit(1)
        except Exception as error:  # noqa: BLE001 - raised again by the caller, as a RemoteError
            if is_out_of_memory(error):
                sys.stderr.write("MemoryError\n")
                sys.exit(1)
            outcome = ("raised", (type(error).__name__, str(error), traceback.format_exc()))
        payload = pickle.dumps(outcome, protocol=5)
        results.write(_LENGTH.pack(len(payload)))
        results.write(payload)
        results.flush()
    # Engines and the kernel may crash during teardown: the result is written, so exit at once.
    os._exit(0)


def _next_call() -> tuple[tuple[Any, ...], bool]:
    """Arguments of the next call, and whether another may follow; does not return if the caller has exited."""
    try:
        arguments, more = pickle.load(sys.stdin.buffer)
    except EOFError:
        os._exit(0)
    return arguments, more


@cache
def _prepared(function: str) -> Callable[..., Any]:
    """The function, after importing its module and preparing it while the caller is still busy."""
    gc.disable()  # imported objects stay alive: exclude them from garbage collection
    module, _, name = function.partition(":")
    loaded = importlib.import_module(module)
    call: Callable[..., Any] = getattr(loaded, name)
    getattr(loaded, "prepare", lambda: None)()
    gc.freeze()
    gc.enable()
    return call


def _limit_memory(limit: int) -> None:
    try:
        import resource
    except ImportError:  # Windows: no such limit; the timeout still applies
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    allowed = limit if most == resource.RLIM_INFINITY else min(limit, most)
    # macOS rejects limits of address space; the timeout still applies.
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (allowed, most))
