"""A body loaded by PyBullet: names, inertial frames, poses."""

from collections.abc import Mapping
from typing import Any

from msgspec import Struct

from stepbot.geometry.spatial import Pose

from ..observation import EngineCannotRead

_MOST_JOINTS = 127
"""Joints of a body, fixed ones included, of which PyBullet reports a state (``MAX_DEGREE_OF_FREEDOM``)."""


class Body(Struct, frozen=True):
    """A loaded body: names, and the inertial frame of each link."""

    engine: Any
    id: int
    model: str
    links: tuple[str, ...]
    """The base first; PyBullet's index is one less."""
    joints: tuple[tuple[Any, ...], ...]
    """PyBullet's getJointInfo of the joint above each link but the base."""
    X_LI: tuple[Pose, ...]
    """Inertial frame of each link."""

    def X_WI(self, index: int) -> Pose:
        """Pose of a link's inertial frame in the world; the base has index -1."""
        if index < 0:
            position, orientation = self.engine.getBasePositionAndOrientation(self.id)
        else:
            position, orientation = self.engine.getLinkState(self.id, index, computeForwardKinematics=1)[:2]
        return pose(position, orientation)

    def X_WL(self, index: int) -> Pose:
        """Pose of a link in the world."""
        return self.X_WI(index) @ self.X_LI[index + 1].inverse()

    @property
    def coordinates(self) -> dict[str, int]:
        """Index of each joint of one degree of freedom, in the order of PyBullet's velocity vector."""
        moving = sorted((info[4], info[0]) for info in self.joints if info[2] in (0, 1))
        return {self.name(index): index for _, index in moving}

    def name(self, index: int) -> str:
        """Name of the joint above a link."""
        return str(self.joints[index][1].decode("utf-8", "replace"))

    def set(self, q: Mapping[str, float]) -> None:
        """Set every joint to ``q``, at rest; missing joints are at 0."""
        for name, index in self.coordinates.items():
            self.engine.resetJointState(self.id, index, q.get(name, 0.0), 0.0)


def pose(position: Any, xyzw: Any) -> Pose:
    """Pose from PyBullet's position and quaternion, which has w last."""
    x, y, z, w = xyzw
    return Pose.from_quaternion((w, x, y, z), position)


def body_of(engine: Any, body: int) -> Body:
    """PyBullet's description of a loaded body.

    Raises:
        EngineCannotRead: It has too many joints.
    """
    if (count := engine.getNumJoints(body)) > _MOST_JOINTS:
        raise EngineCannotRead(f"PyBullet reports the state of at most {_MOST_JOINTS} joints, the file has {count}")
    joints = tuple(engine.getJointInfo(body, index) for index in range(count))
    base, model = engine.getBodyInfo(body)
    links = [base, *(info[12] for info in joints)]
    inertial = [engine.getDynamicsInfo(body, index)[3:5] for index in range(-1, len(joints))]
    names = tuple(link.decode("utf-8", "replace") for link in links)
    return Body(
        engine, body, model.decode("utf-8", "replace"), names, joints, tuple(pose(*frame) for frame in inertial)
    )
