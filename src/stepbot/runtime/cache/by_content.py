"""Results of computations that are requested together: one computation for equal content, none for what is cached."""

from collections.abc import Hashable, Iterable, Mapping
from typing import Generic, TypeVar

from .codec import TypedCache, codec_of
from .digest import Digest
from .sources import environment
from .store import Cache

N = TypeVar("N", bound=Hashable)
W = TypeVar("W")
T = TypeVar("T")


class ResultsByContent(Generic[N, W, T]):
    """Named computations and their results."""

    def __init__(
        self, cache: Cache | None, purpose: str, wanted: Mapping[N, W], kinds: tuple[type[W], type[T]]
    ) -> None:
        """Look results up in the cache; computes nothing.

        Args:
            purpose: The computation, in words.
        """
        input_kind, kind = kinds
        codec = codec_of(input_kind)
        self._results = TypedCache(cache, kind)
        self._keys = {name: Digest(purpose).add(environment(), codec.encode(one)).key for name, one in wanted.items()}
        distinct = {self._keys[name]: one for name, one in wanted.items()}
        known = {key: self._results.get(key) for key in distinct}
        self._known = {key: one for key, one in known.items() if one is not None}
        self._missing = {key: one for key, one in distinct.items() if key not in self._known}

    @property
    def missing(self) -> tuple[W, ...]:
        """Distinct inputs without a result."""
        return tuple(self._missing.values())

    def add(self, made: Iterable[T]) -> None:
        """Keep and cache the results of :attr:`missing`, in its order."""
        for key, one in zip(self._missing, made, strict=True):
            self._known[key] = one
            self._results.put(key, one)
        self._missing = {}

    def get(self, name: N) -> T | None:
        """The result of a computation; None if it is missing, or unknown."""
        return self._known.get(self._keys.get(name, ""))

    def __getitem__(self, name: N) -> T:
        """The result of a computation.

        Raises:
            KeyError: It is missing.
        """
        return self._known[self._keys[name]]
