"""Cached observations: the same bytes and the same request give the same result."""

from collections.abc import Mapping
from dataclasses import replace

from stepbot.runtime.cache import Cache, Digest, TypedCache, codec_of, environment

from . import Engine
from .observation import Observation, Request


class ObservationCache:
    """The observations in a cache."""

    def __init__(self, cache: Cache | None, contents: Mapping[str, str]) -> None:
        """Cache the observations of some files.

        Args:
            cache: The cache; None to disable it.
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
