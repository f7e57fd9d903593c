"""Values of one type in a cache."""

from typing import Generic, TypeVar

from .codec import Undecodable, codec_of
from .store import Cache

T = TypeVar("T")


class TypedCache(Generic[T]):
    """A :class:`Cache` of values instead of bytes; without a cache it stays empty."""

    def __init__(self, cache: Cache | None, kind: type[T]) -> None:
        self._cache, self._kind = cache, kind

    def get(self, key: str) -> T | None:
        """The value under a key; None if it is missing or cannot be decoded."""
        data = self._cache.get(key) if self._cache is not None else None
        if data is None:
            return None
        try:
            return codec_of(self._kind).decode(data)
        except Undecodable:
            return None

    def put(self, key: str, value: T) -> None:
        """Store a value."""
        if self._cache is not None:
            self._cache.put(key, codec_of(self._kind).encode(value))
