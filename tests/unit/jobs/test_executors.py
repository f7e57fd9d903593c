"""Processes that convert the robots of a batch."""

import os

import pytest

from stepbot.jobs.batch.work import ProcessPerThread
from stepbot.runtime.worker import RemoteError


def process(fails: bool) -> int:
    """The id of this process, or an exception."""
    if fails:
        raise ZeroDivisionError("a bug")
    return os.getpid()


def test_a_process_makes_one_call_after_the_other() -> None:
    """Calls of one thread run in one process, which is not this one."""
    with ProcessPerThread(1, []) as executor:
        first, second = (executor.submit(process, False).result() for _ in range(2))
    assert first == second != os.getpid()


def test_a_process_that_raised_is_replaced() -> None:
    """After an unexpected exception the next call runs in a new process."""
    with ProcessPerThread(1, []) as executor:
        before = executor.submit(process, False).result()
        with pytest.raises(RemoteError, match="a bug"):
            executor.submit(process, True).result()
        assert executor.submit(process, False).result() != before
