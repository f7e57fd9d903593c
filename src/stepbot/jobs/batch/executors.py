"""Where the robots of a batch are converted: any ``concurrent.futures`` executor will do.

Here, each robot gets a process of its own, so that one that crashes takes no other with it; each process keeps to its
share of the cores, since the kernel and the engines would each take all of them. Beyond one machine, a Dask cluster
runs the same function: https://distributed.dask.org.
"""

import os
import queue
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

from stepbot.runtime.cores import core_count
from stepbot.runtime.worker import Worker

T = TypeVar("T")


class ClusterUnreachable(Exception):
    """There is no scheduler at that address, or no way to speak to one."""


class ProcessEach(ThreadPoolExecutor):
    """Runs each call in a fresh process that imports the function by its name."""

    def __init__(self, at_once: int, shares: list[frozenset[int]]) -> None:
        """Run ``at_once`` calls at a time, each on one of the ``shares`` of cores; no shares, no such limits."""
        self._shares: queue.SimpleQueue[frozenset[int]] = queue.SimpleQueue()
        for share in shares:
            self._shares.put(share)
        self._running: set[Worker] = set()
        self._lock = threading.Lock()
        self._ended = False
        super().__init__(at_once, "robot", self._take_share if shares else None)

    def submit(self, function: Callable[..., T], /, *arguments: Any, **named: Any) -> Future[T]:
        """Have a function of a module called; it takes no named arguments."""
        if named:
            raise TypeError("functions in other processes take no named arguments here")
        return super().submit(self._call, f"{function.__module__}:{function.__name__}", arguments)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End; with ``cancel_futures`` the processes that run are ended too."""
        if cancel_futures:
            with self._lock:
                self._ended = True
                for worker in self._running:
                    worker.close()
        super().shutdown(wait, cancel_futures=cancel_futures)

    def _call(self, function: str, arguments: tuple[Any, ...]) -> Any:
        with Worker(function) as worker:
            with self._lock:
                if self._ended:
                    raise RuntimeError("the batch has ended")
                self._running.add(worker)
            try:
                # The kernel and the engines have their own limits of time within.
                return worker.submit(*arguments).result(threading.TIMEOUT_MAX)
            finally:
                with self._lock:
                    self._running.discard(worker)

    def _take_share(self) -> None:
        """Bind this thread to its cores: processes that it starts inherit that."""
        os.sched_setaffinity(0, self._shares.get())


def local_executor(cores: int, tasks: int) -> ProcessEach:
    """An executor that keeps a number of cores busy, with as many robots at once as there are cores and robots.

    Args:
        cores: How many to use.
        tasks: How many robots there are.
    """
    at_once = max(1, min(cores, tasks))
    return ProcessEach(at_once, _shares(cores, at_once))


def _shares(cores: int, at_once: int) -> list[frozenset[int]]:
    """The cores of each robot; empty where the system cannot bind processes, or more are asked for than there are."""
    if not hasattr(os, "sched_getaffinity") or cores > core_count():
        return []
    mine = sorted(os.sched_getaffinity(0))[:cores]
    return [frozenset(mine[start::at_once]) for start in range(at_once)]


@contextmanager
def on_cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """An executor on a Dask cluster, and how many robots it can convert at once.

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
        # Killed workers are no fault of a robot: it is done again elsewhere, as often as it takes.
        executor = client.get_executor(pure=False, retries=10)
        try:
            yield executor, max(1, sum(client.nthreads().values()))
        finally:
            executor.shutdown(wait=False)
