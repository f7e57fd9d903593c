"""Changes of one joint or closure: its limits, axis and type."""

from typing import Any

from stepbot.report.plain import Json
from stepbot.robot.joint_types import HINGES, JointKind, kinds_with
from stepbot.sidecar.draft_comments import drafted_stops, mirrored_stops, without_reviews, without_stops
from stepbot.sidecar.editing import Annotate, Change, Put, Remove
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import plain_data

from .local_server import Refused
from .questions import axis, limits, one_line, selectors, text

WITH_LIMITS = kinds_with(bounded=True)
_BOUNDS = ("lower", "upper")


def set_limits(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint, lower, upper}`` [rad] or [m]."""
    name = _joint(sidecar, question)
    joint = sidecar.document.joints[name]
    new = limits(question, sliding=joint.type is JointKind.PRISMATIC)
    if joint.limits == "todo":
        return [Put(("joints", name, "limits"), new)]
    return [Put(("joints", name, "limits", key), value) for key, value in new.items()]


def flip(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint}``: the axis of a joint or closure in the other direction; limits and zero keep their physical place."""
    section, name = _place(sidecar, question)
    one = sidecar.document.joints.get(name) or sidecar.document.closures[name]
    changes: list[Change] = [Put((section, name, "axis"), axis([-value + 0.0 for value in one.axis]))]
    written = _written(sidecar, section, name)
    bounds = written.get("limits")
    if isinstance(bounds, dict):
        mirrored = {
            other: _negated(bounds[key]) for key, other in zip(_BOUNDS, _BOUNDS[::-1], strict=True) if key in bounds
        }
        changes += [Put((section, name, "limits", key), mirrored[key]) for key in _BOUNDS if key in mirrored]
        changes += [Remove((section, name, "limits", key)) for key in _BOUNDS if key in bounds and key not in mirrored]
    if "zero" in written:
        changes.append(Put((section, name, "zero"), _negated(written["zero"])))
    if _has_stops(sidecar, name):
        changes.append(Annotate((section, name), mirrored_stops))
    return changes


def change_type(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint, kind, needed}``; limits that do not fit the new type go, or become `todo` where it needs some."""
    name = _joint(sidecar, question)
    kind, needed = kind_of(question)
    former = sidecar.document.joints[name].type
    if kind == former:
        return []
    place, written = ("joints", name), _written(sidecar, "joints", name)
    changes: list[Change] = [Put((*place, "type"), kind.value)]
    changes += [Put((*place, key), value) for key, value in needed.items()]
    if former.needs in written:
        changes.append(Remove((*place, former.needs)))
    bounds = written.get("limits")
    given: Json = bounds if isinstance(bounds, dict) else {}
    # Limits of a description stay with its type, and give way to another one.
    others = [key for key in given if key not in _BOUNDS and _is_own(sidecar, name, key)]
    if others and not {kind, former} <= set(HINGES):
        raise Refused(f"`{others[0]}` of '{name}' does not fit type {kind}; remove it in the sidecar first")
    if others:
        changes += [Remove((*place, "limits", key)) for key in _BOUNDS if key in given]
    elif kind in WITH_LIMITS:
        changes.append(Put((*place, "limits"), "todo"))
    elif bounds is not None:
        changes.append(Remove((*place, "limits")))
    if not kind.has_axis and "axis" in written:
        changes.append(Remove((*place, "axis")))
    return [*changes, *(stops_gone(sidecar, name) if "prismatic" in (kind, former) else [])]


def kind_of(question: Json) -> tuple[JointKind, Json]:
    """The type at ``kind``, and what it needs beside its axis: the value at ``needed``, as YAML on one line."""
    name = text(question, "kind")
    if name not in list(JointKind):
        raise Refused(f"no joint type '{name}'")
    kind = JointKind(name)
    if not kind.needs:
        return kind, {}
    value = None if question.get("needed") is None else one_line(text(question, "needed"))
    if value is None:
        raise Refused(f"a {kind} joint needs `{kind.needs}`")
    return kind, {kind.needs: value}


def choose_line(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint, radius, near}``: another line of the same parts as axis, by the selectors of its origin.

    The comments about stops along the former axis are removed.
    """
    section, name = _place(sidecar, question)
    return [_on_line(sidecar, section, name, question), *stops_gone(sidecar, name)]


def confirm(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint, radius, near}``: confirm the axis: its selectors are written, its REVIEW comments removed."""
    section, name = _place(sidecar, question)
    origin = _written(sidecar, section, name).get("origin", "auto")
    is_selected = isinstance(origin, dict) and not {"radius", "near"}.isdisjoint(origin)
    changes: list[Change] = [Annotate((section, name), without_reviews)]
    if selectors(question) and not is_selected:
        changes.append(_on_line(sidecar, section, name, question))
    return changes


def _on_line(sidecar: Sidecar, section: str, name: str, question: Json) -> Put:
    former = _written(sidecar, section, name).get("origin", "auto")
    kept = {"auto": True} if former == "auto" else former
    if not isinstance(kept, dict) or not {"mate", "axis_of", "auto", "radius", "near"} & set(kept):
        raise Refused(f"the origin of '{name}' is not a line of faces; edit the sidecar")
    kept = {key: value for key, value in kept.items() if key not in ("radius", "near")}
    if not {"mate", "axis_of"} & set(kept):
        kept = {"auto": True, **kept}
    new = {**kept, **selectors(question)}
    return Put((section, name, "origin"), "auto" if new == {"auto": True} else new)


def stops_gone(sidecar: Sidecar, name: str) -> list[Change]:
    """The comments about stops of a joint or closure that gets another axis go."""
    section = "closures" if name in sidecar.document.closures else "joints"
    return [Annotate((section, name), without_stops)] if _has_stops(sidecar, name) else []


def _has_stops(sidecar: Sidecar, name: str) -> bool:
    return bool(drafted_stops(sidecar.text).get(name))


def _place(sidecar: Sidecar, question: Json) -> tuple[str, str]:
    """Section and name of a joint or closure."""
    name = text(question, "joint")
    for section, names in (("joints", sidecar.document.joints), ("closures", sidecar.document.closures)):
        if name in names:
            return section, name
    raise Refused(f"no joint '{name}'")


def _joint(sidecar: Sidecar, question: Json) -> str:
    section, name = _place(sidecar, question)
    if section != "joints":
        raise Refused(f"'{name}' is a closure")
    return name


def _written(sidecar: Sidecar, section: str, name: str) -> Json:
    """The values of a joint or closure as the file has them."""
    joint: Json = plain_data(sidecar.root)[section][name]
    return joint


def _is_own(sidecar: Sidecar, joint: str, limit: str) -> bool:
    """Whether a limit is in the file itself."""
    return sidecar.span("joints", joint, "limits", limit).file == sidecar.path.as_posix()


def _negated(value: Any) -> Any:
    """A quantity with the other sign: ``91 deg`` for ``-91 deg``."""
    if isinstance(value, int | float):
        return -value + 0
    quantity = str(value).strip()
    return quantity[1:].lstrip() if quantity.startswith("-") else f"-{quantity.removeprefix('+')}"
