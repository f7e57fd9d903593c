"""Processes with the kernel or the engines loaded, kept from one conversion of a batch or a page to the next.

Loading takes longer than the rest of a small conversion. Each worker is still a process of its own, forked from one of
these: they only import.
"""

import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import BinaryIO

from stepbot.runtime.fork_server import ForkServer, can_serve
from stepbot.runtime.worker import Process, are_spawned, spawned, started_by
from stepbot.step import KERNEL

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
