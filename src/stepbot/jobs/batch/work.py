"""One robot of a batch, in whatever process converts it: any ``concurrent.futures`` executor works.

On one machine, a process converts one robot after the other, so that what it has loaded stays loaded; one that crashes
is replaced, so that a crash does not affect other robots. Each is limited to its share of the cores, since the kernel
and the engines would each use all of them. On several machines, a Dask cluster runs the same function:
https://distributed.dask.org.
"""

import os
import queue
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from msgspec import Struct

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.runtime.cache import Cache, default_folder
from stepbot.runtime.processes import core_count
from stepbot.runtime.temporary import run_folder
from stepbot.runtime.worker import Worker
from stepbot.version import __version__

from ..incremental import conversion_key, produce, sidecar_digest

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
    """An executor that uses a number of cores, with as many robots at once as there are cores and robots."""
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


class Work(Struct, frozen=True):
    """The result for one robot; nothing is written yet."""

    files: Mapping[str, bytes]
    diagnostics: tuple[Diagnostic, ...]
    step: str = ""
    """The STEP that was read, relative to the sidecar's folder; empty if there was none."""
    input: str = ""
    """Key of everything that the files depend on; empty if the result must not be reused."""
    read: tuple[str, ...] = ()
    """The files that a composed robot depends on."""


class Parcel(Struct, frozen=True):
    """A robot's input as bytes, for a machine without access to its files."""

    sidecar: str
    """The user's path."""
    text: bytes
    step: str
    """The user's path."""
    files: Mapping[str, bytes]
    """The STEP, and then the files that it refers to, by their names relative to its folder."""
    options: Options
    """Without a cache: the other machine has its own."""
    input: str
    """Key of everything that the files depend on."""
    version: str = __version__


def prepare() -> None:
    """In a process that converts one robot after the other: keep what it loads for the next one."""
    from stepbot.pipeline.prestart import stay_warm

    stay_warm()


def carry_out(sidecar: Path, options: Options) -> Work:
    """Convert a robot whose files are on this machine."""
    before = sidecar_digest(sidecar, options.variant)
    conversion = produce(sidecar, options)
    if not before or before != sidecar_digest(sidecar, options.variant):
        return Work(conversion.files, tuple(conversion.diagnostics))
    step = options.step or (sidecar.parent / conversion.named if conversion.named else None)
    if conversion.read:
        step = step or sidecar
    if step is None or not conversion.geometry or conversion.diagnostics.has_errors:
        return Work(conversion.files, tuple(conversion.diagnostics))
    key = conversion_key(sidecar, before, step, conversion.geometry, options)
    read = tuple(path.as_posix() for path in conversion.read)
    return Work(conversion.files, tuple(conversion.diagnostics), str(step), key, read)


def carry_out_parcel(parcel: Parcel) -> Work:
    """Convert a robot that was sent as bytes; messages use the user's file names."""
    if parcel.version != __version__:
        diagnostics = Diagnostics()
        message = f"version mismatch: worker has stepbot {__version__}, client has {parcel.version}"
        diagnostics.add(
            "SB009", message, Span(parcel.sidecar), help=["install the same version of stepbot on all machines"]
        )
        return Work({}, tuple(diagnostics))
    from stepbot.pipeline import stages as pipeline

    with TemporaryDirectory(dir=run_folder()) as folder:
        sidecar = _put(Path(folder) / "sidecar", parcel.sidecar, parcel.text)
        step = _put_all(Path(folder) / "step", parcel.files)
        # Whole conversions are cached by path, geometry and observations by content only: the latter are reused.
        options = parcel.options._replace(step=step, cache=Cache(default_folder()) if parcel.options.cache else None)
        conversion = pipeline.produce(sidecar, options)
        owner = Path(parcel.step).parent
        known = {sidecar.as_posix(): parcel.sidecar}
        known |= {str(step.parent / name): str(owner / name) for name in parcel.files}
        is_done = not conversion.diagnostics.has_errors
        return Work(conversion.files, _renamed(conversion, known), parcel.step, parcel.input if is_done else "")


def _put(folder: Path, name: str, content: bytes) -> Path:
    folder.mkdir()
    path = folder / Path(name).name
    path.write_bytes(content)
    return path


def _put_all(folder: Path, files: Mapping[str, bytes]) -> Path:
    """The first file, written with the others beside it."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder / next(iter(files))


def _renamed(conversion: Conversion, known: Mapping[str, str]) -> tuple[Diagnostic, ...]:
    return tuple(
        diagnostic._replace(span=diagnostic.span._replace(file=known.get(diagnostic.span.file, diagnostic.span.file)))
        for diagnostic in conversion.diagnostics
    )
