"""Python that holds the loops of a robot together in PyBullet, which reads them from no file."""

from .loops import held_by_a_point
from .model import JointKind, LoopClosure, Robot
from .spatial import Pose

SECOND_POINT = 0.05
"""Distance [m] along the axis of a pin at which a second point is held, where one does not hold the axis."""

_CODE = '''\
"""Holds the loops of {robot} closed in PyBullet: body = pybullet.loadURDF(...), then close_loops(body)."""

{imports}

# Constraint, link A, position [m] and quaternion (x, y, z, w) in it, link B, the same in it, axis in A's frame there.
LOOPS = (
{loops}
)


def close_loops(body):
    """Add the constraints, as loaded or at any pose that closes the loops; gives their ids."""
    links = {{pybullet.getBodyInfo(body)[0].decode(): -1}}
    for joint in range(pybullet.getNumJoints(body)):
        links[pybullet.getJointInfo(body, joint)[12].decode()] = joint

    def in_inertial_frame(link, position, turn):
        inertial = pybullet.getDynamicsInfo(body, links[link])[3:5]
        return pybullet.multiplyTransforms(*pybullet.invertTransform(*inertial), position, turn)

    constraints = []
    for kind, link_a, p_A, turn_A, link_b, p_B, turn_B, axis in LOOPS:
        a, b = in_inertial_frame(link_a, p_A, turn_A), in_inertial_frame(link_b, p_B, turn_B)
        along = pybullet.multiplyTransforms((0, 0, 0), a[1], axis, (0, 0, 0, 1))[0]
        constraints.append(
            pybullet.createConstraint(
                body, links[link_a], body, links[link_b], getattr(pybullet, kind), along, a[0], b[0], a[1], b[1]
            )
        )
    return constraints
'''


def pybullet_snippet(robot: Robot) -> str:
    """A module with one function, ``close_loops(body)``; empty for a robot without loops.

    Planar mechanisms are held at one point of each pin: more would jam pins that are not exactly parallel.
    """
    if not robot.closures:
        return ""
    by_a_point = held_by_a_point(robot)
    loops = [entry for closure in robot.closures for entry in _entries(closure, closure.name in by_a_point)]
    return _CODE.format(
        robot=robot.name, imports="import pybullet", loops="\n".join(f"    {entry}," for entry in loops)
    )


def _entries(closure: LoopClosure, by_a_point: bool) -> list[str]:
    kinds = {JointKind.FIXED: "JOINT_FIXED", JointKind.PRISMATIC: "JOINT_PRISMATIC"}
    kind = kinds.get(closure.kind, "JOINT_POINT2POINT")
    shifts = [Pose()]
    if closure.kind is JointKind.REVOLUTE and not by_a_point:
        shifts.append(Pose.of(position=[SECOND_POINT * direction for direction in closure.axis]))
    return [
        repr(
            (
                kind,
                closure.link_a,
                *_frame(closure.X_AF @ shift),
                closure.link_b,
                *_frame(closure.X_BF @ shift),
                closure.axis,
            )
        )
        for shift in shifts
    ]


def _frame(X: Pose) -> tuple[tuple[float, ...], tuple[float, ...]]:
    w, x, y, z = X.quaternion
    return X.position, (x, y, z, w)
