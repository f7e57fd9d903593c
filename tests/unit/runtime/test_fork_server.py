"""Forked workers have the results, limits and failures of workers with their own interpreter."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from stepbot.runtime.fork_server import ForkServer, can_serve
from stepbot.runtime.worker import RemoteError, Worker, WorkerDied
from tests.processes import ended

pytestmark = pytest.mark.skipif(not can_serve(), reason="no fork server on this system")

HERE = "tests.unit.runtime.isolated_functions"


@pytest.fixture(scope="module")
def server() -> Iterator[ForkServer]:
    """A fork server with the functions imported, and a missing module."""
    with ForkServer((f"{HERE}:prepare", "stepbot.no_such_module")) as started:
        yield started


def call(
    server: ForkServer, function: str, *arguments: object, timeout: float = 60.0, limit: int | None = None
) -> object:
    """Call a function in a forked process."""
    with Worker(f"{HERE}:{function}", memory_limit=limit, start=server.fork) as worker:
        return worker.submit(*arguments).result(timeout)


def test_results_of_many_at_once(server: ForkServer) -> None:
    """Concurrent calls get their own arguments, also larger than a pipe, and return their own results."""
    workers = [Worker(f"{HERE}:double", start=server.fork) for _ in range(8)]
    assert len({worker.pid for worker in workers}) == len(workers)
    for number, worker in enumerate(workers):
        worker.submit(bytes([number]) * 200_000)
    assert [worker.result() for worker in workers] == [bytes([number]) * 400_000 for number in range(8)]


def test_it_is_a_process_of_its_own(server: ForkServer) -> None:
    """Forked processes reuse the server's imports."""
    assert call(server, "prepared") == 2


def test_what_native_code_prints_does_not_disturb_the_result(server: ForkServer) -> None:
    """Native output on descriptor 1 is part of the worker's standard error."""
    assert call(server, "print_natively", "noise") == "noise"


def test_an_exception_comes_back_as_such(server: ForkServer) -> None:
    """An exception is returned with its type and text."""
    with pytest.raises(RemoteError, match="no good") as caught:
        call(server, "fail", "no good")
    assert caught.value.kind == "ValueError"


def test_a_crash_is_an_exception_with_the_last_lines(server: ForkServer) -> None:
    """A segmentation fault ends neither the server nor the caller, and has the last lines of output."""
    with pytest.raises(WorkerDied, match="SIGSEGV") as caught:
        call(server, "crash", "last words")
    assert "last words" in caught.value.last_lines
    assert call(server, "double", 21) == 42


def test_an_exit_without_a_result_is_a_death(server: ForkServer) -> None:
    """An exit without a result is reported with the exit code."""
    with pytest.raises(WorkerDied, match="exit code 3"):
        call(server, "leave", 3)


def test_the_message_of_an_exit_is_the_last_line(server: ForkServer) -> None:
    """Python prints it at the end of an interpreter; a forked worker has no such end."""
    with pytest.raises(WorkerDied, match="exit code 1") as caught:
        call(server, "exit_with", "condition failed")
    assert caught.value.last_lines == ("condition failed",)


@pytest.mark.slow
def test_too_long_is_a_death(server: ForkServer) -> None:
    """A call is ended after its timeout."""
    with pytest.raises(WorkerDied, match=r"no result after 0.5 s"):
        call(server, "sleep", 60.0, timeout=0.5)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="no limit on address space")
def test_too_much_memory_is_a_death(server: ForkServer) -> None:
    """A memory limit applies to one process; the next has none."""
    with pytest.raises(WorkerDied, match="out of memory"):
        call(server, "allocate", 4 << 30, limit=1 << 30)
    assert call(server, "double", "x" * (1 << 20)) == "x" * (2 << 20)


def test_a_process_that_is_killed(server: ForkServer) -> None:
    """A process killed before its call is reported."""
    worker = Worker(f"{HERE}:double", start=server.fork)
    os.kill(worker.pid, signal.SIGKILL)
    worker.submit(b"x" * (1 << 22))
    with pytest.raises(WorkerDied, match="SIGKILL"):
        worker.result(timeout=20.0)


def test_closed_before_it_was_asked(server: ForkServer) -> None:
    """A worker can be closed before a call, twice, and leaves no process."""
    worker = Worker(f"{HERE}:double", start=server.fork)
    worker.close()
    worker.close()
    assert ended(worker.pid)


def test_processes_end_with_their_server() -> None:
    """Closing the server ends all workers; a caller that waits gets an error."""
    with ForkServer(()) as server:
        busy, idle = (Worker(f"{HERE}:sleep", start=server.fork) for _ in range(2))
        pids = [busy.pid, idle.pid]
        busy.submit(60.0)
    with pytest.raises(WorkerDied, match="SIGKILL"):
        busy.result(timeout=20.0)
    idle.close()
    assert all(map(ended, pids))


def test_without_its_server_a_worker_starts_on_its_own() -> None:
    """After the server has ended, workers start with their own interpreter."""
    server = ForkServer(())
    server.close()
    assert call(server, "double", 4) == 8


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="no /proc on this system")
def test_nothing_outlives_a_caller_that_is_killed() -> None:
    """Server and workers end with a caller that is killed."""
    code = (
        "import time; from stepbot.runtime.fork_server import ForkServer; from stepbot.runtime.worker import Worker\n"
        f"server = ForkServer(()); worker = Worker('{HERE}:sleep', start=server.fork).submit(60.0)\n"
        "print(server._server.pid, worker.pid, flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as caller:
        assert caller.stdout is not None
        pids = [int(word) for word in caller.stdout.readline().split()]
        caller.kill()
    assert len(pids) == 2
    assert all(map(ended, pids))


@pytest.mark.slow
def test_threads_of_an_import(server: ForkServer) -> None:
    """A server with a thread does not fork; its workers have their own interpreter."""
    with ForkServer((f"{HERE}:prepare", f"{HERE}:start_thread")) as threaded:
        assert call(threaded, "prepared") == 1
        assert call(threaded, "double", "x" * 200_000) == "x" * 400_000
        with pytest.raises(WorkerDied, match="exit code 3"):
            call(threaded, "leave", 3)
        with pytest.raises(WorkerDied, match="SIGSEGV") as caught:
            call(threaded, "crash", "last words")
        assert "last words" in caught.value.last_lines
        busy = Worker(f"{HERE}:sleep", start=threaded.fork)
        pid = busy.pid
        busy.submit(600.0)
    assert ended(pid)
    busy.close()


@pytest.mark.parametrize("name", ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"])
def test_threads_that_the_user_asks_for(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """For any thread settings in the environment, a server with numpy and its workers have one thread."""
    monkeypatch.setenv(name, "4")
    with ForkServer((f"{HERE}:multiply_matrices", f"{HERE}:prepare")) as server:
        assert call(server, "thread_limits") == {"1"}
        assert call(server, "multiply_matrices") == 1
        assert call(server, "prepared") == 2  # was forked


@pytest.mark.slow
def test_a_server_started_from_a_thread_that_ends() -> None:
    """Server and workers started from a thread end with the process, not with the thread."""
    servers: list[ForkServer] = []

    def start() -> None:
        servers.append(ForkServer((f"{HERE}:prepare",)))
        assert call(servers[0], "prepared") == 2  # by now the server has requested to end with its parent

    thread = threading.Thread(target=start)
    thread.start()
    thread.join()
    with servers[0] as server:
        time.sleep(0.5)
        assert call(server, "prepared") == 2
