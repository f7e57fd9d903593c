"""What ends a command early: the signals SIGINT, SIGTERM and SIGHUP, and limits of time and memory of its process.

Both raise exceptions, so that processes are ended and half-written files removed. Some libraries catch such an
exception while they import optional modules: it is raised again at the next opportunity. A native module that is being
initialized may abort the process at an exception: it is raised once the module is there. The limit of time is one of
processor time, so that waiting for a worker does not count.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.runtime.memory import is_out_of_memory

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options

_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Those that the system has."""
_CAN_WAIT = hasattr(signal, "setitimer")
_SOON = 0.01
"""Seconds until a signal that came while a native module was being initialized is handled."""
_AGAIN = 1.0
"""Processor time [s] after which an exception that was caught is raised again."""
_NEAR = 0.9
"""Share of the memory limit that was reserved at some time where it may have been exhausted."""


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """Raise KeyboardInterrupt for Ctrl-C within the block, SystemExit for a request to end.

    Yields a function to call periodically: it raises an exception that was caught again. So does the end of the block.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: None  # only the main thread may handle signals
        return
    received: list[int] = []

    def end(number: int, frame: FrameType | None) -> None:
        received.append(number)
        end_soon(number, frame)

    def end_soon(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 - the signature of handlers
        if _CAN_WAIT and is_in_native_module(frame):
            signal.setitimer(signal.ITIMER_REAL, _SOON)
        else:
            again()

    def again() -> None:
        if received:
            raise KeyboardInterrupt if received[0] == signal.SIGINT else SystemExit(128 + received[0])

    # A signal that the parent process ignores stays ignored.
    before = {number: signal.getsignal(number) for number in _SIGNALS}
    taken = [number for number, handler in before.items() if handler is not signal.SIG_IGN]
    for number in taken:
        signal.signal(number, end)
    if _CAN_WAIT:
        before[signal.SIGALRM] = signal.signal(signal.SIGALRM, end_soon)
    try:
        yield again
    finally:
        if _CAN_WAIT:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            taken.append(signal.SIGALRM)
        for number in taken:
            signal.signal(number, before[number])
    again()


def is_in_native_module(frame: FrameType | None) -> bool:
    """Whether a native module is being initialized in a frame, or in one of its callers."""
    while frame is not None:
        is_loading = frame.f_code.co_name in ("create_module", "exec_module")
        if is_loading and isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False


@contextmanager
def bounded(options: "Options | None") -> Iterator[Callable[[], None]]:
    """Within the block this process has the limits of workers; None for none.

    Yields a function that starts the time anew, for the next of many inputs or the next stage.

    Raises:
        StepbotError: SB902, where it needs more.
    """
    if options is None:
        yield lambda: None
        return
    try:
        with ExitStack() as limits:
            restart = limits.enter_context(_within_time(options.timeout))
            if options.memory_limit is not None:
                limits.enter_context(_within_memory(options.memory_limit))
            yield restart
    except (MemoryError, ImportError) as error:  # caught where the limit no longer holds: a message takes memory, too
        if not is_out_of_memory(error):
            raise
        raise _exceeded("out of memory", "raise `--memory-limit`") from None


@contextmanager
def _within_time(seconds: float) -> Iterator[Callable[[], None]]:
    """End this process's work after so much processor time [s], where the system has such a timer."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield lambda: None
        return

    def end(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 - the signature of handlers
        if is_in_native_module(frame):
            signal.setitimer(signal.ITIMER_PROF, _SOON)
            return
        signal.setitimer(signal.ITIMER_PROF, _AGAIN)
        raise _exceeded(f"{seconds:g} s of processor time exceeded", f"allow more time: `--timeout {4 * seconds:g}`")

    def start() -> None:
        signal.setitimer(signal.ITIMER_PROF, seconds)

    before = signal.signal(signal.SIGPROF, end)
    start()
    try:
        yield start
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def _within_memory(size: int) -> Iterator[None]:
    """Let this process reserve so many bytes of address space more than it has, where the system can limit that."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (ImportError, OSError):
        yield
        return
    before, most = resource.getrlimit(resource.RLIMIT_AS)
    allowed = size + pages * resource.getpagesize()
    limit = min(one for one in (allowed, before, most) if one != resource.RLIM_INFINITY)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    try:
        yield
    except SystemError as error:  # of a native module without an exception: for want of memory, or a bug of it
        if _peak() < _NEAR * limit:
            raise
        raise MemoryError from error
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (before, most))


def _peak() -> int:
    """The largest address space [bytes] that this process had."""
    status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    (size,) = (line.split()[1] for line in status.splitlines() if line.startswith("VmPeak:"))
    return 1024 * int(size)


def _exceeded(reason: str, help: str) -> StepbotError:
    diagnostics = Diagnostics()
    diagnostics.add("SB902", f"stepbot itself was stopped: {reason}", Span("stepbot"), help=[help])
    return StepbotError(diagnostics)
