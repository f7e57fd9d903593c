"""Handles signals that end a command: SIGINT, SIGTERM and SIGHUP.

They raise exceptions, so that processes are ended and half-written files removed. Some libraries catch such an
exception while they import optional modules: it is raised again at the next opportunity.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Those that the system has."""


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """Raise KeyboardInterrupt for Ctrl-C within the block, SystemExit for a request to end.

    Yields a function to call periodically: it raises an exception that was caught again. So does the end of the block.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: None  # only the main thread may handle signals
        return
    received: list[int] = []

    def end(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 - the signature of handlers
        received.append(number)
        again()

    def again() -> None:
        if received:
            raise KeyboardInterrupt if received[0] == signal.SIGINT else SystemExit(128 + received[0])

    # A signal that the parent process ignores stays ignored.
    before = {number: signal.getsignal(number) for number in _SIGNALS}
    taken = [number for number, handler in before.items() if handler is not signal.SIG_IGN]
    for number in taken:
        signal.signal(number, end)
    try:
        yield again
    finally:
        for number in taken:
            signal.signal(number, before[number])
    again()
