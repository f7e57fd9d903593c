"""Values of a JSON document, type-checked on access."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any, TypeVar

from stepbot.geometry.spatial import Vector3

Json = dict[str, Any]
_T = TypeVar("_T")


@dataclass
class Invalid(Exception):
    """The content has the wrong type or structure."""

    what: str
    line: int = 0

    def __str__(self) -> str:
        return self.what


class Record:
    """A JSON object with its position; values of a wrong type are errors."""

    def __init__(self, value: object, where: str) -> None:
        if not isinstance(value, dict):
            raise Invalid(f"{where or 'top level'}: expected an object")
        self._value: Json = value
        self._where = where

    @property
    def keys(self) -> list[str]:
        """All keys."""
        return list(self._value)

    def place(self, key: str) -> str:
        """The path from the root to the value at a key."""
        return f"{self._where}.{key}" if self._where else key

    def record(self, key: str) -> "Record":
        """The object at a key."""
        return Record(self._get(key), self.place(key))

    def records(self, key: str, made: "Callable[[Record], _T]") -> tuple[_T, ...]:
        """The list of objects at a key, each converted."""
        return tuple(made(Record(one, f"{self.place(key)}[{i}]")) for i, one in enumerate(self._listed(key)))

    def text(self, key: str) -> str:
        """The text at a key."""
        return self._typed(key, self._get(key), str, "text")

    def texts(self, key: str) -> tuple[str, ...]:
        """The list of texts at a key."""
        return tuple(self._typed(key, one, str, "text") for one in self._listed(key))

    def flag(self, key: str) -> bool:
        """The truth value at a key."""
        return self._typed(key, self._get(key), bool, "true or false")

    def integer(self, key: str) -> int:
        """The whole number at a key."""
        value = self._get(key)
        if isinstance(value, bool):
            raise Invalid(f"{self.place(key)}: expected a whole number")
        return self._typed(key, value, int, "a whole number")

    def number(self, key: str) -> float:
        """The finite number at a key."""
        return self._number(key, self._get(key))

    def numbers(self, key: str, count: int) -> list[float]:
        """The list of a given number of numbers at a key."""
        return [self._number(key, one) for one in self._listed(key, count)]

    def vector(self, key: str) -> Vector3:
        """The three numbers at a key."""
        return self._vector(key, self._get(key))

    def vectors(self, key: str, count: int) -> list[Vector3]:
        """The list of a given number of vectors at a key."""
        return [self._vector(key, one) for one in self._listed(key, count)]

    def is_null(self, key: str) -> bool:
        """Whether the value at a key is null."""
        return self._get(key) is None

    def _get(self, key: str) -> object:
        if key not in self._value:
            raise Invalid(f"{self.place(key)}: missing")
        return self._value[key]

    def _listed(self, key: str, count: int | None = None) -> list[object]:
        value: list[object] = self._typed(key, self._get(key), list, "a list")
        if count is not None and len(value) != count:
            raise Invalid(f"{self.place(key)}: expected {count} values")
        return value

    def _vector(self, key: str, value: object) -> Vector3:
        values: list[object] = self._typed(key, value, list, "three numbers")
        if len(values) != 3:
            raise Invalid(f"{self.place(key)}: expected three numbers")
        x, y, z = (self._number(key, one) for one in values)
        return x, y, z

    def _number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not _is_finite(value):
            raise Invalid(f"{self.place(key)}: expected a number")
        return float(value)

    def _typed(self, key: str, value: object, kind: type[_T], words: str) -> _T:
        if not isinstance(value, kind):
            raise Invalid(f"{self.place(key)}: expected {words}")
        return value


def _is_finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:
        return False
