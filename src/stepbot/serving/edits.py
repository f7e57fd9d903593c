"""What a person does in the page, as changes of the sidecar: links and joints that come and go.

Each function takes the sidecar and a question of the page, which may hold anything, and returns changes.
"""

from collections.abc import Callable, Sequence
from typing import Any

from stepbot.report.plain import Json
from stepbot.robot.joint_types import PAIRS, kinds_with
from stepbot.sidecar.document import Document
from stepbot.sidecar.draft_comments import (
    drafted_actuators,
    drafted_fused,
    without_actuators,
    without_fused,
    without_questions,
    without_reviews,
)
from stepbot.sidecar.editing import Annotate, Append, Change, Put, Remove
from stepbot.sidecar.ignored import KEY as IGNORED
from stepbot.sidecar.ignored import can_ignore
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import ELEMENTS, Keys, Mapping, Scalar, child, entries_of, value_at, way

from .joint_edits import WITH_LIMITS, change_type, choose_line, confirm, flip, kind_of, set_limits, stops_gone
from .local_server import Refused
from .questions import (
    NAMED,
    limits,
    names_of,
    one_line,
    origin,
    paths,
    references_to_links,
    rename,
    require_free,
    require_portable,
    text,
)

_DEEPEST = 8
"""Keys on the way to a value."""
_OF_MASS = ("density", "mass", "material")
"""What a part or a default has one of."""
_DECIDED = ("defaults", "root")
"""Sections whose REVIEW comments a new value answers."""


def set_value(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{keys, text}``, the value at keys as YAML on one line, or ``{keys, value}``; an empty one removes it."""
    keys = keys_of(question)
    value: Any = question["value"] if "value" in question else one_line(text(question, "text"))
    if value == "" and "value" in question:
        value = None
    if keys[0] == "joints" and keys[2:] == ("type",):
        return change_type(sidecar, {"joint": keys[1], "kind": value})
    values = way(sidecar.root, keys)
    exists = len(values) == len(keys) + 1
    reviewed: list[Change] = [Annotate(keys[:1], without_reviews)] if keys[0] in _DECIDED and len(values) > 1 else []
    if value is None:
        has_others = len(entries_of(child(sidecar.root, keys[0]))) > 1
        return [Remove(keys), *(reviewed if has_others else [])] if exists else []
    if len(values) <= 2 <= len(keys) and keys[0] in ELEMENTS:
        require_portable(str(keys[1]), str(keys[0]).removesuffix("s"))
        if keys[0] in NAMED:
            require_free(sidecar.document, str(keys[0]), str(keys[1]))
    # A word that stands for settings, such as `limits: todo`, gives way to them.
    last = len(values) - 1
    if not exists and last > 0 and not isinstance(values[-1], Mapping):
        for key in reversed(keys[last:]):
            value = {str(key): value}
        keys = keys[:last]
    # A density that is not known yet gives way to what is known, and so does a material or mass.
    waiting = [(*keys[:-1], key) for key in _OF_MASS if keys[-1] in _OF_MASS and key != keys[-1]]
    answered = [Remove(one) for one in waiting if _is_open(sidecar, one)]
    stops = stops_gone(sidecar, str(keys[1])) if keys[2:] == ("origin",) else []
    return [Put(keys, value), *answered, *reviewed, *stops]


def append(sidecar: Sidecar, question: Json) -> list[Change]:  # noqa: ARG001 - every action gets it
    """``{keys, value}``: an item at the end of a list."""
    return [Append(keys_of(question), question.get("value"))]


def confirm_marks(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{keys}``: the REVIEW comments of the draft about an entry are settled."""
    keys = keys_of(question)
    if value_at(sidecar.root, keys) is None:
        raise Refused(f"there is no {'.'.join(map(str, keys))}")
    return [Annotate(keys, without_reviews)]


def ignore(sidecar: Sidecar, question: Json) -> list[Change]:  # noqa: ARG001
    """``{keys, code}``: a warning or note about an element is ignored there, or everywhere where it has no place."""
    keys, code = keys_of(question), text(question, "code")
    place: Keys = (*keys[:2], IGNORED) if can_ignore(keys) else (IGNORED,)
    return [Append(place, code)]


def keep_draft(sidecar: Sidecar, question: Json) -> list[Change]:  # noqa: ARG001
    """The robot stays as drafted: the questions in comments go."""
    return [Annotate((), without_questions)]


def drive(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joints, motor}``: actuators in comments of the draft become entries; with ``drop: true`` they go."""
    joints = names_of(question, "joints")
    drafted = [actuator for actuator in drafted_actuators(sidecar.text) if actuator.joint in joints]
    if not drafted:
        raise Refused("the draft has no actuator of these joints")
    entries: list[Change] = []
    for one in [] if question.get("drop") is True else drafted:
        value = one_line(one.values)
        if question.get("motor"):
            value["motor"] = text(question, "motor").strip()
        entries.append(Put(("actuators", one.name), value))
    return [*entries, Annotate((), without_actuators(joints))]


def free(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{parts}``: links and joints in comments of the draft that free fused parts; with ``drop: true`` they go."""
    wanted = names_of(question, "parts")
    fused = [one for one in drafted_fused(sidecar.text) if not set(wanted).isdisjoint(one.parts)]
    if not fused:
        raise Refused("the draft has no joint of these parts")
    changes: list[Change] = []
    for one in [] if question.get("drop") is True else fused:
        if str(one.values.get("parent")) not in sidecar.document.links:
            raise Refused(f"link '{one.values.get('parent')}' is gone; put a joint between two parts")
        changes += [*_assigned(sidecar.document, one.parts, one.link), Put(("joints", one.joint), one.values)]
    return [*changes, Annotate((), without_fused({one.link for one in fused}))]


def keys_of(question: Json) -> Keys:
    """The keys at ``keys``: names, and indices of lists."""
    keys = question.get("keys")
    if not isinstance(keys, list) or not 0 < len(keys) <= _DEEPEST or not isinstance(keys[0], str):
        raise Refused("keys are expected")
    if not all(isinstance(key, str | int) and not isinstance(key, bool) and key != "" for key in keys):
        raise Refused("a key is a name or an index")
    return tuple(keys)


def _is_open(sidecar: Sidecar, keys: Keys) -> bool:
    """Whether the value at keys is the placeholder."""
    value = value_at(sidecar.root, keys)
    return isinstance(value, Scalar) and value.value == "todo"


_REVERSIBLE = (*PAIRS, "fixed")


def merge(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint}``: its child link becomes part of its parent; whatever is on the child is on the parent then."""
    document, name = sidecar.document, text(question, "joint")
    if name not in document.joints:
        raise Refused(f"no joint '{name}'")
    follower = next((key for key, one in document.joints.items() if one.mimic and one.mimic.joint == name), None)
    sensor = next((key for key, one in document.sensors.items() if one.joint == name), None)
    if follower or sensor:
        raise Refused(f"'{follower or sensor}' needs joint '{name}'; remove it first")
    parent, child = document.joints[name].parent, document.joints[name].child
    if child not in document.links or parent not in document.links:
        raise Refused(f"joint '{name}' is between modules; edit the sidecar")
    gone: list[Change] = [
        Remove(("actuators", key)) for key, one in document.actuators.items() if (one.joint or key) == name
    ]
    gone += [Remove(("joints", name), with_draft=True), Remove(("links", child), with_draft=True)]
    moved = [
        Put(keys, parent)
        for keys, link in references_to_links(document)
        if link == child and keys[:2] != ("joints", name)
    ]
    return [*moved, *gone, *_parts_to(document, child, parent)]


def _parts_to(document: Document, child: str, parent: str) -> list[Change]:
    taken, taker = document.links[child], document.links[parent]
    changes: list[Change] = [Put(("links", parent, "rest"), True)] if taken.rest else []
    if taker.rest:  # what no link claims is its own
        return []
    return changes + [Append(("links", parent, "parts"), path) for path in taken.parts if path not in taker.parts]


def make_root(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{link}``: the joints between the root and a link are reversed; positions and limits keep their meaning."""
    document, link = sidecar.document, text(question, "link")
    if link not in document.links:
        raise Refused(f"no link '{link}'")
    above = {joint.child: name for name, joint in document.joints.items()}
    changes: list[Change] = []
    at, former = link, link
    while at in above:
        name = above.pop(at)
        joint = document.joints[name]
        if joint.type not in _REVERSIBLE:
            raise Refused(f"joint '{name}' is of type {joint.type}, which is not reversed here; edit the sidecar")
        changes += [Put(("joints", name, "parent"), joint.child), Put(("joints", name, "child"), joint.parent)]
        if joint.type != "fixed":
            # What turned the child by q turns the former parent by q about the opposite direction.
            changes.append(flip(sidecar, {"joint": name})[0])
        at = former = joint.parent
    if at == link:
        raise Refused(f"'{link}' is the root already")
    if document.root is not None and document.root.link == former:
        changes.append(Put(("root", "link"), link))
    return changes


_CLOSING = kinds_with(closes=True)


def changes_of(sidecar: Sidecar, question: Json) -> list[Change]:
    """The changes of a question ``{action, ...}``; ``{action: all, edits}`` is several, as one step.

    Raises:
        Refused: There is no such action, link, joint or value.
    """
    name = text(question, "action")
    if name == "all":
        edits = question.get("edits")
        if not isinstance(edits, list) or not all(
            isinstance(edit, dict) and edit.get("action") != name for edit in edits
        ):
            raise Refused("a list of edits is expected")
        changes = [change for edit in edits for change in changes_of(sidecar, edit)]
        return [one for at, one in enumerate(changes) if not (isinstance(one, Append) and one in changes[:at])]
    action = _ACTIONS.get(name)
    if action is None:
        raise Refused("no such action")
    return action(sidecar, question)


def _assign(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{paths, link}``: components to a link."""
    link = text(question, "link")
    if link not in sidecar.document.links:
        raise Refused(f"no link '{link}'")
    return _assigned(sidecar.document, paths(question), link)


def _assigned(document: Document, parts: Sequence[str], link: str) -> list[Change]:
    changes: list[Change] = []
    for name, section in document.links.items():
        listed = [index for index, path in enumerate(section.parts) if path in parts and name != link]
        changes += [Remove(("links", name, "parts", index)) for index in reversed(listed)]
        if listed and len(listed) == len(section.parts) and not section.rest:
            raise Refused(f"link '{name}' would have no part left; remove its joint first")
    if link not in document.links:
        return [*changes, Put(("links", link), {"parts": list(parts)})]
    new = [path for path in parts if path not in document.links[link].parts]
    return [*changes, *(Append(("links", link, "parts"), path) for path in new)]


def _add_joint(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{name, kind, needed, parent, child, origin, lower, upper, paths}``; ``paths`` become the child if it is new."""
    document = sidecar.document
    name, parent, child = (text(question, key).strip() for key in ("name", "parent", "child"))
    kind, needed = kind_of(question)
    require_portable(name, "joint")
    if child not in document.links:
        require_portable(child, "link")
    require_free(document, "joints", name)
    if parent not in document.links:
        raise Refused(f"no link '{parent}'")
    changes = [] if child in document.links else _assigned(document, paths(question), child)
    joint: Json = {"type": kind.value, "parent": parent, "child": child, **needed}
    if question.get("origin") is not None:
        joint["origin"] = origin(question["origin"])
    if kind in WITH_LIMITS:
        joint["limits"] = limits(question, sliding=kind == "prismatic")
    return [*changes, Put(("joints", name), joint)]


def _add_closure(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{name, kind, parent, child, origin}``: a joint between two links that closes a loop."""
    name, kind = text(question, "name").strip(), text(question, "kind")
    require_portable(name, "closure")
    require_free(sidecar.document, "closures", name)
    if kind not in _CLOSING:
        raise Refused(f"no closures of type '{kind}' here; edit the sidecar")
    closure: Json = {"type": kind, "link_a": text(question, "parent"), "link_b": text(question, "child")}
    given = question.get("origin")
    return [Put(("closures", name), {**closure, "origin": "auto" if given is None else origin(given)})]


def _remove_joint(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{joint}``: its child link is removed, too; the parts of that link belong to no link then."""
    document, name = sidecar.document, text(question, "joint")
    if name in document.closures:
        return [Remove(("closures", name), with_draft=True)]
    if name not in document.joints:
        raise Refused(f"no joint '{name}'")
    child = document.joints[name].child
    others = [
        other for other, joint in document.joints.items() if other != name and child in (joint.parent, joint.child)
    ]
    others += [other for other, one in document.closures.items() if child in (one.link_a, one.link_b)]
    if others:
        raise Refused(f"'{others[0]}' needs link '{child}'; remove it first")
    if document.links[child].rest:
        raise Refused(f"link '{child}' takes all remaining parts and cannot be removed")
    return [Remove(("joints", name), with_draft=True), Remove(("links", child), with_draft=True)]


_ACTIONS: dict[str, Callable[[Sidecar, Json], list[Change]]] = {
    "limits": set_limits,
    "flip": flip,
    "type": change_type,
    "origin": choose_line,
    "confirm": confirm,
    "rename": rename,
    "assign": _assign,
    "add_joint": _add_joint,
    "add_closure": _add_closure,
    "remove_joint": _remove_joint,
    "merge": merge,
    "root": make_root,
    "set": set_value,
    "append": append,
    "settle": confirm_marks,
    "ignore": ignore,
    "drive": drive,
    "free": free,
    "keep_draft": keep_draft,
}
