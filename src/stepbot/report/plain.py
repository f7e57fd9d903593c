"""Records as JSON data, and back: an object with a key for each field that a document has."""

from collections.abc import Hashable, Mapping
from enum import Enum, EnumType
from functools import cache
from math import isfinite
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from msgspec import Struct

from stepbot.robot.joint_table import Vector3

T = TypeVar("T")
Json = dict[str, Any]
_AS_IS = (str, int, bool, NoneType)


def plain(value: Any) -> Any:
    """A value as JSON data.

    Records have all their fields, enumerations are their values, poses ``xyz`` and ``rpy``; numbers that are not finite
    are null.

    Raises:
        TypeError: It has no JSON form.
    """
    if type(value) in _AS_IS:
        return value
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple | list):
        return [plain(one) for one in value]
    if isinstance(value, Mapping):
        return {key: plain(one) for key, one in value.items()}
    if hasattr(value, "rpy"):  # a pose, whose class would load numpy
        return {"xyz": list(value.position), "rpy": list(value.rpy)}
    if isinstance(value, Struct):
        return {name: plain(getattr(value, name)) for name in value.__struct_fields__}
    raise TypeError(f"{type(value).__name__} has no JSON form")


def picked(record: Any, keys: str, **instead: Any) -> Json:
    """Some fields of a record as JSON data.

    Args:
        keys: The keys, in order, which name the fields: ``key=field`` where the names differ.
        instead: JSON data for keys that are no field, or another value than it has.
    """
    pairs = (key.partition("=") for key in keys.split())
    return {key: instead[key] if key in instead else plain(getattr(record, name or key)) for key, _, name in pairs}


class Invalid(ValueError):
    """JSON data has another type or structure than expected."""

    def __init__(self, what: str, line: int = 0) -> None:
        """What is expected where; ``line`` of the text, 0 if it is unknown."""
        super().__init__(what)
        self.line = line


def unpicked(
    kind: type[T], document: object, keys: str, where: str = "", *, has_defaults: bool = False, **given: Any
) -> T:
    """A record of what :func:`picked` returned.

    Args:
        keys: Those of :func:`picked`.
        where: Path from the root of the data to the object, for messages.
        has_defaults: Whether null is the default of any field; else of those alone that may be None.
        given: Other fields.

    Raises:
        Invalid: It is none of such a record.
        TypeError: With ``has_defaults``, a field without a default is null.
    """
    hints, values = _hints(cast(Hashable, kind)), dict[str, Any]()
    for key, _, field in (key.partition("=") for key in keys.split()):
        name = field or key
        if name in given:
            continue
        if name not in hints:
            raise Invalid(f"{where}.{key}: unknown")
        value = value_at(document, key, hints[name] | None if has_defaults else hints[name], where)
        values |= {} if value is None else {name: value}
    return kind(**values, **given)


def value_at(document: object, key: str, kind: Any, where: str = "") -> Any:
    """The value of a type at a key of an object; see :func:`unpicked`.

    Raises:
        Invalid: There is none, or it has another type.
    """
    place = f"{where}.{key}" if where else key
    if not isinstance(document, Mapping):
        raise Invalid(f"{where or 'top level'}: expected an object")
    if key not in document:
        raise Invalid(f"{place}: missing")
    return _value(kind, document[key], place)


@cache
def _hints(kind: Any) -> Mapping[str, Any]:
    return get_type_hints(kind)


def _value(kind: Any, value: Any, where: str) -> Any:
    """JSON data as a value of an annotated type."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind is object:
        return value
    if origin in (Union, UnionType):
        return None if value is None else _value(arguments[0], value, where)
    if kind is float:
        return _number(value, where)
    if kind in _WORDS:
        if type(value) is not kind:
            raise Invalid(f"{where}: expected {_WORDS[kind]}")
        return value
    if origin is tuple:
        return _tuple(arguments, value, where)
    if hasattr(kind, "from_xyz_rpy"):
        return kind.from_xyz_rpy(*(value_at(value, key, Vector3, where) for key in ("xyz", "rpy")))
    if isinstance(kind, EnumType):
        known = [one.value for one in cast(type[Enum], kind)]
        if value not in known:
            raise Invalid(f"{where}: expected one of {', '.join(map(str, known))}")
        return kind(value)
    if not isinstance(value, Mapping):
        raise Invalid(f"{where}: expected an object")
    if origin is dict:
        return {key: _value(arguments[1], one, f"{where}.{key}") for key, one in value.items()}
    return unpicked(kind, value, " ".join(value), where, has_defaults=True)


_WORDS = {str: "text", bool: "true or false", int: "a whole number"}


def _number(value: Any, where: str) -> float:
    try:
        if isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value):
            return float(value)
    except OverflowError:
        pass  # an integer of hundreds of digits is none of these numbers
    raise Invalid(f"{where}: expected a number")


def _tuple(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    is_vector = kinds == (float, float, float)
    if not isinstance(value, list):
        raise Invalid(f"{where}: expected {'three numbers' if is_vector else 'a list'}")
    if kinds[1:] == (...,):
        return tuple(_value(kinds[0], one, f"{where}[{number}]") for number, one in enumerate(value))
    if len(value) != len(kinds):
        raise Invalid(f"{where}: expected {'three numbers' if is_vector else f'{len(kinds)} values'}")
    return tuple(_value(kind, one, where) for kind, one in zip(kinds, value, strict=True))
