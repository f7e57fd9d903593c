"""Worker processes: results, failures and their end."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import BinaryIO

import pytest

from stepbot.runtime.worker import Process, RemoteError, Worker, WorkerDied, are_spawned, spawned, started_by
from tests.processes import call_isolated, ended

HERE = "tests.unit.runtime.isolated_functions"


def test_a_result_comes_back() -> None:
    """A worker returns the result of a call."""
    assert call_isolated(f"{HERE}:double", 21) == 42


def test_one_call_after_the_other() -> None:
    """A worker answers several calls, also after an exception, and ends with the last."""
    with Worker(f"{HERE}:prepared") as worker:
        assert [worker.submit(more=True).result(), worker.submit(more=True).result()] == [1, 1]
        os.kill(worker.pid, 0)
        assert worker.submit().result() == 1
        with pytest.raises(ProcessLookupError):
            os.kill(worker.pid, 0)
    with Worker(f"{HERE}:fail") as worker:
        for text in ("no good", "no better"):
            with pytest.raises(RemoteError, match=text):
                worker.submit(text, more=True).result()


def test_a_death_between_calls() -> None:
    """After a death between calls, earlier results are valid, and the next call reports the death."""
    with Worker(f"{HERE}:double_or_leave") as worker:
        assert worker.submit(21, more=True).result() == 42
        with pytest.raises(WorkerDied, match="exit code 3"):
            worker.submit(None, more=True).result()


def test_the_worker_prepares_before_it_is_asked() -> None:
    """``prepare`` of the module runs first, once."""
    assert call_isolated(f"{HERE}:prepared") == 1


def test_what_native_code_prints_does_not_disturb_the_result() -> None:
    """Native output on descriptor 1 is part of the worker's standard error."""
    assert call_isolated(f"{HERE}:print_natively", "noise") == "noise"


def test_an_exception_comes_back_as_such() -> None:
    """An exception is returned with its type, text and place."""
    with pytest.raises(RemoteError, match="no good") as caught:
        call_isolated(f"{HERE}:fail", "no good")
    assert caught.value.kind == "ValueError"
    assert caught.value.text == "no good"
    assert "in fail" in caught.value.trace


def test_a_module_that_is_not_there_is_an_error() -> None:
    """A failed import is reported like any exception."""
    with pytest.raises(RemoteError) as caught:
        call_isolated("stepbot.no_such_module:observe")
    assert caught.value.kind == "ModuleNotFoundError"


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_a_crash_is_an_exception_with_the_last_lines() -> None:
    """A segmentation fault ends the worker only, and has the last lines of output."""
    with pytest.raises(WorkerDied, match="SIGSEGV") as caught:
        call_isolated(f"{HERE}:crash", "last words")
    assert "last words" in caught.value.last_lines


def test_an_exit_without_a_result_is_a_death() -> None:
    """An exit without a result is reported with the exit code."""
    with pytest.raises(WorkerDied, match="exit code 3"):
        call_isolated(f"{HERE}:leave", 3)


@pytest.mark.slow
def test_too_long_is_a_death() -> None:
    """The worker is ended after its timeout."""
    start = time.monotonic()
    with pytest.raises(WorkerDied, match=r"no result after 0.5 s"):
        call_isolated(f"{HERE}:sleep", 60.0, timeout=0.5)
    assert time.monotonic() - start < 20.0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="no limit on address space")
def test_too_much_memory_is_a_death() -> None:
    """A memory limit applies to the worker only."""
    with pytest.raises(WorkerDied, match="out of memory"):
        call_isolated(f"{HERE}:allocate", 4 << 30, memory_limit=1 << 30)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="no limit on address space")
def test_a_limit_beyond_what_the_system_allows() -> None:
    """If the system's limit is lower than the requested one, it applies."""
    code = (
        "import resource; from stepbot.runtime.worker import Workers\n"
        "resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))\n"
        f"Workers(memory_limit=64 << 30).call('{HERE}:allocate', 4 << 30)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "WorkerDied: out of memory" in done.stderr


def test_a_worker_can_be_closed_before_it_is_asked() -> None:
    """A worker can be closed before a call, twice, and leaves no process."""
    worker = Worker(f"{HERE}:double")
    worker.close()
    worker.close()
    with pytest.raises(ProcessLookupError):
        os.kill(worker.pid, 0)


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_a_worker_that_was_killed_before_it_was_asked() -> None:
    """A call of a dead worker does not block; its result reports the death."""
    worker = Worker(f"{HERE}:double")
    os.kill(worker.pid, 9)
    worker.submit(b"x" * (1 << 22))
    with pytest.raises(WorkerDied, match="SIGKILL"):
        worker.result(timeout=20.0)


def test_workers_run_at_the_same_time() -> None:
    """Two workers run at the same time."""
    first, second = (Worker(f"{HERE}:sleep").submit(seconds) for seconds in (30.0, 0.1))
    assert second.result() == 0.1
    with pytest.raises(WorkerDied, match="no result"):
        first.result(timeout=0.01)


@pytest.mark.slow
def test_a_worker_started_from_a_thread_that_ends() -> None:
    """A worker started from a thread ends with the process, not with the thread."""
    worker: list[Worker] = []

    def start() -> None:
        worker.append(Worker(f"{HERE}:sleep").submit(0.0, more=True))
        worker[0].result()  # by now it has requested to end with its parent

    thread = threading.Thread(target=start)
    thread.start()
    thread.join()
    assert worker[0].submit(1.0).result() == 1.0


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="processes cannot be bound to cores")
@pytest.mark.usefixtures("cold_processes")
def test_a_worker_inherits_the_cores_of_the_thread_that_starts_it() -> None:
    """A worker inherits the cores of the thread that starts it, so that a batch keeps its share."""
    one = min(os.sched_getaffinity(0))
    cores: list[set[int]] = []

    def start_on_one() -> None:
        os.sched_setaffinity(0, {one})
        cores.append(call_isolated("os:sched_getaffinity", 0))

    thread = threading.Thread(target=start_on_one)
    thread.start()
    thread.join()
    assert cores == [{one}]
    assert call_isolated("os:sched_getaffinity", 0) == os.sched_getaffinity(0)


def test_each_block_gives_back_how_workers_start() -> None:
    """After an inner block, workers start as in the outer one, even where both start them in one way."""

    def other(function: str, memory_limit: int | None, stderr: BinaryIO) -> Process:
        raise AssertionError("not called")

    with started_by(spawned), started_by(other):
        assert not are_spawned()
        with started_by(spawned):
            assert are_spawned()
        assert not are_spawned()


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="no /proc on this system")
def test_a_worker_does_not_outlive_a_caller_that_is_killed() -> None:
    """A worker ends with a caller that is killed, also while busy and if started from a finished thread."""
    code = (
        "import threading, time; from stepbot.runtime.worker import Worker; pids = []\n"
        "def start():\n"
        f"    worker = Worker('{HERE}:sleep').submit(0.0, more=True); worker.result()\n"
        "    worker.submit(600.0); pids.append(worker.pid)\n"
        "thread = threading.Thread(target=start); thread.start(); thread.join()\n"
        "time.sleep(1.0); print(*pids, flush=True); time.sleep(600)"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as caller:
        assert caller.stdout is not None
        pid = int(caller.stdout.readline())
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
        caller.kill()
    assert ") Z" not in state
    assert ended(pid)
