"""Runs the engines: one process for each engine and file, started before there is anything to observe.

An engine that is missing, rejects a file or crashes is a result like any other: the others continue.
"""

from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.runtime.cache import Cache, Digest, TypedCache, codec_of, environment
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import RemoteError, Start, Worker, WorkerDied

from . import Engine, engines, engines_for
from .observation import EngineRefused, Observation, Request


class ObservationCache:
    """The observations in a cache."""

    def __init__(self, cache: Cache | None, contents: Mapping[str, str]) -> None:
        """Cache the observations of some files.

        Args:
            contents: For each file, by the caller's name for it, a hash of its bytes and of everything it refers to.
        """
        self.cache = cache
        self._results, self._contents = TypedCache(cache, Observation), dict(contents)

    def get(self, key: str, engine: Engine, request: Request) -> Observation | None:
        """The cached observation of this engine and version; None if there is none."""
        entry = self._key(key, engine, request)
        return self._results.get(entry) if entry is not None else None

    def put(self, key: str, engine: Engine, request: Request, observation: Observation) -> None:
        """Store an observation."""
        entry = self._key(key, engine, request)
        if entry is not None:
            self._results.put(entry, observation)

    def _key(self, key: str, engine: Engine, request: Request) -> str | None:
        if self.cache is None or key not in self._contents:
            return None
        asked = codec_of(Request).encode(replace(request, file=""))
        return Digest("observation").add(environment(), engine.name, self._contents[key], asked).key


class Fate(StrEnum):
    """The outcome of an engine and a file."""

    OBSERVED = "observed"
    ABSENT = "absent"
    """The engine is not installed, or does not start."""
    UNREADABLE = "unreadable"
    """The engine is known not to support such a file; not a fault of the file."""
    REFUSED = "refused"
    """The engine rejected the file."""
    DIED = "died"
    """The engine crashed, was killed, or timed out."""
    BROKEN = "broken"
    """stepbot's own code around the engine failed."""


class Outcome(Struct, frozen=True, eq=False):
    """The result of one engine for one file."""

    key: str
    """The caller's name for the file."""
    format: str
    engine: str
    fate: Fate
    observation: Observation | None = None
    reason: str = ""
    """Why there is no observation."""
    last_lines: tuple[str, ...] = ()
    """The last output of a crashed engine, or the end of the traceback."""
    help: tuple[str, ...] = ()
    """What helps, if that is known."""


class Engines:
    """Started workers, waiting for their requests."""

    def __init__(self, files: Mapping[str, str], memory_limit: int | None = None, start: Start | None = None) -> None:
        """Start a worker for every file and every available engine that reads its format.

        Args:
            files: The caller's name for each file, and its format.
            memory_limit: Address space [bytes] of each worker; None for no limit.
            start: What starts their processes; None to start new interpreters.
        """
        self._files: dict[str, str] = {}
        self._memory_limit, self._start = memory_limit, start
        self._asked: dict[str, Request] = {}
        self._cache = ObservationCache(None, {})
        self._cached: dict[tuple[str, str], Observation] = {}
        self._absent: dict[str, str] = {}
        self._workers: dict[tuple[str, str], Worker] = {}
        self.start(files)

    def start(self, files: Mapping[str, str]) -> None:
        """Start workers for further files; known files keep theirs."""
        for key, written_in in files.items():
            if key in self._files:
                continue
            self._files[key] = written_in
            for engine in engines_for(written_in):
                reason = engine.available()
                if reason is None:
                    function = engine.observe_function
                    worker = Worker(function, memory_limit=self._memory_limit, start=self._start)
                    self._workers[key, engine.name] = worker
                else:
                    self._absent[engine.name] = reason

    def submit(self, requests: Mapping[str, Request], cache: ObservationCache | None = None) -> None:
        """Send every worker the request for its file; returns at once.

        Args:
            requests: The request for each file to observe, by the caller's name for it.
            cache: Cached observations; engines with a cached result are not run again.
        """
        self._asked = {key: requests[key] for key in self._files if key in requests}
        self._cache = cache or self._cache
        for key, request in self._asked.items():
            for engine in engines_for(self._files[key]):
                self._ask(key, engine, request)

    def _ask(self, key: str, engine: Engine, request: Request) -> None:
        worker = self._workers.get((key, engine.name))
        if worker is None:
            return
        cached = self._cache.get(key, engine, request)
        if cached is None:
            worker.submit(request)
        else:
            worker.close()
            self._cached[key, engine.name] = cached

    def results(self, timeout: float = DEFAULT_TIMEOUT) -> Iterator[Outcome]:
        """Wait for one worker after the other, each of which may take ``timeout`` [s]; by file, then by engine."""
        for key in self._asked:
            for engine in engines_for(self._files[key]):
                yield self._outcome(key, engine, timeout)

    def close(self) -> None:
        """End all workers that still run."""
        for worker in self._workers.values():
            worker.close()

    def __enter__(self) -> "Engines":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _outcome(self, key: str, engine: Engine, timeout: float) -> Outcome:
        written_in, name = self._files[key], engine.name
        if name in self._absent:
            return Outcome(key, written_in, name, Fate.ABSENT, reason=self._absent[name])
        if (key, name) in self._cached:
            return Outcome(key, written_in, name, Fate.OBSERVED, self._cached[key, name])
        try:
            observation = self._workers[key, name].result(timeout)
        except WorkerDied as death:
            return Outcome(key, written_in, name, Fate.DIED, reason=death.reason, last_lines=death.last_lines)
        except RemoteError as error:
            fate = _FATES.get(error.kind, Fate.BROKEN)
            lines = tuple(error.trace.splitlines()[-6:]) if fate is Fate.BROKEN else ()
            reason, *help = (error.text or error.kind).split(EngineRefused.HELP)
            return Outcome(key, written_in, name, fate, reason=reason, last_lines=lines, help=tuple(help))
        self._cache.put(key, engine, self._asked[key], observation)
        return Outcome(key, written_in, name, Fate.OBSERVED, observation)


_FATES = {
    "EngineRefused": Fate.REFUSED,
    "EngineCannotRead": Fate.UNREADABLE,
    "ImportError": Fate.ABSENT,
    "ModuleNotFoundError": Fate.ABSENT,
}


def check_required(names: Iterable[str], diagnostics: Diagnostics) -> None:
    """Report required engines that are unknown or not installed (SB005)."""
    known = {engine.name: engine for engine in engines()}
    for name in names:
        engine = known.get(name.lower())
        if engine is None:
            help = did_you_mean(name.lower(), known) or (f"engines: {', '.join(known)}",)
            diagnostics.add("SB005", f"--require {name}: no such engine", Span("stepbot"), help=help)
            continue
        reason = engine.available()
        if reason is not None:
            install = engine.install or f"pip install {engine.name}"
            diagnostics.add("SB005", f"--require {name}: {reason}", Span("stepbot"), help=(install,))


def check_started(required: Iterable[str], outcomes: Iterable[Outcome], diagnostics: Diagnostics) -> None:
    """Report required engines that are installed but did not start (SB005)."""
    installed = {engine.name for engine in engines() if engine.available() is None}
    wanted = {name.lower() for name in required} & installed
    for outcome in outcomes:
        if outcome.engine in wanted and outcome.fate is Fate.ABSENT:
            diagnostics.add("SB005", f"--require {outcome.engine}: {outcome.reason}", Span("stepbot"))
