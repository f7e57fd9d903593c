"""What the page needs to move a robot: its tree with joints of one degree of freedom, its loops, its driven joints.

The page solves forward kinematics and loops itself, by the methods of :mod:`stepbot.robot`.
"""

from math import dist, isfinite

from stepbot.geometry.spatial import Pose
from stepbot.report.plain import Json, picked
from stepbot.robot.bounding_boxes import robot_bounds
from stepbot.robot.closures import CLOSED_ANGLE, LARGEST_JUMP, LARGEST_STEP, RANK_TOLERANCE, Loops, driven_joints
from stepbot.robot.kinematics import (
    MOVING,
    advance,
    independent_joints,
    initial_configuration,
    leader_range,
    mimic_relation,
    sampling_range,
)
from stepbot.robot.model import Joint, JointKind, LoopClosure, Robot
from stepbot.robot.multi_dof import unfolded


def motion_document(robot: Robot) -> Json:
    """Links and joints of the unfolded tree, closures, and the joints that a slider drives."""
    chain = unfolded(robot)
    driven = driven_joints(robot) if robot.closures else tuple(joint.name for joint in independent_joints(robot))
    loops = Loops(robot)
    return {
        "links": [link.name for link in chain.links],
        "joints": [_joint(chain, joint) for joint in chain.joints],
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
    low, high = leader_range(robot, name)
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


def _joint(robot: Robot, joint: Joint) -> Json:
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
