"""Starts processes before the rest of stepbot is loaded: the kernel if a STEP is to be read, else engines.

Importing the kernel takes as long as all other imports together, and it runs in its own process, so it starts first. If
no kernel is needed, the common packages of the engines are imported in parallel with this process's imports. The
sidecar is only searched for the name of its STEP: a wrong guess costs an unused process, never a wrong result.
"""

import re
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

from stepbot.runtime.cache import Cache, Digest, environment
from stepbot.runtime.file import is_file, open_regular
from stepbot.runtime.fork_server import ForkServer, can_serve
from stepbot.runtime.worker import Process, Worker, are_spawned, spawned, started_by
from stepbot.step import KERNEL
from stepbot.step.exchange.input_files import input_digest

from .conversion import Options

_ENGINES = ("stepbot.engines.", "stepbot.verification.self_collision.")
"""Beginnings of the names of functions that run engines."""


class WarmProcesses:
    """Starts workers from processes that have loaded what those need; each of these starts with its first worker."""

    def __init__(self) -> None:
        self._servers: dict[Sequence[str], ForkServer] = {}
        self._lock = threading.Lock()

    def start(self, function: str, memory_limit: int | None, stderr: BinaryIO) -> Process:
        """Start a worker; see :data:`stepbot.runtime.worker.Start`."""
        imports = _imports(function)
        if not imports:
            return spawned(function, memory_limit, stderr)
        with self._lock:
            if imports not in self._servers:
                self._servers[imports] = ForkServer(imports)
            server = self._servers[imports]
        return server.fork(function, memory_limit, stderr)

    def close(self) -> None:
        """End them, and all workers that still run."""
        for server in self._servers.values():
            server.close()


@contextmanager
def warm_processes() -> Iterator[None]:
    """Within it, :class:`WarmProcesses` start the workers, if processes can be forked and nothing else starts them."""
    with ExitStack() as running:
        if can_serve() and are_spawned():
            processes = WarmProcesses()
            running.callback(processes.close)
            running.enter_context(started_by(processes.start))
        yield


_KEPT = ExitStack()
"""Never closed: the processes that it keeps end with this one."""


def stay_warm() -> None:
    """Start workers from :class:`WarmProcesses` until this process ends: it converts one robot after the other."""
    _KEPT.enter_context(warm_processes())


def _imports(function: str) -> tuple[str, ...]:
    """Modules to load for a worker; empty for one that no conversion needs."""
    from stepbot.engines.prestart import shared_imports
    from stepbot.geometry.mesh_worker import MESH_WORKER

    module = function.partition(":")[0]
    if function == KERNEL:
        return (module,)
    if function == MESH_WORKER:
        return (f"{module}:prepare",)
    return shared_imports() if function.startswith(_ENGINES) else ()


_STEP = re.compile(r"""^step:[ \t]*(?:"([^"\n]+)"|'([^'\n]+)'|([^\s"'#][^\n#]*))""", re.MULTILINE)
_LARGEST_SIDECAR = 1 << 20


def started_kernel(sidecar: Path, options: Options) -> Worker | None:
    """A process that is loading the kernel; None if none will be needed, as far as can be determined."""
    step = options.step or _guessed_step(sidecar)
    if step is None or not is_file(step):
        return None
    if options.cache is not None and options.cache.get(_read_key(input_digest(step) or "")) is not None:
        return None  # the cache has its geometry, for any read options
    return Worker(KERNEL, memory_limit=options.memory_limit)


def started_server(options: Options) -> ForkServer | None:
    """A process that will start the engines; None if there will be none, or if forking is not possible."""
    if not options.verify:
        return None
    from stepbot.engines.prestart import started_engine_server

    return started_engine_server()


def note_read(cache: Cache | None, content: str) -> None:
    """Record that the cache has geometry of a STEP with this hash."""
    if cache is not None:
        cache.put(_read_key(content), b"")


def _read_key(content: str) -> str:
    return Digest("was read").add(environment(), content).key


def _guessed_step(sidecar: Path) -> Path | None:
    try:
        with open_regular(sidecar) as file:
            text = file.read(_LARGEST_SIDECAR).decode("utf-8-sig", "replace")
    except OSError:
        return None
    match = _STEP.search(text)
    return sidecar.parent / (match[1] or match[2] or match[3]).strip() if match is not None else None
