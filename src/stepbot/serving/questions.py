"""Values of a question that a page asks, which may hold anything, as a sidecar writes them; new names."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from math import degrees as in_degrees
from math import isfinite
from typing import Any

from stepbot.report.plain import Json
from stepbot.robot.mesh_names import free_name, portable_name
from stepbot.sidecar.component_paths import origins
from stepbot.sidecar.document import Document
from stepbot.sidecar.editing import CannotEdit, Change, Put, Rename, value_of
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.origins import ExplicitOrigin
from stepbot.sidecar.references import joint_references, link_references
from stepbot.sidecar.tree import Keys

from .local_server import Refused

_LONGEST = 4000
"""Characters of a value."""


def text(question: Json, key: str) -> str:
    """The text at a key."""
    value = question.get(key)
    if not isinstance(value, str):
        raise Refused(f"'{key}' is missing")
    return value


def one_line(written: str) -> Any:
    """The value that a text means as YAML on one line; None for an empty one."""
    written = written.strip()
    if not written:
        return None
    if len(written) > _LONGEST or not written.isprintable():
        raise Refused("a value is one line")
    try:
        return value_of(written)
    except CannotEdit as error:
        raise Refused(str(error)) from error


def paths(question: Json) -> list[str]:
    """The different paths at ``paths``, at least one."""
    names = names_of(question, "paths")
    if not names:
        raise Refused("pick a part first")
    return names


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
    chosen: Json = {}
    if value.get("radius") is not None:
        chosen["radius"] = _millimetres(_finite(value["radius"]))
    near = value.get("near")
    if near is not None:
        if not isinstance(near, list) or len(near) != 3:
            raise Refused("a point has three coordinates")
        chosen["near"] = [_millimetres(_finite(x)) for x in near]
    return chosen


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


NAMED = ("links", "joints", "closures", "frames")
"""Sections of the sidecar whose entries need different names."""


def rename(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{what, from, to}``; ``what`` is ``joint``, which may be a closure, or ``link``.

    A reference that is not replaced here makes the result one that `check` rejects, and nothing is written.
    """
    document = sidecar.document
    former, new = text(question, "from"), text(question, "to").strip()
    sections = ("links",) if text(question, "what") == "link" else ("joints", "closures")
    section = next((one for one in sections if former in getattr(document, one)), None)
    if section is None:
        raise Refused(f"no {question['what']} '{former}'")
    require_portable(new, section.removesuffix("s"))
    require_free(document, section, new)
    changes: list[Change] = []
    if section == "joints":
        changes += _patterns(document, former, new)
    references = references_to_links if section == "links" else joint_references
    changes += [Put(keys, new) for keys, name in references(document) if name == former]
    return [*changes, Rename((section, former), new)]


def require_portable(name: str, kind: str) -> None:
    """Refuse a new name that some format, ROS or xacro does not accept, with one that all accept."""
    if not name:
        raise Refused("a name is missing")
    if (other := portable_name(name, kind)) != name:
        allowed = "start with a letter, go on with a-z, 0-9, '_', '-', '.'"
        raise Refused(f"'{name}' is not a portable name: {allowed}; try '{other}'")


def require_free(document: Document, section: str, name: str) -> None:
    """Refuse a name of a new entry of ``section`` that a link, joint, closure or frame has, with a free one."""
    taken = next((one for one in NAMED if name in getattr(document, one)), None)
    if taken is None:
        return
    kind, other = section.removesuffix("s"), taken.removesuffix("s")
    if section == taken:
        raise Refused(f"there is a {kind} '{name}' already")
    known = {one for names in NAMED for one in getattr(document, names)}
    free = free_name(f"{name}_{kind}", "_2", known)
    raise Refused(f"a {kind} and a {other} cannot have one name; try '{free}'")


def references_to_links(document: Document) -> Iterator[tuple[Keys, str | None]]:
    """Keys and names of all references to links."""
    yield from link_references(document)
    for keys, one in origins(document):
        if isinstance(one, ExplicitOrigin):
            yield (*keys, "relative_to"), one.relative_to


def _patterns(document: Document, former: str, new: str) -> Iterator[Change]:
    """A default that is for this joint alone is renamed; one that would win or lose the joint prevents it."""
    for pattern in document.joint_defaults:
        if pattern == former:
            yield Rename(("joint_defaults", pattern), new)
        elif fnmatchcase(former, pattern) != fnmatchcase(new, pattern):
            raise Refused(f"`joint_defaults` of '{pattern}' would apply to only one of '{former}' and '{new}'")
