"""The robot of a STEP file without a sidecar: parts in their places, and joints as inference drafts them.

It has no masses and no collision shapes. Every drafted joint is a guess, and those below the score of a sure one are
marked for review.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import tau
from typing import Any

from stepbot.assemble.assets import MeshAssets
from stepbot.draft.draft import Draft, DraftConnection, DraftJoint
from stepbot.geometry.spatial import IDENTITY, Pose, perpendicular_frame, unit, vector3
from stepbot.report.words import direction_words, point_words
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.model import GREY, Joint, JointKind, Limit, Link, LoopClosure, Robot, Visual
from stepbot.step.assembly import Assembly, BodyKind

Json = dict[str, Any]


def robot_of_assembly(assembly: Assembly, name: str) -> Robot:
    """All parts in one link, in the frame of the assembly."""
    return _robot(assembly, name, {name: IDENTITY}, {name: _with_bodies(assembly)}, ())


def robot_of_draft(assembly: Assembly, draft: Draft) -> Robot:
    """Links and joints of a draft; parts that it has in no link are in the root."""
    bodies = _with_bodies(assembly)
    parts = {link.name: tuple(i for i in link.components if i in bodies) for link in draft.links}
    taken = {index for indices in parts.values() for index in indices}
    parts[draft.root] = tuple(i for i in bodies if i in parts[draft.root] or i not in taken)
    X_WL = {draft.root: IDENTITY} | {joint.child: _frame(joint) for joint in draft.joints}
    joints = tuple(_joint(joint, X_WL) for joint in draft.joints)
    order = (draft.root, *(joint.child for joint in joints))
    robot = _robot(assembly, draft.robot, {name: X_WL[name] for name in order}, parts, joints)
    closures = tuple(
        LoopClosure(
            one.name,
            one.type,
            one.link_a,
            X_WL[one.link_a].inverse() @ _frame(one),
            one.link_b,
            X_WL[one.link_b].inverse() @ _frame(one),
        )
        for one in draft.closures
    )
    return replace(robot, closures=closures)


def evidence_of_draft(draft: Draft) -> dict[str, Json]:
    """The evidence of each drafted joint and closure, and why to review it."""
    return {one.name: _evidence(one) for one in (*draft.joints, *draft.closures)}


def _evidence(one: DraftConnection) -> Json:
    weak = one.doubt or ("weak evidence, to be reviewed" if one.is_reviewed else "")
    return {
        "evidence": "; ".join((f"a guess, score {one.confidence.score:.2f}", *one.confidence.evidence)),
        "doubt": one.review or weak,
        "at": point_words(one.point),
        "along": "" if one.direction is None else direction_words(vector3(unit(one.direction))),
        "others": [f"{other.type.value} between {other.a} and {other.b}" for other in one.alternatives],
        "stops": [
            {"position": stop.position, "parts": f"'{stop.parts[0]}' and '{stop.parts[1]}'"}
            for stop in (one.stops if isinstance(one, DraftJoint) else ())
        ],
    }


def _with_bodies(assembly: Assembly) -> tuple[int, ...]:
    bodies = assembly.bodies
    return tuple(
        one.index for one in assembly.components if one.body >= 0 and bodies[one.body].kind is not BodyKind.WIRE
    )


def _frame(one: DraftConnection) -> Pose:
    """X_WL of a joint's child, with the axis as z."""
    if one.direction is None:
        return Pose.of(position=one.point)
    return Pose.of(perpendicular_frame(unit(one.direction)), one.point)


def _joint(joint: DraftJoint, X_WL: Mapping[str, Pose]) -> Joint:
    X_WC = X_WL[joint.child]
    limits = joint.limits
    bounded = limits is not None and joint.type not in (JointKind.CONTINUOUS, JointKind.FIXED, JointKind.BALL)
    axis2 = (1.0, 0.0, 0.0)
    if joint.direction2 is not None:
        axis2 = vector3(X_WC.inverse().turn(unit(joint.direction2)))
    return Joint(
        joint.name,
        joint.type,
        joint.parent,
        joint.child,
        X_WL[joint.parent].inverse() @ X_WC,
        axis2=axis2,
        limit=Limit(limits.lower, limits.upper) if bounded and limits is not None else Limit(),
        mimic=joint.mimic,
        pitch=(joint.pitch or 0.0) / tau,
    )


def _robot(
    assembly: Assembly,
    name: str,
    X_WL: Mapping[str, Pose],
    parts: Mapping[str, tuple[int, ...]],
    joints: tuple[Joint, ...],
) -> Robot:
    assets = MeshAssets(assembly)
    links = []
    for link, X in X_WL.items():
        visuals = []
        for index in parts.get(link, ()):
            component = assembly.components[index]
            if len(assembly.bodies[component.body].mesh.faces):
                for group in assets.by_color(component.body, component, None, GREY):
                    X_LC = X.inverse() @ component.X_WC
                    visuals.append(Visual(f"{link}_{index}", group.geometry, X_LC, group.rgba, component.path))
        paths = tuple(assembly.components[index].path for index in parts.get(link, ()))
        links.append(Link(link, visuals=tuple(visuals), components=paths))
    return share_meshes(Robot(name, tuple(links), joints, meshes=assets.all(), source=assembly.source))
