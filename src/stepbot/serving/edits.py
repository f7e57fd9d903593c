"""What a person does in the page, as changes of the sidecar: links and joints that come and go.

Each function takes the sidecar and a question of the page, which may hold anything, and returns changes.
"""

from collections.abc import Callable, Sequence

from stepbot.robot.joint_types import kinds_with
from stepbot.sidecar.document import Document
from stepbot.sidecar.editing import Append, Change, Put, Remove
from stepbot.sidecar.located import Sidecar

from .joint_edits import KINDS, WITH_LIMITS, change_type, choose_line, confirm, flip, set_limits
from .local_server import Refused
from .questions import Json, limits, origin, paths, text
from .renaming import rename, require_free, require_portable
from .tree_edits import make_root, merge
from .value_edits import append, confirm_marks, ignore, set_value

_CLOSING = kinds_with(closes=True)


def changes_of(sidecar: Sidecar, question: Json) -> list[Change]:
    """The changes of a question ``{action, ...}``; ``{action: all, edits}`` is several, as one step.

    Raises:
        Refused: There is no such action, link, joint or value.
    """
    name = text(question, "action")
    if name == "all":
        edits = question.get("edits")
        if not isinstance(edits, list) or not all(isinstance(one, dict) and one.get("action") != name for one in edits):
            raise Refused("a list of edits is expected")
        return [change for one in edits for change in changes_of(sidecar, one)]
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
    """``{name, kind, parent, child, origin, lower, upper, paths}``; ``paths`` become the child if it is new."""
    document = sidecar.document
    name, kind = text(question, "name").strip(), text(question, "kind")
    parent, child = text(question, "parent"), text(question, "child").strip()
    require_portable(name)
    if child not in document.links:
        require_portable(child)
    require_free(document, "joints", name)
    if kind not in KINDS:
        raise Refused(f"no joints of type '{kind}' here; edit the sidecar")
    if parent not in document.links:
        raise Refused(f"no link '{parent}'")
    changes = [] if child in document.links else _assigned(document, paths(question), child)
    joint: Json = {"type": kind, "parent": parent, "child": child}
    if question.get("origin") is not None:
        joint["origin"] = origin(question["origin"])
    if kind in WITH_LIMITS:
        joint["limits"] = limits(question, sliding=kind == "prismatic")
    return [*changes, Put(("joints", name), joint)]


def _add_closure(sidecar: Sidecar, question: Json) -> list[Change]:
    """``{name, kind, parent, child, origin}``: a joint between two links that closes a loop."""
    name, kind = text(question, "name").strip(), text(question, "kind")
    require_portable(name)
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
}
