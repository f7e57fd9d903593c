"""Ctrl-C."""

import contextlib
import os
import signal
import threading

import pytest

from stepbot_cli.interrupts import interruptible


def press_ctrl_c() -> None:
    """What the terminal does."""
    signal.raise_signal(signal.SIGINT)


def test_interrupt_ends_the_block() -> None:
    """The block ends where Ctrl-C was pressed, and the handler is as before."""
    before = signal.getsignal(signal.SIGINT)
    reached = []

    def interrupted() -> None:
        with interruptible():
            press_ctrl_c()
            reached.append("still running")

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert reached == []
    assert signal.getsignal(signal.SIGINT) is before


def test_swallowed_interrupt_is_not_lost() -> None:
    """What a library swallowed comes again at the end of the block."""
    reached = []

    def swallowed() -> None:
        with interruptible():
            with contextlib.suppress(BaseException):
                press_ctrl_c()
            reached.append("still running")

    with pytest.raises(KeyboardInterrupt):
        swallowed()
    assert reached == ["still running"]


def test_swallowed_request_to_end_comes_again_at_the_next_occasion() -> None:
    """As an exit code that names the signal, as shells do."""
    reached = []

    def swallowed() -> None:
        with interruptible() as end_if_interrupted:
            end_if_interrupted()
            with contextlib.suppress(BaseException):
                signal.raise_signal(signal.SIGTERM)
            reached.append("still running")
            end_if_interrupted()
            reached.append("still running")

    with pytest.raises(SystemExit) as ended:
        swallowed()
    assert ended.value.code == 128 + signal.SIGTERM
    assert reached == ["still running"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_nothing_pressed_nothing_raised() -> None:
    """Without Ctrl-C nothing happens, in other threads neither."""
    with interruptible():
        pass
    done = []

    def elsewhere() -> None:
        with interruptible():
            done.append(os.getpid())

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert done
