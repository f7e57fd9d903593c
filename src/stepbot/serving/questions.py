"""Values of a question that a page asks, which may hold anything, and values as a sidecar writes them."""

from collections.abc import Sequence
from math import degrees as in_degrees
from math import isfinite
from typing import Any

from .local_server import Refused

Json = dict[str, Any]


def text(question: Json, key: str) -> str:
    """The text at a key."""
    value = question.get(key)
    if not isinstance(value, str):
        raise Refused(f"'{key}' is missing")
    return value


def paths(question: Json) -> list[str]:
    """The different paths at ``paths``, at least one."""
    found = names_of(question, "paths")
    if not found:
        raise Refused("pick a part first")
    return found


def names_of(question: Json, key: str) -> list[str]:
    """The different texts of the list at a key."""
    return list(dict.fromkeys(_texts(question.get(key))))


def limits(question: Json, *, sliding: bool) -> Json:
    """The limits ``{lower, upper}`` [rad] or [m] with units."""
    lower, upper = _finite(question.get("lower")), _finite(question.get("upper"))
    if not lower < upper:
        raise Refused("the lower limit must be below the upper one")
    unit = _millimetres if sliding else _degrees
    return {"lower": unit(lower), "upper": unit(upper)}


def origin(value: object) -> Json:
    """``{mate: [a, b]}``, ``{axis_of: a}`` or ``{auto: true}``, with its selectors."""
    if not isinstance(value, dict):
        raise Refused("an origin is expected")
    if value.get("auto") is True:
        return {"auto": True, **selectors(value)}
    if isinstance(value.get("mate"), list):
        return {"mate": _texts(value["mate"], 2), **selectors(value)}
    return {"axis_of": text(value, "axis_of"), **selectors(value)}


def selectors(value: Json) -> Json:
    """``radius`` [m] and ``near`` (3,) [m], with units, if they are given."""
    found: Json = {}
    if value.get("radius") is not None:
        found["radius"] = _millimetres(_finite(value["radius"]))
    near = value.get("near")
    if near is not None:
        if not isinstance(near, list) or len(near) != 3:
            raise Refused("a point has three coordinates")
        found["near"] = [_millimetres(_finite(x)) for x in near]
    return found


def axis(direction: Sequence[float]) -> str | list[float]:
    """``z`` or ``-z`` for an axis of the joint's frame, else three numbers."""
    for index, letter in enumerate("xyz"):
        if abs(direction[index]) == 1.0 and not any(direction[:index]) and not any(direction[index + 1 :]):
            return letter if direction[index] > 0.0 else f"-{letter}"
    return list(direction)


def _texts(value: object, count: int = 0) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value) or (count and len(value) != count):
        raise Refused("a list of texts is expected")
    return list(value)


def _finite(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not isfinite(value):
        raise Refused("a number is missing")
    return float(value)


def _degrees(angle: float) -> str:
    return f"{round(in_degrees(angle), 3) + 0.0:.10g} deg"


def _millimetres(length: float) -> str:
    return f"{round(length * 1e3, 4) + 0.0:.10g} mm"
