"""Where the robots of a batch are converted: any ``concurrent.futures`` executor works.

On one machine, a process converts one robot after the other, so that what it has loaded stays loaded; one that crashes
is replaced, so that a crash does not affect other robots. Each is limited to its share of the cores, since the kernel
and the engines would each use all of them. On several machines, a Dask cluster runs the same function:
https://distributed.dask.org.
"""

import os
import queue
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

from stepbot.runtime.processes import core_count
from stepbot.runtime.worker import Worker

T = TypeVar("T")


class ClusterUnreachable(Exception):
    """No scheduler at that address, or the connection failed."""


class ProcessPerThread(ThreadPoolExecutor):
    """Runs calls in processes, one of each thread, that import the function by its name.

    :class:`concurrent.futures.ProcessPoolExecutor` ends all calls when one of its processes dies.
    """

    def __init__(self, at_once: int, shares: list[frozenset[int]]) -> None:
        """Run ``at_once`` calls at a time, each on one of the ``shares`` of cores; without shares, on all cores."""
        self._shares: queue.SimpleQueue[frozenset[int]] = queue.SimpleQueue()
        for share in shares:
            self._shares.put(share)
        self._workers: dict[int, tuple[str, Worker]] = {}
        """For each thread the function of its process, and the process."""
        self._lock = threading.Lock()
        self._ended = False
        super().__init__(at_once, "robot", self._take_share if shares else None)

    def submit(self, function: Callable[..., T], /, *arguments: Any, **named: Any) -> Future[T]:
        """Submit a function of a module; keyword arguments are not supported."""
        if named:
            raise TypeError("functions in other processes take no named arguments here")
        return super().submit(self._call, f"{function.__module__}:{function.__name__}", arguments)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shut down; with ``cancel_futures`` running processes are ended too."""
        if cancel_futures:
            self._end_workers()
        super().shutdown(wait, cancel_futures=cancel_futures)
        self._end_workers()

    def _end_workers(self) -> None:
        with self._lock:
            self._ended = True
            for _, worker in self._workers.values():
                worker.close()

    def _call(self, function: str, arguments: tuple[Any, ...]) -> Any:
        worker = self._worker(function)
        try:
            # The kernel and the engines have their own time limits.
            return worker.submit(*arguments, more=True).result(threading.TIMEOUT_MAX)
        except BaseException:  # it has died, or may not be as it was
            with self._lock:
                del self._workers[threading.get_ident()]
            worker.close()
            raise

    def _worker(self, function: str) -> Worker:
        """The process of this thread."""
        mine = threading.get_ident()
        with self._lock:
            if self._ended:
                raise RuntimeError("the batch has ended")
            known, worker = self._workers.get(mine, ("", None))
            if worker is None or known != function:
                if worker is not None:
                    worker.close()
                worker = Worker(function)
                self._workers[mine] = function, worker
            return worker

    def _take_share(self) -> None:
        """Bind this thread to its cores: processes that it starts inherit the binding."""
        os.sched_setaffinity(0, self._shares.get())


def local_executor(cores: int, tasks: int) -> ProcessPerThread:
    """An executor that uses a number of cores, with as many robots at once as there are cores and robots.

    Args:
        cores: Number of cores to use.
        tasks: Number of robots.
    """
    at_once = max(1, min(cores, tasks))
    return ProcessPerThread(at_once, _shares(cores, at_once))


def _shares(cores: int, at_once: int) -> list[frozenset[int]]:
    """The cores of each robot; empty if the system cannot bind processes, or has fewer cores than requested."""
    if not hasattr(os, "sched_getaffinity") or cores > core_count():
        return []
    mine = sorted(os.sched_getaffinity(0))[:cores]
    return [frozenset(mine[start::at_once]) for start in range(at_once)]


@contextmanager
def on_cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """An executor on a Dask cluster, and the number of robots it can convert at once.

    Raises:
        ClusterUnreachable: No scheduler answers.
        ModuleNotFoundError: The extra ``dask`` is not installed.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=10)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterUnreachable(f"scheduler at {address} does not respond: {error}") from error
    with client:
        # A killed worker is not the robot's fault: it is retried elsewhere without limit.
        executor = client.get_executor(pure=False, retries=10)
        try:
            yield executor, max(1, sum(client.nthreads().values()))
        finally:
            executor.shutdown(wait=False)
