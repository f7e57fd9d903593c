"""Functions in forked processes have the same results, and a crash loses one input."""

import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from stepbot.runtime.parallel import Died, Raised, results_of, run
from stepbot.runtime.processes import can_fork, core_count

FORKS = pytest.mark.skipif(not can_fork(), reason="no fork on this system")


def square(number: int) -> tuple[int, bytes]:
    """A result larger than a pipe."""
    return number * number, bytes(100_000)


@pytest.mark.parametrize("processes", [1, pytest.param(2, marks=FORKS), pytest.param(5, marks=FORKS)])
def test_results_do_not_depend_on_processes(processes: int) -> None:
    """Every number has its result, in the requested order."""
    order = [*range(40, 0, -1)]
    results = run(square, order, processes=processes)
    assert list(results) == order
    assert all(results[n] == (n * n, bytes(100_000)) for n in order)


@FORKS
def test_more_numbers_than_a_pipe_holds() -> None:
    """Thousands of inputs are processed in rounds."""
    results = run(lambda n: -n, range(3000), processes=2)
    assert results == {n: -n for n in range(3000)}


@FORKS
def test_a_crash_costs_one_input() -> None:
    """A process that dies loses its input; all others are processed."""

    def crash_on_three(number: int) -> int:
        if number == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    results = run(crash_on_three, range(10), processes=2)
    assert results[3] == Died("SIGKILL")
    assert [results[n] for n in range(10) if n != 3] == [n for n in range(10) if n != 3]


@FORKS
def test_an_exit_is_a_death() -> None:
    """A process that exits silently counts as dead."""
    assert run(lambda n: os._exit(7) if n == 0 else n, [0, 1], processes=2) == {0: Died("exit code 7"), 1: 1}


@FORKS
@pytest.mark.parametrize("numbers", [[0], [0, 1, 2]], ids=["alone", "among others"])
def test_an_endless_loop_costs_one_input(numbers: list[int]) -> None:
    """An input that takes too long, in native code too, is stopped and reported; each has its own time limit."""

    def count_for_ever(number: int) -> int:
        return sum(itertools.repeat(0)) if number == 0 else number

    results = run(count_for_ever, numbers, processes=2, seconds=0.2)
    assert results == {0: Died("processor time limit of 0.2 s exceeded")} | {n: n for n in numbers if n}


def fail(number: int) -> int:
    """Raise an expected error, another one, or none."""
    raise (ValueError if number else KeyError)("oops")


@pytest.mark.parametrize("processes", [1, pytest.param(2, marks=FORKS)])
def test_expected_errors_are_results(processes: int) -> None:
    """Errors of expected types are returned."""
    assert run(fail, [1, 2], processes=processes, failures=(ValueError,)) == {
        1: Raised("ValueError", "oops"),
        2: Raised("ValueError", "oops"),
    }


@FORKS
def test_bugs_come_out_with_their_traceback() -> None:
    """An unexpected error ends the program with its traceback."""
    with pytest.raises(RuntimeError, match="in fail"):
        run(fail, [0, 1], processes=2, failures=(ValueError,))


@FORKS
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs /proc to see processes")
def test_nothing_outlives_its_parent() -> None:
    """Forked processes end with a parent that is killed."""
    reading, writing = os.pipe()
    parent = os.fork()
    if parent == 0:

        def tell_and_hang(number: int) -> None:
            os.write(writing, f"{os.getpid()}\n".encode())
            time.sleep(60)

        run(tell_and_hang, [0, 1], processes=2)
        os._exit(0)
    pids: set[int] = set()
    while len(pids) < 2:
        pids |= {int(pid) for pid in os.read(reading, 64).split()}
    os.kill(parent, signal.SIGKILL)
    os.waitpid(parent, 0)
    deadline = time.monotonic() + 10
    while any(is_running(pid) for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not any(is_running(pid) for pid in pids)


def is_running(pid: int) -> bool:
    """Whether a process runs and is not a zombie."""
    try:
        return ") Z" not in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False


@FORKS
def test_results_of_several() -> None:
    """Results are in the order of the inputs; a process that dies ends the computation with its signal."""
    assert results_of(square, (3, 1, 2), (1.0, 3.0, 2.0)) == [square(3), square(1), square(2)]
    code = "import os, signal\nfrom stepbot.runtime.parallel import results_of\n"
    code += "results_of(lambda n: os.kill(os.getpid(), signal.SIGSEGV), (0, 1), (1.0, 1.0))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == (1 if core_count() > 1 else -signal.SIGSEGV)
    assert core_count() == 1 or done.stderr.rstrip().endswith("WorkerDied: SIGSEGV")


@FORKS
def test_a_process_with_threads_is_not_forked() -> None:
    """With another thread, results are computed in this process."""
    done = threading.Event()
    thread = threading.Thread(target=done.wait)
    thread.start()
    try:
        assert results_of(lambda _: os.getpid(), (0, 1), (1.0, 1.0)) == [os.getpid()] * 2
    finally:
        done.set()
        thread.join()
