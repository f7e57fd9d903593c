"""Starting processes."""

import os
import subprocess
import sys

import pytest

from stepbot.runtime.processes import start_process

SECONDS = 60.0
WHILE_THE_THREAD_STARTS = """
import threading
from stepbot.runtime.processes import start_process

start_thread = threading.Thread.start

def interrupted(thread):
    start_thread(thread)
    raise KeyboardInterrupt

threading.Thread.start = interrupted
try:
    start_process(lambda: 1)
except KeyboardInterrupt:
    print("interrupted")
threading.Thread.start = start_thread
print(start_process(lambda: 2))
"""
WHILE_THE_PROCESS_STARTS = """
import os, signal, threading, time
from stepbot.runtime.processes import start_process

signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background of a shell
done = threading.Event()

def start():
    time.sleep(0.1)  # CPython takes no notice of a signal on its way into a wait, only within it
    os.kill(os.getpid(), signal.SIGINT)
    return done.wait()

try:
    start_process(start)
except KeyboardInterrupt:
    print("interrupted")
done.set()
print(start_process(lambda: 2))
"""


@pytest.mark.skipif(os.name == "nt", reason="a signal ends the process there")
@pytest.mark.parametrize("script", [WHILE_THE_THREAD_STARTS, WHILE_THE_PROCESS_STARTS], ids=["thread", "process"])
def test_interrupt_while_a_process_starts(script: str) -> None:
    """After an interrupt during a start, the caller continues, starts processes, and exits without waiting."""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=SECONDS, check=True)
    assert run.stdout.split() == ["interrupted", "2"]


def test_error_of_the_start_is_raised() -> None:
    """An error of the start is raised in the caller; the next start works."""

    def fail() -> None:
        raise FileNotFoundError("no interpreter")

    with pytest.raises(FileNotFoundError, match="no interpreter"):
        start_process(fail)
    assert start_process(lambda: 3) == 3
