"""Worker processes of commands that run inside pytest, forked from processes that have loaded kernel and engines.

To load them takes longer than most tests. A worker gets the current folder and the environment that the test has when
it starts, as a worker of a command does; the cores are busy with other tests, and it divides its work among no
processes of its own. Commands in processes of their own (:mod:`tests.command_line`) start theirs as
for every user.
"""

import base64
import importlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

from stepbot.engines.prestart import shared_imports
from stepbot.runtime import parallel, worker
from stepbot.runtime.fork_server import ForkServer, can_serve

_KERNEL = ("stepbot.step.worker", "stepbot.geometry.mesh_worker", "stepbot.geometry.mesh_files")
_REFERENCES = "stepbot.engines.file_references"
_YOURDFPY = "stepbot.engines.yourdfpy.observer"
_DESCRIBE = "stepbot.engines.describe"


class WarmProcesses:
    """Servers that fork workers, started when the first worker is."""

    def __init__(self) -> None:
        self._environment = dict(os.environ)

    @cached_property
    def _kernel(self) -> ForkServer:
        return ForkServer([*_KERNEL, "trimesh", __name__])

    @cached_property
    def _engines(self) -> ForkServer:
        return ForkServer([*shared_imports(), _REFERENCES, __name__])

    @cached_property
    def _yourdfpy(self) -> ForkServer:
        """For those alone that load trimesh without packages that other workers need."""
        return ForkServer([f"{_YOURDFPY}:prepare", _DESCRIBE, __name__])

    def _server(self, function: str) -> ForkServer:
        if function.startswith((_YOURDFPY, _DESCRIBE)):
            return self._yourdfpy
        return self._kernel if function.startswith(_KERNEL) else self._engines

    def start(self, function: str, memory_limit: int | None, stderr: BinaryIO) -> worker.Process:
        """Start a worker; see :data:`stepbot.runtime.worker.Start`."""
        if not can_serve():
            return worker.spawned(function, memory_limit, stderr)
        changes = {name: value for name, value in os.environ.items() if self._environment.get(name) != value}
        removed: dict[str, None] = dict.fromkeys(self._environment.keys() - os.environ.keys())
        return self._server(function).fork(_named(function, str(Path.cwd()), changes | removed), memory_limit, stderr)

    def close(self) -> None:
        """End the servers."""
        for name in ("_kernel", "_engines", "_yourdfpy"):
            if (server := self.__dict__.get(name)) is not None:
                server.close()


@contextmanager
def warm_processes() -> Iterator[None]:
    """All workers of this process are started by :class:`WarmProcesses`."""
    processes = WarmProcesses()
    with worker.started_by(processes.start):
        yield
    processes.close()


@contextmanager
def cold_processes() -> Iterator[None]:
    """Workers are started as for every user."""
    with worker.started_by(worker.spawned):
        yield


def _named(function: str, folder: str, changes: dict[str, str | None]) -> str:
    """A name in this module for ``function`` that is called in a folder, with some environment variables changed."""
    order = json.dumps((function, folder, changes)).encode()
    return f"{__name__}:{base64.urlsafe_b64encode(order).decode()}"


def __getattr__(name: str) -> Callable[..., Any]:
    """In a worker: the function of a name that :func:`_named` has made."""
    try:
        function, folder, changes = json.loads(base64.urlsafe_b64decode(name))
    except ValueError:
        raise AttributeError(name) from None
    os.chdir(folder)
    for variable, value in changes.items():
        if value is None:
            os.environ.pop(variable, None)
        else:
            os.environ[variable] = value
    tempfile.tempdir = None
    parallel.core_count = lambda: 1
    module, _, attribute = function.partition(":")
    loaded = importlib.import_module(module)
    getattr(loaded, "prepare", lambda: None)()
    call: Callable[..., Any] = getattr(loaded, attribute)
    return call
