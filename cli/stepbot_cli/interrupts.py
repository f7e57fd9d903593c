"""Handles signals that end a command: SIGINT, SIGTERM and SIGHUP.

They raise exceptions, so that processes are ended and half-written files removed. Some libraries catch such an
exception while they import optional modules: it is raised again at the next opportunity. A native module that is being
initialized may abort the process at an exception: it is raised once the module is there.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.machinery import ExtensionFileLoader
from types import FrameType

_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Those that the system has."""
_CAN_WAIT = hasattr(signal, "setitimer")
_AGAIN = 0.01
"""Seconds until a signal that came during the initialization of a native module is handled."""


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
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
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
