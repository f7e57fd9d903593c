"""Runs one function over many inputs in forked processes, on all cores; a crash costs only one input.

A forked process shares what its parent has read; only numbers of inputs are sent to it. Each process takes the next
number from a pipe, reports it, and writes its results to a file of its own; if it dies, or is stopped because of the
time limit, the parent has the input. Without fork, the function runs in this process, and an
:class:`Attempt` continues after a crash.
"""

import contextlib
import ctypes
import faulthandler
import os
import pickle
import signal
import struct
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO, Generic, TypeVar

from msgspec import Struct
from msgspec.structs import replace

from .processes import can_fork, core_count, end_with_parent, thread_count
from .progress import counted
from .worker import WorkerDied, signal_name

_AT_HAND, _LATE = "at hand", "late"


class Attempt(Struct, frozen=True):
    """One process's attempt at all inputs."""

    folder: str
    """File for the current input, shared with the parent."""
    seconds: float
    """Time limit [s] of an input."""
    died: tuple[tuple[int, str], ...] = ()
    """Inputs that ended earlier processes, with the reason."""

    def reason(self, number: int) -> str | None:
        """Why an input is skipped; None if it is not."""
        return dict(self.died).get(number)

    @contextlib.contextmanager
    def at(self, number: int) -> Iterator[None]:
        """Process an input; ends the process if it takes too long."""
        at_hand = Path(self.folder, _AT_HAND)
        at_hand.write_text(str(number), encoding="ascii")
        with Path(self.folder, _LATE).open("wb") as late:
            faulthandler.dump_traceback_later(self.seconds, exit=True, file=late)
            try:
                yield
            finally:
                faulthandler.cancel_dump_traceback_later()
        at_hand.unlink()

    def after(self, reason: str) -> "Attempt | None":
        """The next attempt, after a process ended for a reason; None if it was not processing an input."""
        at_hand, late = Path(self.folder, _AT_HAND), Path(self.folder, _LATE)
        try:
            number = int(at_hand.read_text(encoding="ascii"))
        except (FileNotFoundError, ValueError):  # it ended before, between or after the inputs
            return None
        if self.reason(number) is not None:
            return None
        if late.stat().st_size:  # the timer's traceback
            reason = f"time limit of {self.seconds:g} s exceeded"
        at_hand.unlink()
        return replace(self, died=(*self.died, (number, reason)))


S = TypeVar("S")
T = TypeVar("T")

_NUMBER = struct.Struct("<i")
_LENGTH = struct.Struct("<q")
_PIPE_NUMBERS = 1024
"""Numbers that fit into a pipe at once on all systems."""


class Died(Struct, frozen=True):
    """A process ended while it processed an input."""

    reason: str


class Raised(Struct, frozen=True):
    """The function raised one of the expected errors."""

    kind: str
    text: str


class _Child(Generic[T]):
    """A forked process that takes numbers from the shared pipe."""

    def __init__(
        self, function: Callable[[int], T], numbers: int, failures: tuple[type[Exception], ...], seconds: float
    ) -> None:
        self._seconds = seconds
        self._results: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115 - read after the process has ended
        sys.stdout.flush()
        sys.stderr.flush()
        with warnings.catch_warnings():
            # Forking is unsafe if other threads hold locks; the kernel's process has no other threads.
            warnings.simplefilter("ignore", DeprecationWarning)
            parent = os.getpid()
            self.pid = os.fork()
        if self.pid == 0:
            status = 1
            try:
                end_with_parent(parent)
                _work(function, numbers, self._results, failures, seconds)
                status = 0
            finally:  # a forked process must never return into its parent's code
                os._exit(status)

    def collect(self, results: dict[int, T | Died | Raised | RuntimeError]) -> None:
        """Wait for the process and collect its results."""
        _, status = os.waitpid(self.pid, 0)
        code = os.waitstatus_to_exitcode(status)
        self._results.seek(0)
        with self._results as file:
            while head := file.read(_NUMBER.size):
                number = _NUMBER.unpack(head)[0]
                length = file.read(_LENGTH.size)
                payload = file.read(_LENGTH.unpack(length)[0]) if len(length) == _LENGTH.size else b""
                if len(length) < _LENGTH.size or len(payload) < _LENGTH.unpack(length)[0]:
                    results[number] = Died(_reason(code, self._seconds))
                    return
                results[number] = pickle.loads(payload)


def run(
    function: Callable[[int], T],
    order: Sequence[int],
    *,
    processes: int | None = None,
    failures: tuple[type[Exception], ...] = (),
    seconds: float = 0.0,
    attempt: Attempt | None = None,
    work: str = "",
) -> dict[int, T | Died | Raised]:
    """Call ``function`` for every number of ``order``, the first ones first.

    Args:
        function: Its results must be picklable, and depend on nothing but the number.
        order: The numbers, each once, the ones that take longest first.
        processes: Number of processes; None for one per core.
        failures: Errors that are results: returned as :class:`Raised`; others end the program.
        seconds: Processor time limit [s] of one input, if processes can be forked; 0 for none.
        attempt: Stops and identifies an input that ends its process, if processes cannot be forked.
        work: What the inputs are, in words, for whoever watches the run; empty for nothing to watch.
    """
    with counted(work, len(order)) as done:

        def counting(number: int) -> T:
            try:
                return function(number)
            finally:
                done()

        count = min(processes if processes is not None else core_count(), len(order))
        if not can_fork() or (count < 2 and not seconds):
            return {number: _call_here(counting, number, failures, attempt) for number in order}
        _give_back_freed_memory()
        results: dict[int, T | Died | Raised | RuntimeError] = {}
        left = list(order)
        while left:
            finished = len(results)
            batch, left = left[:_PIPE_NUMBERS], left[_PIPE_NUMBERS:]
            reading, writing = os.pipe()
            os.write(writing, b"".join(map(_NUMBER.pack, batch)))
            os.close(writing)
            children = [_Child(counting, reading, failures, seconds) for _ in range(min(count, len(batch)))]
            for child in children:
                child.collect(results)
            os.close(reading)
            # Processes that died leave unprocessed numbers: they are processed in a new round, without the fatal one.
            left = [number for number in batch if number not in results] + left
            if len(results) == finished:
                raise OSError("forked processes end at start")
        return {number: _expected(results[number]) for number in order}


def results_of(function: Callable[[S], T], inputs: Sequence[S], weights: Sequence[float], work: str = "") -> list[T]:
    """A function's result for each input, in forked processes where this one has no threads and inputs are several.

    Args:
        function: Its results must be picklable, and depend on nothing but the input.
        weights: Of each input: the larger, the longer it takes.
        work: As of :func:`run`.

    Raises:
        WorkerDied: A process ended without a result.
        MemoryError: A process had too little memory.
    """
    order = sorted(range(len(inputs)), key=lambda number: -weights[number])
    # Processes with threads cannot fork safely: their children would wait for threads that they do not have.
    processes = None if thread_count() == 1 else 1
    results = run(
        lambda number: function(inputs[number]), order, processes=processes, failures=(MemoryError,), work=work
    )
    ordered = []
    for number in range(len(inputs)):
        result = results[number]
        if isinstance(result, Died):
            raise WorkerDied(result.reason, ())
        if isinstance(result, Raised):
            raise MemoryError(result.text)
        ordered.append(result)
    return ordered


def _give_back_freed_memory() -> None:
    """Return freed memory to the system: forked processes would each copy its pages."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:  # available in glibc, not in musl
        trim(0)


def _expected(result: T | Died | Raised | RuntimeError) -> T | Died | Raised:
    if isinstance(result, RuntimeError):
        raise result
    return result


def _call(function: Callable[[int], T], number: int, failures: tuple[type[Exception], ...]) -> T | Raised:
    try:
        return function(number)
    except failures as error:
        return Raised(type(error).__name__, str(error))


def _call_here(
    function: Callable[[int], T], number: int, failures: tuple[type[Exception], ...], attempt: Attempt | None
) -> T | Died | Raised:
    if attempt is None:
        return _call(function, number, failures)
    if (reason := attempt.reason(number)) is not None:
        return Died(reason)
    with attempt.at(number):
        return _call(function, number, failures)


def _work(
    function: Callable[[int], T], numbers: int, results: BinaryIO, failures: tuple[type[Exception], ...], seconds: float
) -> None:
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # the limit of a command's own process has a handler
    while head := os.read(numbers, _NUMBER.size):
        number = _NUMBER.unpack(head)[0]
        results.write(head)
        results.flush()
        # The signal of this timer ends the process even within native code that never returns.
        signal.setitimer(signal.ITIMER_PROF, seconds)
        payload = _payload(function, number, failures)
        results.write(_LENGTH.pack(len(payload)))
        results.write(payload)
        results.flush()


def _payload(function: Callable[[int], T], number: int, failures: tuple[type[Exception], ...]) -> bytes:
    try:
        return pickle.dumps(_call(function, number, failures), protocol=5)
    except Exception:  # noqa: BLE001 - raised again by the parent, with this traceback
        import traceback

        return pickle.dumps(RuntimeError(f"in a forked process:\n{traceback.format_exc()}"), protocol=5)


def _reason(code: int, seconds: float) -> str:
    if code == -signal.SIGPROF:
        return f"processor time limit of {seconds:g} s exceeded"
    return f"exit code {code}" if code >= 0 else signal_name(-code)
