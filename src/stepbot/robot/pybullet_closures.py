"""Loop closures as PyBullet constraints: PyBullet reads closures from no file, so a program adds them after loading.

:func:`loop_constraints` computes the list ``pybullet`` of ``report.json``; :func:`add_constraints` applies it to a
loaded body.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import asdict

if TYPE_CHECKING:
    from stepbot.geometry.spatial import Pose

    from .model import LoopClosure, Robot

SECOND_POINT = 0.05
"""Distance [m] along the axis of a pin at which a second point is constrained, to keep axes aligned."""

Numbers = tuple[float, ...]


class LoopConstraint(Struct, frozen=True):
    """One call of ``pybullet.createConstraint``, with frames in the frames of the links."""

    closure: str
    """Name of its closure; a closure may have several constraints."""
    type: str
    """Name of a PyBullet constant: ``JOINT_POINT2POINT``, ``JOINT_FIXED`` or ``JOINT_PRISMATIC``."""
    link_a: str
    link_b: str
    frame_a: tuple[Numbers, Numbers]
    """Position [m] and quaternion (x, y, z, w) in the frame of ``link_a``."""
    frame_b: tuple[Numbers, Numbers]
    """The same in the frame of ``link_b``."""
    axis: Numbers
    """Shape (3,), in ``frame_a``."""

    @property
    def document(self) -> dict[str, Any]:
        """The entry in ``report.json``."""
        frames = {
            name: {"xyz": list(position), "quaternion": list(turn)}
            for name, (position, turn) in (("frame_a", self.frame_a), ("frame_b", self.frame_b))
        }
        return {**asdict(self), **frames, "axis": list(self.axis)}


def loop_constraints(robot: "Robot") -> tuple[LoopConstraint, ...]:
    """The constraints for the closures of a robot.

    Planar mechanisms are constrained at one point of each pin: more would jam pins that are not exactly parallel.
    """
    from .closures import held_by_a_point

    by_a_point = held_by_a_point(robot) if robot.closures else ()
    return tuple(
        constraint for closure in robot.closures for constraint in constraints_of(closure, closure.name in by_a_point)
    )


def constraints_of(closure: "LoopClosure", by_a_point: bool) -> list[LoopConstraint]:
    """The constraints for one closure.

    Args:
        by_a_point: Whether one point of its axis is sufficient.
    """
    from stepbot.geometry.spatial import Pose

    from .model import JointKind

    types = {JointKind.FIXED: "JOINT_FIXED", JointKind.PRISMATIC: "JOINT_PRISMATIC"}
    shifts = [Pose()]
    if closure.kind is JointKind.REVOLUTE and not by_a_point:
        shifts.append(Pose.of(position=[SECOND_POINT * direction for direction in closure.axis]))
    return [
        LoopConstraint(
            closure=closure.name,
            type=types.get(closure.kind, "JOINT_POINT2POINT"),
            link_a=closure.link_a,
            link_b=closure.link_b,
            frame_a=_frame(closure.X_AF @ shift),
            frame_b=_frame(closure.X_BF @ shift),
            axis=tuple(closure.axis),
        )
        for shift in shifts
    ]


def _frame(X: "Pose") -> tuple[Numbers, Numbers]:
    w, x, y, z = X.quaternion
    return X.position, (x, y, z, w)


def add_constraints(body: int, constraints: Iterable[Mapping[str, Any]], client: int = 0) -> list[int]:
    """Add constraints from ``report.json`` to a body loaded by PyBullet.

    Args:
        body: Id returned by ``pybullet.loadURDF``. Its joints must be at positions that close the loops.
        constraints: The list under ``robot.pybullet`` in ``report.json``.
        client: Id returned by ``pybullet.connect``.

    Returns:
        Ids of the constraints.

    Raises:
        KeyError: The body does not have a link that a constraint refers to.
    """
    import pybullet

    links = {pybullet.getBodyInfo(body, physicsClientId=client)[0].decode(): -1}
    for joint in range(pybullet.getNumJoints(body, physicsClientId=client)):
        links[pybullet.getJointInfo(body, joint, physicsClientId=client)[12].decode()] = joint

    def in_inertial_frame(link: str, frame: Mapping[str, Any]) -> tuple[Any, Any]:
        inertial = pybullet.getDynamicsInfo(body, links[link], physicsClientId=client)[3:5]
        inverse = pybullet.invertTransform(*inertial)
        position, turn = pybullet.multiplyTransforms(*inverse, frame["xyz"], frame["quaternion"])
        return position, turn

    made = []
    for constraint in constraints:
        a = in_inertial_frame(constraint["link_a"], constraint["frame_a"])
        b = in_inertial_frame(constraint["link_b"], constraint["frame_b"])
        along = pybullet.rotateVector(a[1], constraint["axis"])
        made.append(
            pybullet.createConstraint(
                parentBodyUniqueId=body,
                parentLinkIndex=links[constraint["link_a"]],
                childBodyUniqueId=body,
                childLinkIndex=links[constraint["link_b"]],
                jointType=getattr(pybullet, constraint["type"]),
                jointAxis=along,
                parentFramePosition=a[0],
                childFramePosition=b[0],
                parentFrameOrientation=a[1],
                childFrameOrientation=b[1],
                physicsClientId=client,
            )
        )
    return made
