r"""Encodes structs, named tuples and arrays as bytes, and decodes them by their annotations alone.

    lengths of the text and of the numbers [8 bytes each] | text: JSON | numbers | bytes of all arrays in turn

The numbers are the floating-point ones of the value in the order in which they occur: as text each takes a microsecond.
Nothing in the bytes names a class or a function, so reading them runs no code; data that does not match the annotations
raises :class:`Undecodable`. Numbers come back as the same doubles, infinities and all.
"""

import json
import types
from array import array
from collections.abc import Callable, Hashable, Iterator, Mapping
from enum import Enum
from functools import cache
from itertools import islice
from typing import Any, Generic, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from .store import Cache

T = TypeVar("T")
Plain = Any
"""Values that JSON can represent."""

_LENGTH = 8
_ALIGNMENT = 8
_ARRAYS = "biuf"
"""Kinds of numpy data types that arrays may have: booleans and numbers, no objects."""
_FORGIVEN = (ValueError, TypeError, KeyError, IndexError, OverflowError, RecursionError, StopIteration)


class Undecodable(Exception):
    """The bytes do not represent a value of the type."""


class _Blobs:
    """What follows the text."""

    def __init__(self, numbers: bytes | memoryview = b"", data: bytes | memoryview = b"") -> None:
        self.numbers = array("d")
        self.numbers.frombytes(numbers)
        self.left: Iterator[float] = iter(self.numbers)
        """Those that are not decoded yet."""
        self.parts: list[bytes] = []
        self._length = 0
        self._data = memoryview(data)

    def add(self, content: bytes) -> tuple[int, int]:
        """Append bytes; returns their offset and length."""
        start = self._length
        padding = -len(content) % _ALIGNMENT
        self.parts += (content, bytes(padding))
        self._length += len(content) + padding
        return start, len(content)

    def get(self, start: int, length: int) -> memoryview:
        """The bytes of one part."""
        if not 0 <= start <= start + length <= len(self._data):
            raise ValueError("beyond the end")
        return self._data[start : start + length]


Encoder = Callable[[Any, _Blobs], Plain]
Decoder = Callable[[Plain, _Blobs], Any]


class Codec(Generic[T]):
    """Encodes values of one type."""

    def __init__(self, kind: Any) -> None:
        self._encode, self._decode = _pair(kind)

    def encode(self, value: T) -> bytes:
        """The value as bytes; equal values give equal bytes."""
        blobs = _Blobs()
        text = json.dumps(self._encode(value, blobs), ensure_ascii=False, separators=(",", ":"))
        head = text.encode("utf-8", "surrogatepass")
        head += b" " * (-len(head) % _ALIGNMENT)
        numbers = blobs.numbers.tobytes()
        lengths = (len(part).to_bytes(_LENGTH, "little") for part in (head, numbers))
        return b"".join((*lengths, head, numbers, *blobs.parts))

    def decode(self, data: bytes) -> T:
        """The value; its arrays are read-only, and share the memory of ``data``.

        Raises:
            Undecodable: The bytes represent something else.
        """
        try:
            start = 2 * _LENGTH
            middle = start + int.from_bytes(data[:_LENGTH], "little")
            end = middle + int.from_bytes(data[_LENGTH:start], "little")
            text = data[start:middle].decode("utf-8", "surrogatepass")
            blobs = _Blobs(memoryview(data)[middle:end], memoryview(data)[end:])
            return cast(T, self._decode(json.loads(text), blobs))
        except _FORGIVEN as error:
            raise Undecodable(f"{type(error).__name__}: {error}") from error


def codec_of(kind: type[T]) -> Codec[T]:
    """The codec of a type; a type that is not fully described by annotations is a bug, and a TypeError."""
    return cast(Codec[T], _codec(cast(Hashable, kind)))


@cache
def _codec(kind: Any) -> Codec[Any]:
    return Codec(kind)


@cache
def _pair(kind: Any) -> tuple[Encoder, Decoder]:
    kind = _expanded(kind)
    origin, arguments = get_origin(kind), get_args(kind)
    if kind in (bool, int, str):
        return lambda value, blobs: kind(value), _checked(kind)
    if kind is float:
        return _encode_number, _decode_number
    if kind is bytes:
        return lambda value, blobs: blobs.add(value), lambda plain, blobs: bytes(blobs.get(*plain))
    if kind is None or kind is type(None):
        return lambda value, blobs: None, _none
    if origin is Literal:
        return lambda value, blobs: value, _one_of(arguments)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return lambda value, blobs: value.value, lambda plain, blobs: kind(plain)
    if origin is tuple:
        return _tuple(arguments)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _mapping(*arguments)
    if origin in (Union, types.UnionType):
        return _union(arguments)
    if _is_record(kind):
        return _record(kind)
    if getattr(origin or kind, "__module__", "") == "numpy" and (origin or kind).__name__ == "ndarray":
        return _encode_array, _decode_array
    raise TypeError(f"no codec for {kind}")


def _expanded(kind: Any) -> Any:
    """A type with aliases resolved: numpy's ``NDArray`` since 2.5 is one, ``type Name[...] = ...``."""
    while (value := getattr(get_origin(kind) or kind, "__value__", None)) is not None:
        arguments = get_args(kind)
        kind = value[arguments] if arguments else value
    return kind


def _checked(kind: type) -> Decoder:
    def decode(plain: Plain, blobs: _Blobs) -> Any:  # noqa: ARG001
        if type(plain) is not kind:
            raise TypeError(f"{kind.__name__} expected")
        return plain

    return decode


def _none(plain: Plain, blobs: _Blobs) -> None:  # noqa: ARG001
    if plain is not None:
        raise TypeError("null expected")


def _one_of(values: tuple[Any, ...]) -> Decoder:
    def decode(plain: Plain, blobs: _Blobs) -> Any:  # noqa: ARG001
        if plain not in values:
            raise ValueError("not one of the values")
        return plain

    return decode


def _tuple(arguments: tuple[Any, ...]) -> tuple[Encoder, Decoder]:
    if len(arguments) == 2 and arguments[1] is ...:
        encode_one, decode_one = _pair(arguments[0])
        return (
            lambda value, blobs: [encode_one(one, blobs) for one in value],
            lambda plain, blobs: tuple([decode_one(one, blobs) for one in _list(plain)]),
        )
    if arguments and set(arguments) == {float}:
        return _vector(len(arguments))
    encoders, decoders = zip(*map(_pair, arguments), strict=True) if arguments else ((), ())
    return (
        lambda value, blobs: [encode(one, blobs) for encode, one in zip(encoders, value, strict=True)],
        lambda plain, blobs: tuple([decode(one, blobs) for decode, one in zip(decoders, _list(plain), strict=True)]),
    )


def _vector(length: int) -> tuple[Encoder, Decoder]:
    """Of so many numbers, at once."""

    def encode(value: Any, blobs: _Blobs) -> Plain:
        if len(value) != length:
            raise ValueError(f"{length} numbers expected")
        if all(type(one) is float for one in value):
            blobs.numbers.extend(value)
            return None
        return [_encode_number(one, blobs) for one in value]

    def decode(plain: Plain, blobs: _Blobs) -> Any:
        value = (
            tuple(islice(blobs.left, length))
            if plain is None
            else tuple([_decode_number(one, blobs) for one in _list(plain)])
        )
        if len(value) != length:
            raise ValueError(f"{length} numbers expected")
        return value

    return encode, decode


def _encode_number(value: Any, blobs: _Blobs) -> int | None:
    """Unchanged: an integer 1 in place of 1.0 stays an integer, in the text."""
    if isinstance(value, float):
        blobs.numbers.append(value)
        return None
    if type(value) is not int:
        raise TypeError("a number expected")
    return value


def _decode_number(plain: Plain, blobs: _Blobs) -> float | int:
    if plain is None:
        return next(blobs.left)
    if type(plain) is not int:
        raise TypeError("a number expected")
    return plain


def _list(plain: Plain) -> list[Any]:
    if not isinstance(plain, list):
        raise TypeError("a list expected")
    return plain


def _mapping(key: Any, value: Any) -> tuple[Encoder, Decoder]:
    encode_key, decode_key = _pair(key)
    encode_value, decode_value = _pair(value)
    return (
        lambda mapping, blobs: [[encode_key(k, blobs), encode_value(v, blobs)] for k, v in mapping.items()],
        lambda plain, blobs: {decode_key(k, blobs): decode_value(v, blobs) for k, v in _list(plain)},
    )


def _union(arguments: tuple[Any, ...]) -> tuple[Encoder, Decoder]:
    """A value or None, or one of several structs or named tuples, distinguished by their names."""
    others = [argument for argument in arguments if argument is not type(None)]
    if len(others) == 1:
        encode_one, decode_one = _pair(others[0])
        return (
            lambda value, blobs: None if value is None else [encode_one(value, blobs)],
            lambda plain, blobs: None if plain is None else decode_one(_list(plain)[0], blobs),
        )
    if not all(map(_is_record, others)):
        raise TypeError(f"no codec for a union of {arguments}")
    pairs = {other.__name__: _pair(other) for other in others}
    return (
        lambda value, blobs: (
            None if value is None else [type(value).__name__, pairs[type(value).__name__][0](value, blobs)]
        ),
        lambda plain, blobs: None if plain is None else pairs[_list(plain)[0]][1](plain[1], blobs),
    )


def _is_record(kind: Any) -> bool:
    """Whether a type is a struct or a named tuple."""
    return isinstance(kind, type) and (
        hasattr(kind, "__struct_fields__") or (issubclass(kind, tuple) and hasattr(kind, "_fields"))
    )


def _record(kind: Any) -> tuple[Encoder, Decoder]:
    names: tuple[str, ...] = kind.__match_args__  # those that the constructor takes, in order
    pairs: list[tuple[Encoder, Decoder]] = []

    def encode(value: Any, blobs: _Blobs) -> Plain:
        prepare()
        return [pair[0](getattr(value, name), blobs) for name, pair in zip(names, pairs, strict=True)]

    def decode(plain: Plain, blobs: _Blobs) -> Any:
        prepare()
        return kind(*[pair[1](one, blobs) for pair, one in zip(pairs, _list(plain), strict=True)])

    def prepare() -> None:
        if not pairs:  # lazily: a class may contain itself, and most data have no value of some
            hints = get_type_hints(kind)
            pairs.extend(_pair(hints[name]) for name in names)

    return encode, decode


def _encode_array(value: Any, blobs: _Blobs) -> Plain:
    if value.dtype.kind not in _ARRAYS:
        raise TypeError(f"no codec for an array of {value.dtype}")
    start, length = blobs.add(value.tobytes())
    return [value.dtype.str, list(value.shape), start, length]


def _decode_array(plain: Plain, blobs: _Blobs) -> Any:
    import numpy as np

    name, shape, start, length = _list(plain)
    kind = np.dtype(name)
    if kind.kind not in _ARRAYS:
        raise TypeError(f"an array of {kind}")
    array = np.frombuffer(blobs.get(start, length), kind).reshape(shape)
    array.setflags(write=False)
    return array


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
