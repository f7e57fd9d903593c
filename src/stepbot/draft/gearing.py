"""Joints that follow others, by gears, belts and racks: what a motor turns leads."""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.teeth import Mesh, RackMesh
from stepbot.draft.draft import DraftJoint
from stepbot.draft.evidence.gears import SAME_GEAR, mesh_between
from stepbot.draft.inference import InferredMechanism
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.geometry.spatial import ZERO3
from stepbot.robot.joint_types import HINGES
from stepbot.robot.model import JointKind, Mimic


def geared(
    inferred: InferredMechanism, tree: Sequence[TreeJoint], joints: Sequence[DraftJoint]
) -> tuple[DraftJoint, ...]:
    """Joints, those that another one moves by a gear, a pulley or a rack with a ``mimic``.

    Args:
        joints: The same as drafted, without mimics.
    """
    made = list(joints)
    turning = [n for n, joint in enumerate(made) if joint.type in HINGES and joint.confidence.is_chosen]
    turning.sort(key=lambda n: (not tree[n].evidence.drives, n))
    for k, leader in enumerate(turning):
        for n in turning[k + 1 :] if made[leader].mimic is None else ():
            one, two = tree[leader], tree[n]
            if one.parent != two.parent or two.evidence.drives or made[n].mimic is not None:
                continue
            members = inferred.links[one.child], inferred.links[two.child]
            mesh = mesh_between(inferred.survey.meshes, *members, (one.evidence.axis, two.evidence.axis))
            if mesh is not None:
                made[n] = _turned(made[leader], made[n], mesh)
    for rack in inferred.survey.rack_meshes:
        _pull(inferred, tree, made, turning, rack)
    return tuple(made)


def _turned(leader: DraftJoint, joint: DraftJoint, mesh: Mesh) -> DraftJoint:
    same = bool(np.dot(leader.direction or ZERO3, joint.direction or ZERO3) > 0.0)
    ratio = mesh.ratio * (1.0 if same == bool(mesh.belt) else -1.0)
    how = f"by the belt '{mesh.belt}'" if mesh.belt else "by gears"
    ratio_is = "that of the pitch circles, count the teeth"
    if mesh.are_counted:
        ratio_is = f"{mesh.one.teeth} to {mesh.two.teeth} teeth, as drawn"
    return _following(leader, joint, ratio, f"{how}; the ratio is {ratio_is}")


def _pull(
    inferred: InferredMechanism,
    tree: Sequence[TreeJoint],
    made: list[DraftJoint],
    turning: Sequence[int],
    mesh: RackMesh,
) -> None:
    """Let the joint along a rack follow that of its gear, if both are on one link."""
    gear = mesh.gear
    for k in turning:
        if gear.part not in inferred.links[tree[k].child] or not tree[k].evidence.axis.same(gear.axis, SAME_GEAR):
            continue
        for n, joint in enumerate(made):
            slides = joint.type is JointKind.PRISMATIC and mesh.part in inferred.links[tree[n].child]
            if slides and tree[n].parent == tree[k].parent and joint.mimic is None and made[k].mimic is None:
                axis, direction = (np.array(one.direction or ZERO3, float) for one in (made[k], joint))
                advance = round(mesh.advance(axis, direction), 9)
                made[n] = _following(made[k], joint, advance, f"by a rack; the gear has {gear.teeth} teeth, as drawn")


def _following(leader: DraftJoint, joint: DraftJoint, multiplier: float, how: str) -> DraftJoint:
    review = f"follows '{leader.child}' {how}"
    notes = f"{joint.review}; {review}" if joint.review else review
    return replace(joint, mimic=Mimic(leader.name, multiplier), review=notes)
