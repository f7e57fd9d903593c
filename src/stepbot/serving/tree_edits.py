"""Changes of the tree of links: two links become one, another link becomes the root."""

from stepbot.robot.joint_types import kinds_with
from stepbot.sidecar.document import Document
from stepbot.sidecar.editing import Append, Change, Put, Remove
from stepbot.sidecar.located import Sidecar

from .joint_edits import flip
from .local_server import Refused
from .questions import Json, text
from .renaming import references_to_links

_REVERSIBLE = (*kinds_with(is_pair=True), "fixed")


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
