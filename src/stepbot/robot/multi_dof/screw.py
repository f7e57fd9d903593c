"""A screw joint as a revolute joint of the same name, and a prismatic one that follows it by the pitch."""

from dataclasses import replace
from math import isinf

from ..model import Joint, JointKind, Limit, Mimic, Robot
from .chain import Steps, chained, slide


def screw_to_mimic(robot: Robot) -> Robot:
    """The robot with a following prismatic joint and a revolute joint in place of every screw joint."""
    return chained(robot, JointKind.SCREW, _steps)


def _steps(joint: Joint) -> Steps:
    lower, upper = sorted((joint.pitch * joint.limit.lower, joint.pitch * joint.limit.upper))
    endless = isinf(joint.limit.lower) and isinf(joint.limit.upper)
    advance = replace(
        slide(joint, joint.axis),
        limit=Limit(lower, upper),
        mimic=Mimic(joint.name, joint.pitch),
        drawn_position=joint.pitch * joint.drawn_position,
    )
    turned = replace(joint, kind=JointKind.CONTINUOUS if endless else JointKind.REVOLUTE, pitch=0.0)
    return {"_slide": advance, "": turned}
