"""Values of one type in a cache."""

from typing import Generic, TypeVar

from .codec import Undecodable, codec_of
from .store import Cache

T = TypeVar("T")


class TypedCache(Generic[T]):
    """Takes and gives values where a :class:`Cache` has bytes; without a cache it stays empty."""

    def __init__(self, cache: Cache | None, kind: type[T]) -> None:
        self._cache, self._kind = cache, kind

    def get(self, key: str) -> T | None:
        """What is kept under a key; None where there is nothing, or nothing that can be understood."""
        data = self._cache.get(key) if self._cache is not None else None
        if data is None:
            return None
        try:
            return codec_of(self._kind).decode(data)
        except Undecodable:
            return None

    def put(self, key: str, value: T) -> None:
        """Keep a value."""
        if self._cache is not None:
            self._cache.put(key, codec_of(self._kind).encode(value))
