"""The true mechanism of a robot by a hand-written sidecar: links as sets of parts, joints as lines in the assembly."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot.assemble.binder import Binder
from stepbot.assemble.claims import claim
from stepbot.assemble.frames import Frames, OriginRequest
from stepbot.assemble.joints import tree_order
from stepbot.assemble.material_assignment import assign_materials
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Array
from stepbot.robot.model import JointKind
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar
from stepbot.step.assembly import Assembly


class TrueJoint(Struct, frozen=True, eq=False):
    """A joint or a closure."""

    name: str
    kind: JointKind
    a: str
    b: str
    point: Array
    axis: Array
    axis2: Array | None = None
    is_closure: bool = False


class Truth(Struct, frozen=True, eq=False):
    """Links, each the union of those connected by fixed joints, and the joints between them."""

    link_of: dict[int, str]
    """For each claimed part its link."""
    joints: list[TrueJoint]
    """Moving joints, except those to links without parts, which cannot be found."""
    root: str


def read_truth(path: Path, assembly: Assembly) -> Truth:
    """Read a sidecar against an assembly.

    Raises:
        ValueError: The sidecar does not fit the assembly; the message has the findings.
    """
    diagnostics = Diagnostics()
    sidecar = load_sidecar(path, diagnostics)
    if sidecar is None:
        raise ValueError("; ".join(d.message for d in diagnostics))
    check_sidecar(sidecar, diagnostics)
    binder = Binder(assembly, sidecar, diagnostics)
    document = binder.document
    root, _ = tree_order(document)
    claims = claim(binder, assign_materials(binder))
    frames = Frames(binder, claims, root)
    parts = {link: claims.parts_of(link) for link in document.links}
    joints = []
    for name, joint in document.joints.items():
        X = frames.joint(name)
        if X is None:
            raise ValueError("; ".join(d.message for d in diagnostics))
        axis2 = getattr(joint, "axis2", None)
        second = X.turn(axis2) if axis2 is not None else None
        axis = X.turn(getattr(joint, "axis", (0.0, 0.0, 1.0)))
        joints.append(TrueJoint(name, joint.type, joint.parent, joint.child, X.p, axis, second))
    for name, closure in document.closures.items():
        X = frames.resolve(
            closure.origin, OriginRequest(("closures", name, "origin"), (closure.link_a, closure.link_b))
        )
        if X is None:
            raise ValueError("; ".join(d.message for d in diagnostics))
        axis = X.turn(closure.axis)
        joints.append(TrueJoint(name, closure.type, closure.link_a, closure.link_b, X.p, axis, is_closure=True))
    return _simplified(parts, joints, root)


def _simplified(parts: dict[str, tuple[int, ...]], joints: list[TrueJoint], root: str) -> Truth:
    """Links connected by fixed joints are one; the children of a link without parts belong to its parent."""
    one = _united(parts, ((j.a, j.b) for j in joints if j.kind == JointKind.FIXED))
    filled = {one[link] for link, members in parts.items() if members}
    above = {one[j.b]: one[j.a] for j in joints if not j.is_closure and one[j.a] != one[j.b]}

    def holder(link: str) -> str:
        link = one[link]
        while link not in filled and link in above:
            link = above[link]
        return link

    moving = [
        TrueJoint(j.name, j.kind, holder(j.a), one[j.b], j.point, j.axis, j.axis2, j.is_closure)
        for j in joints
        if j.kind != JointKind.FIXED and one[j.b] in filled
    ]
    return Truth({i: one[link] for link, members in parts.items() for i in members}, moving, holder(root))


def _united(links: Iterable[str], pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    of = {link: link for link in links}
    for a, b in pairs:
        gone, kept = of[b], of[a]
        of = {link: kept if group == gone else group for link, group in of.items()}
    return of


def unit_distance(point: Array, base: Array, direction: Array) -> float:
    """Distance [m] of a point from a line."""
    return float(np.linalg.norm(np.cross(point - base, direction)))
