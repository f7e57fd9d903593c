"""A draft from the kinematic pairs in a STEP file: no joint is inferred, and each has score 1.

What the file leaves open is marked: the components of a link, and the degrees of freedom of a pair. The placements of a
pair are in the frames of its links' components; in files that give them in the frame of the assembly, both placements
have the same axis there.
"""

from collections.abc import Iterable, Sequence
from math import atan2

import numpy as np
from msgspec.structs import replace

from stepbot.draft.draft import Confidence, Draft, DraftClosure, DraftJoint, DraftLink, OriginForm, OriginSnippet
from stepbot.geometry.spatial import Array, Pose, Vector3, angle_between, unit, vector3
from stepbot.robot.model import JointKind, Limit
from stepbot.step.assembly import Assembly
from stepbot.step.exchange.mechanisms import KinematicLink, KinematicPair, Mechanism
from stepbot.step.structure.paths import plain_name

_SAME_PLACE, _SAME_DIRECTION = 1e-5, 1e-4
"""Tolerances [m] and [rad] within which the axes of two placements are equal."""
_AXES = ("x", "y", "z")


def draft_of_mechanism(mechanism: Mechanism, assembly: Assembly, robot: str) -> Draft | None:
    """The draft of a file's kinematic pairs; None if its links are not found among the components."""
    members = [_members(link, assembly) for link in mechanism.links]
    used = sorted({end for pair in mechanism.pairs for end in pair.links})
    if not used or any(not members[link] for link in used):
        return None
    names = _names(mechanism.links, members, assembly)
    root = mechanism.base if mechanism.base in used else used[0]
    tree, closures, apart = _tree(mechanism.pairs, used, root)
    scale = assembly.unit_scale
    joints = []
    for pair, parent, child in tree:
        joints.append(_joint(pair, parent, child, members, names, assembly, scale))
    joints += [_held(link, root, members, names, assembly) for link in apart]
    loops = [_closure(pair, members, names, assembly, scale) for pair in closures]
    notes = [f"joints are the kinematic pairs in the STEP ({len(mechanism.pairs)})"]
    if mechanism.unread:
        notes.append(f"pairs without an equivalent joint: {', '.join(mechanism.unread)}")
    links = [
        DraftLink(
            names[link],
            () if link == root else tuple(assembly.components[i].path for i in members[link]),
            Confidence(1.0, ("a link of the STEP's mechanism",)),
            rest=link == root,
        )
        for link in (root, *(link for link in used if link != root))
    ]
    return Draft(robot, names[root], tuple(links), tuple(joints), tuple(loops), notes=tuple(notes))


def _members(link: KinematicLink, assembly: Assembly) -> list[int]:
    """The components of a link: those that it refers to, else those with its name."""
    stated = [
        component.index
        for wanted in link.occurrences
        for component in assembly.components[1:]
        if (component.product, component.ordinal) == (wanted.product, wanted.ordinal)
        and assembly.components[component.parent].product == wanted.assembly
    ]
    if stated or not link.name:
        return sorted(set(stated))
    name = plain_name(link.name)
    for names in (
        [plain_name(component.occurrence) for component in assembly.components],
        [component.path for component in assembly.components],
        [plain_name(component.product) for component in assembly.components],
    ):
        named = [index for index, one in enumerate(names) if one == name and index]
        if named:
            return named if len(named) == 1 else []  # ambiguous among several
    return []


def _names(links: Sequence[KinematicLink], members: Sequence[Sequence[int]], assembly: Assembly) -> list[str]:
    """A unique name for each link."""
    names: list[str] = []
    for index, (link, parts) in enumerate(zip(links, members, strict=True)):
        first = assembly.components[parts[0]] if parts else None
        name = link.name or (plain_name(first.product or first.occurrence) if first else "") or f"link_{index + 1}"
        names.append(name if name not in names else f"{name}_{index + 1}")
    return names


def _tree(
    pairs: Iterable[KinematicPair], links: Sequence[int], root: int
) -> tuple[list[tuple[KinematicPair, int, int]], list[KinematicPair], list[int]]:
    """Pairs of the tree in order with parent and child, pairs that close loops, and unconnected links."""
    waiting, reached = list(pairs), {root}
    tree: list[tuple[KinematicPair, int, int]] = []
    apart: list[int] = []
    while True:
        next_pair = next((pair for pair in waiting if (pair.links[0] in reached) != (pair.links[1] in reached)), None)
        if next_pair is not None:
            parent, child = next_pair.links if next_pair.links[0] in reached else next_pair.links[::-1]
            tree.append((next_pair, parent, child))
            reached.add(child)
            waiting.remove(next_pair)
            continue
        missing = next((link for link in links if link not in reached), None)
        if missing is None:
            return tree, waiting, apart
        apart.append(missing)
        reached.add(missing)


def _joint(
    pair: KinematicPair,
    parent: int,
    child: int,
    members: Sequence[Sequence[int]],
    names: Sequence[str],
    assembly: Assembly,
    scale: float,
) -> DraftJoint:
    frame, drawn, review = _placed(pair, members, assembly, scale)
    kind, axis, axis2 = _kind(pair)
    forward = parent == pair.links[0]
    if not forward:  # the same motion, with parent and child exchanged
        axis, axis2 = (-v for v in (axis, axis2))
    direction = frame.turn(axis)
    zero = _drawn_position(kind, np.abs(axis), drawn)
    limits = _limits(pair, kind, scale)
    if limits is not None and not limits.lower <= zero <= limits.upper:
        review = review or "drawn outside the range in the STEP: zero and limits may refer to another pose"
        limits, zero = None, 0.0
    base = DraftJoint(
        name=pair.name or f"{names[child]}_joint",
        type=kind,
        origin=OriginSnippet(OriginForm.XYZ, xyz=vector3(frame.p), rpy=frame.rpy),
        axis=_letter(axis),
        point=vector3(frame.p),
        direction=vector3(direction) if kind.has_axis else None,
        confidence=Confidence(0.7 if review else 1.0, (f"{pair.kind.lower().replace('_', ' ')} in the STEP",)),
        parts=_parts(pair, members, assembly),
        review=review,
        parent=names[parent],
        child=names[child],
        limits=limits,
        limits_from="stated in the STEP",
        zero=zero,
        pitch=None if pair.pitch is None else pair.pitch * scale,
    )
    if kind is not JointKind.UNIVERSAL:
        return base
    return replace(base, axis2=_letter(axis2), direction2=vector3(frame.turn(axis2)))


def _closure(
    pair: KinematicPair, members: Sequence[Sequence[int]], names: Sequence[str], assembly: Assembly, scale: float
) -> DraftClosure:
    joint = _joint(pair, *pair.links, members, names, assembly, scale)
    return DraftClosure(
        pair.name or f"{joint.parent}_{joint.child}",
        joint.type,
        joint.origin,
        joint.axis,
        joint.point,
        joint.direction,
        joint.confidence,
        joint.parts,
        review=joint.review,
        link_a=joint.parent,
        link_b=joint.child,
    )


def _held(
    link: int, root: int, members: Sequence[Sequence[int]], names: Sequence[str], assembly: Assembly
) -> DraftJoint:
    """A fixed joint to a link that no pair connects with the root."""
    paths = tuple(assembly.components[members[end][0]].path for end in (root, link))
    return DraftJoint(
        f"{names[link]}_mount",
        JointKind.FIXED,
        OriginSnippet(OriginForm.XYZ),
        "z",
        (0.0, 0.0, 0.0),
        None,
        Confidence(0.5, ("not connected by any pair of the STEP",)),
        (paths[0], paths[1]),
        review="fixed to the base, since not connected by any pair of the STEP",
        parent=names[root],
        child=names[link],
    )


def _placed(
    pair: KinematicPair, members: Sequence[Sequence[int]], assembly: Assembly, scale: float
) -> tuple[Pose, Pose, str]:
    """The pair's frame on the first link in the assembly, the second's relative to it, and what to review."""
    own = [Pose(p.rotation, vector3(p.p * scale)) for p in pair.placements]
    first, second = (assembly.components[members[link][0]].X_WC @ X for link, X in zip(pair.links, own, strict=True))
    review = "" if pair.is_stated or pair.kind in _SURE_WITHOUT_FLAGS else (
        "the STEP does not state the free axes; those of the standard are used"
    )  # fmt: skip
    _, axis, _ = _kind(pair)
    if _agree(first, second, axis):
        return first, first.inverse() @ second, review
    if _agree(own[0], own[1], axis):
        return own[0], own[0].inverse() @ own[1], review
    return first, Pose(), "the two placements of the pair do not coincide as drawn; the first one is used"


_SURE_WITHOUT_FLAGS = ("REVOLUTE_PAIR", "SPHERICAL_PAIR", "CYLINDRICAL_PAIR", "SCREW_PAIR", "FULLY_CONSTRAINED_PAIR")
"""Kinds whose degrees of freedom need no flags: about z, along it, all or none."""


def _agree(first: Pose, second: Pose, axis: Array) -> bool:
    """Whether two placements differ only by a possible motion of the pair: same axis, or same point."""
    apart = second.p - first.p
    if not axis.any():
        return bool(np.linalg.norm(apart) <= _SAME_PLACE)
    along = first.turn(axis)
    off = apart - (apart @ along) * along
    return bool(np.linalg.norm(off) <= _SAME_PLACE and angle_between(along, second.turn(axis)) <= _SAME_DIRECTION)


def _kind(pair: KinematicPair) -> tuple[JointKind, Array, Array]:
    """The type of joint with the given degrees of freedom, and its axis and second axis in the placement."""
    slides = [f for f in pair.dofs if f < 3]
    turns = [f - 3 for f in pair.dofs if f >= 3]
    none = np.zeros(3)
    z = np.eye(3)[2]
    if pair.kind == "SCREW_PAIR":
        return JointKind.SCREW, z, none
    match len(slides), len(turns):
        case 0, 0:
            return JointKind.FIXED, none, none
        case 0, 1:
            bounded = pair.bounds != (None, None)
            return (JointKind.REVOLUTE if bounded else JointKind.CONTINUOUS), np.eye(3)[turns[0]], none
        case 1, 0:
            return JointKind.PRISMATIC, np.eye(3)[slides[0]], none
        case 1, 1 if slides == turns:
            return JointKind.CYLINDRICAL, np.eye(3)[turns[0]], none
        case 0, 2:
            return JointKind.UNIVERSAL, np.eye(3)[turns[0]], np.eye(3)[turns[1]]
        case 0, 3:
            return JointKind.BALL, none, none
        case 2, 1 if turns[0] not in slides:
            return JointKind.PLANAR, np.eye(3)[turns[0]], none
        case _:
            return JointKind.FLOATING, none, none


def _drawn_position(kind: JointKind, axis: Array, pose: Pose) -> float:
    """Position [rad or m] of a joint with one degree of freedom, from the second placement in the first."""
    if kind is JointKind.PRISMATIC:
        return round(float(pose.p @ axis), 9) + 0.0
    if not kind.is_hinge:
        return 0.0
    u = np.roll(axis, 1)  # the next of x, y, z: perpendicular to the axis
    turned = pose.turn(u)
    return round(atan2(float(turned @ np.cross(axis, u)), float(turned @ u)), 9) + 0.0


def _limits(pair: KinematicPair, kind: JointKind, scale: float) -> Limit | None:
    low, high = pair.bounds
    if not kind.bounded or low is None or high is None or low >= high:
        return None
    factor = scale if kind is JointKind.PRISMATIC else 1.0
    return Limit(low * factor, high * factor)


def _letter(axis: Array) -> str | Vector3:
    for letter, e in zip(_AXES, np.eye(3), strict=True):
        if np.array_equal(axis, e) or np.array_equal(axis, -e):
            return letter if axis @ e > 0 else f"-{letter}"
    return "z" if not axis.any() else vector3(unit(axis))


def _parts(pair: KinematicPair, members: Sequence[Sequence[int]], assembly: Assembly) -> tuple[str, str]:
    first, second = (assembly.components[members[link][0]].path for link in pair.links)
    return first, second
