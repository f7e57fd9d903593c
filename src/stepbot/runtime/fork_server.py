"""Starts workers by forking a process that has already imported their common modules.

A worker of :mod:`stepbot.runtime.worker` spends most of a second on imports, and a conversion needs ten workers: here
the imports are done once, and shared. The server runs one thread and only imports; each worker is still a separate
process, with its own memory limit and crashes. On systems without safe forking there is no server, and workers are
started one by one; the same applies if an import in the server has started threads.
"""

import contextlib
import ctypes
import gc
import importlib
import os
import pickle
import select
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Sequence
from typing import BinaryIO, NoReturn

from .processes import can_fork, end_with_parent, interpreter, start_process, thread_count, worker_environment
from .worker import Process, answer, spawned, worker_command

_MOST_BYTES = 1 << 16
"""Maximum size [bytes] of a message to the server."""
_NUMBER = struct.Struct("<i")
_DESCRIPTORS = 4
"""Number of descriptors in a fork request: standard input, output, error, and a pipe for the process's state."""
_NAME_LENGTH = 15
_PR_SET_NAME = 15


def can_serve() -> bool:
    """Whether there can be a server on this system."""
    return can_fork() and hasattr(socket, "SOCK_SEQPACKET") and hasattr(socket, "send_fds")


class ForkServer:
    """A process that forks workers."""

    def __init__(self, modules: Sequence[str]) -> None:
        """Start the server, which begins to import at once.

        Args:
            modules: Imports for the workers: ``package.module``, or ``package.module:function`` to also call a
                function. A failure is left to the workers to report.
        """
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        code = "from stepbot.runtime.fork_server import _serve; _serve()"
        command = interpreter(code, str(os.getpid()), str(theirs.fileno()), *modules)
        with theirs:
            self._server = start_process(
                lambda: subprocess.Popen(
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    pass_fds=[theirs.fileno()],
                    env=worker_environment(),
                )
            )

    def fork(self, function: str, memory_limit: int | None, stderr: BinaryIO) -> Process:
        """Start a worker's process; see :data:`.worker.Start`.

        If the server has ended, start an interpreter instead.
        """
        reading, input_end = os.pipe()
        output_end, writing = os.pipe()
        state, report = os.pipe()
        try:
            order = pickle.dumps(("fork", state, function, memory_limit))
            socket.send_fds(self._socket, [order], [reading, writing, stderr.fileno(), report])
        except OSError:
            for end in (input_end, output_end, state):
                os.close(end)
            return spawned(function, memory_limit, stderr)
        finally:
            for end in (reading, writing, report):
                os.close(end)
        return _Forked(self, state, os.fdopen(input_end, "wb"), os.fdopen(output_end, "rb"))

    def kill(self, number: int) -> None:
        """End the process whose state pipe is descriptor ``number``, unless it has ended."""
        with contextlib.suppress(OSError):  # without its server it ends by itself
            self._socket.send(pickle.dumps(("kill", number)))

    def close(self) -> None:
        """End the server and all of its running processes; safe to call twice."""
        self._socket.close()
        self._server.kill()
        self._server.wait()

    def __enter__(self) -> "ForkServer":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class _Forked:
    """A forked process with the interface of :class:`subprocess.Popen`."""

    def __init__(self, server: ForkServer, state: int, stdin: BinaryIO, stdout: BinaryIO) -> None:
        self.stdin, self.stdout = stdin, stdout
        self._server, self._state = server, state
        self._pid = 0
        self._status: int | None = None

    @property
    def pid(self) -> int:
        """Its process id; waits until it is forked."""
        if not self._pid:
            self._pid = self._next() or -1
        return self._pid

    def poll(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        while self._status is None and select.select([self._state], [], [], 0.0)[0]:
            self._step()
        return self._status

    def wait(self) -> int:
        """Its exit code, once it has ended."""
        while self._status is None:
            self._step()
        return self._status

    def kill(self) -> None:
        """End it."""
        if self._status is None:
            self._server.kill(self._state)

    def _step(self) -> None:
        if not self._pid:
            self._pid = self._next() or -1
            return
        status = self._next()
        os.close(self._state)
        self._status = -signal.SIGKILL if status is None else status  # it ends with its server

    def _next(self) -> int | None:
        message = os.read(self._state, _NUMBER.size) if self._status is None else b""
        return _NUMBER.unpack(message)[0] if message else None


class _Children:
    """The server's running processes."""

    def __init__(self) -> None:
        self._reports: dict[int, tuple[int, int]] = {}
        """For each process, the client's id and the pipe for its state."""

    def add(self, pid: int, number: int, report: int) -> None:
        self._reports[pid] = number, report
        _tell(report, pid)

    def kill(self, number: int) -> None:
        for pid, (called, _) in self._reports.items():
            if called == number:
                os.kill(pid, signal.SIGKILL)

    def reap(self) -> None:
        """Report the processes that have ended."""
        while self._reports:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if not pid:
                return
            _, report = self._reports.pop(pid)
            _tell(report, os.waitstatus_to_exitcode(status))
            os.close(report)

    def forget(self) -> None:
        """In a forked process: close the descriptors of the others."""
        for _, report in self._reports.values():
            os.close(report)


def _tell(report: int, value: int) -> None:
    with contextlib.suppress(BrokenPipeError):  # the client has closed its end
        os.write(report, _NUMBER.pack(value))


def _serve() -> NoReturn:
    """The server's main function."""
    end_with_parent(int(sys.argv[1]))
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends when its socket is closed
    orders = socket.socket(fileno=int(sys.argv[2]))
    woken, waking = os.pipe()
    os.set_blocking(waking, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(waking)
    gc.disable()
    for module in sys.argv[3:]:
        _prepare(module)
    gc.freeze()  # memory that nobody writes to stays shared
    children = _Children()
    while True:
        ready = select.select([orders.fileno(), woken], [], [])[0]
        if woken in ready:
            os.read(woken, 1024)
            children.reap()
        if orders.fileno() in ready:
            message, descriptors, _, _ = socket.recv_fds(orders, _MOST_BYTES, _DESCRIPTORS)
            if not message:
                os._exit(0)
            verb, number, *rest = pickle.loads(message)
            if verb == "kill":
                children.kill(number)
                continue
            *streams, report = descriptors
            if thread_count() > 1:  # an import started threads: a fork could inherit their locks
                pid = _spawn(streams, *rest)
            else:
                server = os.getpid()
                pid = os.fork()
                if pid == 0:
                    end_with_parent(server)
                    for descriptor in (orders.detach(), woken, waking, report):
                        os.close(descriptor)
                    children.forget()
                    _work(streams, *rest)
            children.add(pid, number, report)
            for descriptor in streams:
                os.close(descriptor)


def _prepare(module: str) -> None:
    with contextlib.suppress(Exception):  # the worker that needs it fails in the same way, and reports it
        name, _, function = module.partition(":")
        loaded = importlib.import_module(name)
        if function:
            getattr(loaded, function)()


def _spawn(streams: Sequence[int], function: str, memory_limit: int | None) -> int:
    """Start a worker as a new interpreter; returns its process id."""
    copies = [(os.POSIX_SPAWN_DUP2, stream, descriptor) for descriptor, stream in enumerate(streams)]
    defaults = [signal.SIGCHLD, signal.SIGINT]
    command = worker_command(function, memory_limit)
    return os.posix_spawn(command[0], command, os.environ, file_actions=copies, setsigdef=defaults)


def _work(streams: Sequence[int], function: str, memory_limit: int | None) -> NoReturn:
    """Serve one call in a forked process."""
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        for descriptor, stream in enumerate(streams):
            os.dup2(stream, descriptor)
            os.close(stream)
        # Set the name shown in process lists; on Linux.
        if sys.platform == "linux":
            name = ".".join(function.partition(":")[0].split(".")[-2:])  # mujoco.observer
            ctypes.CDLL(None).prctl(_PR_SET_NAME, name.encode()[:_NAME_LENGTH])
        answer(function, memory_limit)
    finally:  # must never return into the server's code
        os._exit(1)
