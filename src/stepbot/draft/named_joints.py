"""Joints that names in the STEP state: a subassembly ``urdf*`` with a part ``joint_PARENT_to_CHILD_*`` for each.

The convention of urdf_from_step: https://reconcycle.github.io/standalone/urdf_converter/creating_step_file.html. Such a
part is at the frame of its joint, whose axis is x, and holds a part named after the type. A link has the parts
``link_NAME_*``; the root has all others. What is in ``urdf*`` is no part of the robot.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from msgspec.structs import replace

from stepbot.draft.draft import Draft
from stepbot.draft.stated_joints import draft_of_mechanism
from stepbot.geometry.spatial import Pose, vector3
from stepbot.robot.model import Frame, JointKind
from stepbot.step.assembly import Assembly, Component
from stepbot.step.exchange.mechanisms import KinematicLink, KinematicPair, Mechanism, Occurrence
from stepbot.step.structure.paths import plain_name

_FOLDER = re.compile(r"urdf", re.IGNORECASE)
_JOINT = re.compile(r"joint_(?P<parent>\w+)_to_(?P<child>\w+)_[^_]*$", re.IGNORECASE)
_SLIDE, _TURN = 0, 3
_FREE = {
    JointKind.FIXED: (),
    JointKind.REVOLUTE: (_TURN,),
    JointKind.CONTINUOUS: (_TURN,),
    JointKind.PRISMATIC: (_SLIDE,),
}
"""Degrees of freedom of each type that a part can be named after: along x, about x."""


class _Named(NamedTuple):
    """A joint."""

    kind: JointKind
    parent: str
    child: str
    at: Component
    """At its frame."""


def draft_of_names(assembly: Assembly, robot: str) -> tuple[Draft | None, str]:
    """The draft of the joints that names state, None without any; and why there is none though names state some."""
    folder = next((c for c in assembly.components if c.parent == 0 and _FOLDER.match(c.product)), None)
    marks = [assembly.components[i] for i in assembly.children[folder.index]] if folder else []
    marks = [mark for mark in marks if _JOINT.match(plain_name(mark.product))]
    if folder is None or not marks:
        return None, ""
    stated = {mark.product: _joint(assembly, mark) for mark in marks}
    joints = [joint for joint in stated.values() if joint is not None]
    untyped = [f"'{name}'" for name, joint in stated.items() if joint is None]
    if untyped:
        types = ", ".join(kind.value for kind in _FREE)
        return None, f"joints named in '{folder.path}' were ignored: no part named {types} in {', '.join(untyped)}"
    children = {joint.child for joint in joints}
    root = next((joint.parent for joint in joints if joint.parent not in children), joints[0].parent)
    members = _members(assembly, folder, root, [name for joint in joints for name in (joint.parent, joint.child)])
    parents = {joint.parent for joint in joints}
    frames = [j for j in joints if j.kind is JointKind.FIXED and not members[j.child] and j.child not in parents]
    moving = [joint for joint in joints if joint not in frames]
    names = list(dict.fromkeys(name for joint in moving for name in (joint.parent, joint.child)))
    bare = [name for name in names if not members[name]]
    if bare or not moving:
        return None, f"joints named in '{folder.path}' were ignored: no parts link_NAME_ for {', '.join(bare)}"
    links = [KinematicLink(name, tuple(_occurrence(assembly, i) for i in members[name])) for name in names]
    pairs = [_pair(assembly, members, names, joint) for joint in moving]
    draft = draft_of_mechanism(Mechanism(tuple(links), tuple(pairs), names.index(root)), assembly, robot)
    assert draft is not None, "each link has parts"
    kinds, at = {f"{j.parent}_{j.child}": j.kind for j in moving}, {j.child: j.at.X_WC for j in moving}
    drafted = replace(
        draft,
        joints=tuple(replace(joint, type=kinds.get(joint.name, joint.type)) for joint in draft.joints),
        frames=tuple(Frame(j.child, j.parent, at.get(j.parent, Pose()).inverse() @ j.at.X_WC) for j in frames),
        markers=(folder.path,),
        notes=(f"joints are the parts joint_PARENT_to_CHILD_ in '{folder.path}' ({len(moving)})",),
    )
    return drafted, ""


def _joint(assembly: Assembly, at: Component) -> _Named | None:
    match = _JOINT.match(plain_name(at.product))
    words = [assembly.components[i].product.lower() for i in assembly.children[at.index]]
    kind = next((kind for word in words for kind in _FREE if word.startswith(kind.value)), None)
    return None if match is None or kind is None else _Named(kind, match["parent"], match["child"], at)


def _members(assembly: Assembly, folder: Component, root: str, names: Sequence[str]) -> dict[str, list[int]]:
    """The components of each link: those with its name, of which the longest counts; the root has the others."""
    members: dict[str, list[int]] = {name: [] for name in names}
    for component in assembly.components:
        word = component.product.lower()
        of = [name for name in members if word.startswith(f"link_{name.lower()}_")]
        if of:
            members[max(of, key=len)].append(component.index)
        elif component.parent == 0 and component is not folder:
            members[root].append(component.index)
    return members


def _occurrence(assembly: Assembly, index: int) -> Occurrence:
    component = assembly.components[index]
    return Occurrence(assembly.components[component.parent].product, component.product, component.ordinal)


def _pair(
    assembly: Assembly, members: Mapping[str, Sequence[int]], names: Sequence[str], joint: _Named
) -> KinematicPair:
    """The pair, placed in the frames of the first components of both links."""
    ends = joint.parent, joint.child
    placed = [assembly.components[min(members[end])].X_WC.inverse() @ joint.at.X_WC for end in ends]
    one, two = (Pose(X.rotation, vector3(X.p / assembly.unit_scale)) for X in placed)
    links = names.index(joint.parent), names.index(joint.child)
    kind = f"{joint.kind.value} joint by its name"
    return KinematicPair(f"{joint.parent}_{joint.child}", kind, links, (one, two), _FREE[joint.kind], is_stated=True)
