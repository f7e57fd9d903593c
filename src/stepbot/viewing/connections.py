"""Joints and closures as a person reviews them: type, limits, evidence, and a mark where the evidence is weak."""

from collections.abc import Iterable, Mapping, Sequence

from stepbot.report.plain import Json, picked
from stepbot.report.words import direction_words, evidence_words, point_words, rival_words
from stepbot.robot.joint_table import JointRow
from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import Joint, JointKind, LoopClosure, Robot
from stepbot.robot.multi_dof import unfolded
from stepbot.sidecar.draft_comments import DraftedStop
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

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
        rows: The joint table.
        reviews: The REVIEW comments of drafted joints; where one has none, the doubt of the joint table counts.
        stops: The stops that the sidecar's comments give for drafted joints.
    """
    return {
        row.name: {
            "evidence": evidence_words(row.evidence),
            "doubt": reviews.get(row.name) or row.evidence.doubt,
            "at": "" if row.origin is None else point_words(row.origin),
            "along": "" if row.axis is None else direction_words(row.axis),
            "others": [rival_words(one) for one in row.evidence.rivals],
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
