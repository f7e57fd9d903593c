"""Whether an engine or an independent parser detects that something is missing in a file."""

import json
import os
import select
import signal
import time
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from types import TracebackType
from typing import Any

from msgspec.structs import replace

from stepbot.engines import engine_of
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Observation, Request
from stepbot.engines.sdformat_reader import tree as _sdf_tree
from stepbot.verification.compare import compare

SECONDS = 60.0
"""Time limit [s] of an engine; exceeding it counts as detected."""
CONFIGURATIONS = 3
GUARDED, UNGUARDED = "+", "-"


def question(request: Request) -> Request:
    """The request, reduced to what distinguishes one robot from another."""
    ways = tuple(way[:: max(1, len(way) - 1)] for way in request.ways[:1])
    return replace(request, configurations=request.configurations[:CONFIGURATIONS], ways=ways, simulate=0.0)


class Judge:
    """An engine that checks one file after the other. Requires ``fork``."""

    def __init__(self, engine: str, request: Request, expected: Observation) -> None:
        """Load the engine.

        Args:
            engine: Its name.
            request: The request for every file.
            expected: The expected observation.
        """
        self.engine = engine
        self._module: Any = engine_of(engine).observer
        self._module.prepare()
        self._request, self._expected = request, expected
        self.reads = True
        """Whether it can read files of the kind."""
        self._child = 0
        self._to_child = self._from_child = -1

    def __enter__(self) -> "Judge":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def look_at(self, file: str) -> str:
        """What the engine detects in a file; empty if nothing."""
        # stepbot keeps files that crash an engine away from it. Here the engine itself decides, if it read
        # the file before something was removed.
        return self._asked(file, UNGUARDED if self.reads else GUARDED) or ""

    def look_at_right(self, file: str) -> str:
        """The same for the unchanged file; sets :attr:`reads`."""
        answer = self._asked(file, GUARDED)
        self.reads = answer is not None
        return answer or ""

    def _asked(self, file: str, how: str) -> str | None:
        """What the engine detects; None if stepbot declares that it cannot read the file."""
        if not self._child:
            self._begin()
        os.write(self._to_child, f"{how}{file}\n".encode())
        received, deadline = b"", time.monotonic() + SECONDS
        while not received.endswith(b"\n"):
            ready, _, _ = select.select([self._from_child], [], [], max(0.0, deadline - time.monotonic()))
            chunk = os.read(self._from_child, 65536) if ready else b""
            if not chunk:
                self._end()
                return "dies" if ready else "hangs"
            received += chunk
        answer: str | None = json.loads(received)
        return answer

    def _begin(self) -> None:
        asked, self._to_child = os.pipe()
        self._from_child, answers = os.pipe()
        self._child = os.fork()
        if self._child == 0:
            os.close(self._to_child)
            os.close(self._from_child)
            try:
                os.dup2(os.open(os.devnull, os.O_RDWR), 2)
                with os.fdopen(asked) as files:
                    for line in files:
                        request = replace(self._request, file=line[1:].rstrip("\n"))
                        answer = self._answer(request, guarded=line[0] == GUARDED)
                        os.write(answers, f"{json.dumps(answer)}\n".encode())
            finally:
                os._exit(0)
        os.close(asked)
        os.close(answers)

    def _end(self) -> None:
        if self._child:
            os.close(self._to_child)
            os.close(self._from_child)
            os.kill(self._child, signal.SIGKILL)
            os.waitpid(self._child, 0)
            self._child = 0

    def _answer(self, request: Request, *, guarded: bool) -> str | None:
        try:
            return self._differs(request)
        except EngineCannotRead:
            return None if guarded or request.format != "sdf" else _unguarded(lambda: self._differs(request))

    def _differs(self, request: Request) -> str:
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                observation = self._module.observe(request)
        except EngineRefused as error:
            return f"refuses: {str(error)[:100]}"
        except EngineCannotRead:
            raise
        except Exception as error:  # noqa: BLE001 - in verify, too, an engine that fails fails its check
            return f"fails: {type(error).__name__}: {str(error)[:100]}"
        for one in compare(self._expected, observation):
            if one.deviations.failures and not one.not_run:
                return f"{one.quantity.value}: {str(one.deviations.failures[0])[:100]}"
        return ""


def _unguarded(look: Callable[[], str]) -> str:
    guard = _sdf_tree.check_readable
    _sdf_tree.check_readable = lambda model: None
    try:
        return look()
    except EngineCannotRead as reason:
        return f"reads no robot: {reason}"
    finally:
        _sdf_tree.check_readable = guard
