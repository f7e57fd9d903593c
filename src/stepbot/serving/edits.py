"""What a person does in the page, as changes of the sidecar.

Each function takes the sidecar and a question of the page, which may hold anything, and returns changes.
"""

from collections.abc import Callable, Sequence
from math import degrees, isfinite
from typing import Any

from stepbot.robot.model import JointKind
from stepbot.sidecar.document import Document
from stepbot.sidecar.editing import Append, Change, Put, Remove

from .local_server import Refused

Json = dict[str, Any]

_WITH_LIMITS = ("revolute", "prismatic")
_KINDS = (*_WITH_LIMITS, "continuous", "fixed")
_CLOSING = (*_WITH_LIMITS, "ball", "fixed")


def changes_of(document: Document, question: Json) -> list[Change]:
    """The changes of a question ``{action, ...}``.

    Raises:
        Refused: There is no such action, link, joint or value.
    """
    action = _ACTIONS.get(_text(question, "action"))
    if action is None:
        raise Refused("no such action")
    return action(document, question)


def _set_limits(document: Document, question: Json) -> list[Change]:
    """``{joint, lower, upper}`` [rad] or [m]."""
    name = _joint(document, question)
    kind = document.joints[name].type
    lower, upper = _number(question, "lower"), _number(question, "upper")
    if not lower < upper:
        raise Refused("the lower limit must be below the upper one")
    unit = _millimetres if kind is JointKind.PRISMATIC else _degrees
    limits = {"lower": unit(lower), "upper": unit(upper)}
    if document.joints[name].limits == "todo":
        return [Put(("joints", name, "limits"), limits)]
    return [Put(("joints", name, "limits", key), value) for key, value in limits.items()]


def _flip(document: Document, question: Json) -> list[Change]:
    """``{joint}``: the axis of a joint or closure, in the other direction."""
    name = _text(question, "joint")
    section = "joints" if name in document.joints else "closures"
    one = document.joints.get(name) or document.closures.get(name)
    if one is None:
        raise Refused(f"no joint '{name}'")
    return [Put((section, name, "axis"), _axis([-value + 0.0 for value in one.axis]))]


def _assign(document: Document, question: Json) -> list[Change]:
    """``{paths, link}``: components to a link, which is made if it does not exist."""
    link, paths = _text(question, "link").strip(), _paths(question)
    if not link:
        raise Refused("a link needs a name")
    return _assigned(document, paths, link)


def _assigned(document: Document, paths: Sequence[str], link: str) -> list[Change]:
    changes: list[Change] = []
    for name, section in document.links.items():
        listed = [index for index, path in enumerate(section.parts) if path in paths and name != link]
        changes += [Remove(("links", name, "parts", index)) for index in reversed(listed)]
        if listed and len(listed) == len(section.parts) and not section.rest:
            raise Refused(f"link '{name}' would have no part left; remove its joint first")
    if link not in document.links:
        return [*changes, Put(("links", link), {"parts": list(paths)})]
    new = [path for path in paths if path not in document.links[link].parts]
    return [*changes, *(Append(("links", link, "parts"), path) for path in new)]


def _add_joint(document: Document, question: Json) -> list[Change]:
    """``{name, kind, parent, child, origin, lower, upper, paths}``; ``paths`` become the child if it is new."""
    name, kind = _text(question, "name").strip(), _text(question, "kind")
    parent, child = _text(question, "parent"), _text(question, "child").strip()
    if not name or not child:
        raise Refused("the joint and its child link need names")
    if name in document.joints:
        raise Refused(f"there is a joint '{name}' already")
    if kind not in _KINDS:
        raise Refused(f"no joints of type '{kind}' here; edit the sidecar")
    if parent not in document.links:
        raise Refused(f"no link '{parent}'")
    changes = [] if child in document.links else _assigned(document, _paths(question), child)
    joint: Json = {"type": kind, "parent": parent, "child": child}
    origin = question.get("origin")
    if origin is not None:
        joint["origin"] = _origin(origin)
    if kind in _WITH_LIMITS:
        unit = _millimetres if kind == "prismatic" else _degrees
        lower, upper = _number(question, "lower"), _number(question, "upper")
        if not lower < upper:
            raise Refused("the lower limit must be below the upper one")
        joint["limits"] = {"lower": unit(lower), "upper": unit(upper)}
    return [*changes, Put(("joints", name), joint)]


def _add_closure(document: Document, question: Json) -> list[Change]:
    """``{name, kind, parent, child, origin}``: a joint between two links that closes a loop."""
    name, kind = _text(question, "name").strip(), _text(question, "kind")
    if not name or name in document.closures:
        raise Refused(f"there is a closure '{name}' already" if name else "the closure needs a name")
    if kind not in _CLOSING:
        raise Refused(f"no closures of type '{kind}' here; edit the sidecar")
    closure: Json = {"type": kind, "link_a": _text(question, "parent"), "link_b": _text(question, "child")}
    origin = question.get("origin")
    return [Put(("closures", name), {**closure, "origin": "auto" if origin is None else _origin(origin)})]


def _remove_joint(document: Document, question: Json) -> list[Change]:
    """``{joint}``: its child link goes, too, and its parts with it, so that they are free again."""
    name = _text(question, "joint")
    if name in document.closures:
        return [Remove(("closures", name))]
    child = document.joints[_joint(document, question)].child
    others = [
        other for other, joint in document.joints.items() if other != name and child in (joint.parent, joint.child)
    ]
    others += [other for other, one in document.closures.items() if child in (one.link_a, one.link_b)]
    if others:
        raise Refused(f"'{others[0]}' needs link '{child}'; remove it first")
    if document.links[child].rest:
        raise Refused(f"link '{child}' takes all remaining parts and cannot be removed")
    return [Remove(("joints", name)), Remove(("links", child))]


_ACTIONS: dict[str, Callable[[Document, Json], list[Change]]] = {
    "limits": _set_limits,
    "flip": _flip,
    "assign": _assign,
    "add_joint": _add_joint,
    "add_closure": _add_closure,
    "remove_joint": _remove_joint,
}


def _origin(value: object) -> Json:
    """``{mate: [a, b]}`` or ``{axis_of: a}``, with ``radius`` [m] or ``near`` [m] if they are needed."""
    if not isinstance(value, dict):
        raise Refused("an origin is expected")
    found: Json = {}
    if isinstance(value.get("mate"), list):
        found["mate"] = _texts(value["mate"], 2)
    else:
        found["axis_of"] = _text(value, "axis_of")
    if value.get("radius") is not None:
        found["radius"] = _millimetres(_number(value, "radius"))
    near = value.get("near")
    if near is not None:
        if not isinstance(near, list) or len(near) != 3:
            raise Refused("a point has three coordinates")
        found["near"] = [_millimetres(_finite(x)) for x in near]
    return found


def _joint(document: Document, question: Json) -> str:
    name = _text(question, "joint")
    if name not in document.joints:
        raise Refused(f"no joint '{name}'")
    return name


def _text(question: Json, key: str) -> str:
    value = question.get(key)
    if not isinstance(value, str):
        raise Refused(f"'{key}' is missing")
    return value


def _texts(value: object, count: int = 0) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value) or (count and len(value) != count):
        raise Refused("a list of paths is expected")
    return list(value)


def _paths(question: Json) -> list[str]:
    paths = list(dict.fromkeys(_texts(question.get("paths"))))
    if not paths:
        raise Refused("pick a part first")
    return paths


def _number(question: Json, key: str) -> float:
    return _finite(question.get(key))


def _finite(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not isfinite(value):
        raise Refused("a number is missing")
    return float(value)


def _degrees(angle: float) -> str:
    return f"{round(degrees(angle), 3) + 0.0:.10g} deg"


def _millimetres(length: float) -> str:
    return f"{round(length * 1e3, 4) + 0.0:.10g} mm"


def _axis(axis: Sequence[float]) -> str | list[float]:
    """``z`` or ``-z`` for an axis of the joint's frame, else three numbers."""
    for index, letter in enumerate("xyz"):
        if abs(axis[index]) == 1.0 and not any(axis[:index]) and not any(axis[index + 1 :]):
            return letter if axis[index] > 0.0 else f"-{letter}"
    return list(axis)
