"""Joints and closures: as the page moves them, and as a person reviews them, with limits, evidence and doubts.

The page solves forward kinematics and loops itself, by the methods of :mod:`stepbot.robot`.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import dist, isfinite

from stepbot.geometry.spatial import Pose
from stepbot.report.plain import Json, picked
from stepbot.report.words import direction_words, evidence_words, point_words, rival_words
from stepbot.robot.bounding_boxes import robot_bounds
from stepbot.robot.closures import CLOSED_ANGLE, LARGEST_JUMP, LARGEST_STEP, RANK_TOLERANCE, Loops, driven_joints
from stepbot.robot.joint_table import JointRow
from stepbot.robot.kinematics import (
    MOVING,
    advance,
    independent_joints,
    initial_configuration,
    leader_ranges,
    mimic_relation,
    sampling_range,
)
from stepbot.robot.model import Joint, JointKind, LoopClosure, Robot
from stepbot.robot.multi_dof import unfolded
from stepbot.sidecar.draft_comments import DraftedStop
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted


def motion_document(robot: Robot) -> Json:
    """Links and joints of the unfolded tree, closures, and the joints that a slider drives."""
    chain = unfolded(robot)
    driven = driven_joints(robot) if robot.closures else tuple(joint.name for joint in independent_joints(robot))
    loops = Loops(robot)
    return {
        "links": [link.name for link in chain.links],
        "joints": [_moving_joint(chain, joint) for joint in chain.joints],
        "closures": [closure_document(closure) for closure in robot.closures],
        "driven": [{"name": name, "range": _slider(robot, name)} for name in driven],
        "solver": {
            "closed_distance": loops.closed_distance,
            "closed_angle": CLOSED_ANGLE,
            "rank": RANK_TOLERANCE,
            "step": LARGEST_STEP,
            "jump": LARGEST_JUMP,
        },
    }


def _slider(robot: Robot, name: str) -> list[float]:
    """The range of a slider [rad] or [m]; a slide without limits goes as far as its two links are large."""
    joint = unfolded(robot).joint_by_name[name]
    low, high = leader_ranges(robot, [name])[name]
    ends = (joint.limit.lower, joint.limit.upper)
    if joint.kind is not JointKind.PRISMATIC or all(map(isfinite, ends)) or (low, high) != sampling_range(joint):
        return [low, high]
    links = [link for link in (joint.parent, joint.child) if link in robot.link_by_name]
    box = robot_bounds(robot, initial_configuration(robot), links)
    size = high if box is None else dist(*box)
    known = [joint.drawn_position, *filter(isfinite, ends)]
    lower, upper = ends
    return [lower if isfinite(lower) else min(known) - size, upper if isfinite(upper) else max(known) + size]


def pose_numbers(X: Pose) -> list[float]:
    """The rotation by rows, then the position [m]: twelve numbers."""
    return [*(value for row in X.rotation for value in row), *X.position]


def closure_document(closure: LoopClosure) -> Json:
    """A closure with its frames."""
    X_AF, X_BF = pose_numbers(closure.X_AF), pose_numbers(closure.X_BF)
    return picked(closure, "name kind a=link_a X_AF b=link_b X_BF axis", X_AF=X_AF, X_BF=X_BF)


def _moving_joint(robot: Robot, joint: Joint) -> Json:
    moves = joint.kind in MOVING
    leader, multiplier, offset = mimic_relation(robot, joint.name) if moves else ("", 0.0, 0.0)
    return {
        **picked(joint, "name parent child X axis", X=pose_numbers(joint.X_PC)),
        "turn": float(moves and joint.kind is not JointKind.PRISMATIC),
        "advance": advance(joint),
        "moves": moves,
        "leader": leader,
        "multiplier": multiplier,
        "offset": offset,
        **picked(joint.limit, "lower upper"),
        "drawn": joint.drawn_position,
    }


NO_REVIEWS: Mapping[str, str] = {}
NO_STOPS: Mapping[str, Sequence[DraftedStop]] = {}


def connection_documents(robot: Robot, evidence: Mapping[str, Json]) -> list[Json]:
    """Every joint, then every closure, each with its evidence by name."""
    chain = {joint.child: joint for joint in unfolded(robot).joints}
    joints = [_joint(joint, _coordinates(joint, chain), evidence) for joint in robot.joints]
    return [*joints, *(_closure(closure, evidence) for closure in robot.closures)]


def evidence_of_rows(
    rows: Iterable[JointRow],
    reviews: Mapping[str, str] = NO_REVIEWS,
    stops: Mapping[str, Sequence[DraftedStop]] = NO_STOPS,
) -> dict[str, Json]:
    """The evidence of each row of a joint table: in words, why it is weak, the other lines, the stops of the draft.

    Args:
        reviews: The REVIEW comments of drafted joints; where one has none, the doubt of the joint table counts.
        stops: The stops that the sidecar's comments give for drafted joints.
    """
    return {
        row.name: {
            "evidence": evidence_words(row.evidence),
            "doubt": reviews.get(row.name) or row.evidence.doubt,
            "at": "" if row.origin is None else point_words(row.origin),
            "along": "" if row.axis is None else direction_words(row.axis),
            "others": [rival_words(rival) for rival in row.evidence.rivals],
            "stops": [picked(one, "position parts") for one in stops.get(row.name, ())],
        }
        for row in rows
    }


def _coordinates(joint: Joint, chain: Mapping[str, Joint]) -> list[str]:
    """Names of the moving joints of one degree of freedom between the links of a joint, from the parent on."""
    names: list[str] = []
    link = joint.child
    while link != joint.parent:
        step = chain[link]
        names[:0] = [step.name] if step.kind in MOVING else []
        link = step.parent
    return names


def _joint(joint: Joint, coordinates: list[str], evidence: Mapping[str, Json]) -> Json:
    mimic = joint.mimic
    return {
        **picked(joint, "name kind parent child"),
        "closes": False,
        "axis": list(joint.axis) if joint.kind.has_axis else None,
        "axis2": list(joint.axis2) if joint.kind is JointKind.UNIVERSAL else None,
        "coordinates": coordinates,
        "limits": picked(joint.limit, "lower upper velocity effort"),
        "mimic": None if mimic is None else [mimic.joint, mimic.multiplier, mimic.offset],
        "pitch": joint.pitch if joint.kind is JointKind.SCREW else None,
        **evidence.get(joint.name, _UNKNOWN),
    }


def _closure(closure: LoopClosure, evidence: Mapping[str, Json]) -> Json:
    return {
        **picked(closure, "name kind parent=link_a child=link_b"),
        "closes": True,
        "axis": list(closure.axis) if closure.kind.has_axis else None,
        "coordinates": [],
        **evidence.get(closure.name, _UNKNOWN),
    }


_UNKNOWN: Json = {"evidence": "", "doubt": "", "others": [], "stops": []}
"""Of a joint whose place is stated, not found."""


def component_documents(assembly: Assembly, robot: Robot) -> list[Json]:
    """Components with their paths as a sidecar writes them, and the links that own their bodies."""
    owner = {path: link.name for link in robot.links for path in link.components}
    return [
        {
            "path": component.path,
            "quoted": quoted(component.path),
            "parent": component.parent,
            "name": component.occurrence or component.product or component.segment,
            "product": component.product,
            "material": component.material,
            "has_body": component.body >= 0,
            "link": owner.get(component.path, ""),
        }
        for component in assembly.components
    ]
