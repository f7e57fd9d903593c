"""Limits of time and memory for the process of a command itself: its workers have their own.

The time is processor time, so that waiting for a worker does not count. An exception ends the work, as Ctrl-C does, and
is raised again for as long as something catches it.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from stepbot.diagnostics import Diagnostics, Span, StepbotError

from .interrupts import is_in_native_module

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options

_AGAIN = 1.0
"""Processor time [s] after which an exception that was caught is raised again."""
_SOON = 0.01
"""The same where a native module is being initialized, which may abort the process at an exception."""


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
    with ExitStack() as limits:
        restart = limits.enter_context(_within_time(options.timeout))
        if options.memory_limit is not None:
            limits.enter_context(_within_memory(options.memory_limit))
        try:
            yield restart
        except MemoryError:
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
    bounds = [one for one in (allowed, before, most) if one != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min(bounds), most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (before, most))


def _exceeded(reason: str, help: str) -> StepbotError:
    found = Diagnostics()
    found.add("SB902", f"stepbot itself was stopped: {reason}", Span("stepbot"), help=[help])
    return StepbotError(found)
