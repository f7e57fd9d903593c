"""Compares each module of a composed robot with the module alone; shares no code with the composition."""

from collections.abc import Collection
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Module, Robot

_CONFIGURATIONS = 4
_REACH = 0.4
"""Largest distance [rad] or [m] of a position from the drawn one."""
_NORMALS = {"x": (-1.0, 1.0, 1.0), "y": (1.0, -1.0, 1.0), "z": (1.0, 1.0, -1.0)}


@dataclass(frozen=True)
class ModuleDeviation:
    """How far a module in a composed robot is from the module alone."""

    pose: float
    """Largest distance of a link's frame [m], and of its axes' ends [1]."""
    mass: float
    """Largest relative error of a link's mass."""
    inertia: float
    """Largest error of a link's centre of mass [m] and inertia [kg m^2], relative to the largest in the module."""

    @property
    def largest(self) -> float:
        """The largest of all."""
        return max(self.pose, self.mass, self.inertia)


def module_deviation(robot: Robot, module: Module, alone: Robot, flips: Collection[str] = ()) -> ModuleDeviation:
    """Compare the links of a module with those of its own robot, in several configurations.

    Each link's pose is compared relative to the module's other links; that of the whole in the composed robot is free.

    Args:
        robot: The composed robot.
        module: The module.
        alone: Its robot.
        flips: Patterns of joints, by their names in ``alone``, whose positive direction is reversed.
    """
    M: Array = np.diag(_NORMALS[module.mirror]) if module.mirror else np.eye(3)
    there = robot.link_by_name
    links = [link for link in alone.links if module.prefix + link.name in there]
    pose = 0.0
    for q in _configurations(alone):
        of_module = {module.prefix + name: -v if _any(name, flips) else v for name, v in q.items()}
        X_W = link_poses(robot, {name: v for name, v in of_module.items() if name in robot.joint_by_name})
        X_A = {name: _image(X, M) for name, X in link_poses(alone, q).items()}
        common = [(X_W[module.prefix + link.name], X_A[link.name]) for link in links[1:]]
        # The frame of the root link may be moved onto the axis of a joint, so the first other link is the reference.
        for ours, theirs in common[1:]:
            off = (common[0][0].inverse() @ ours).matrix - (common[0][1].inverse() @ theirs).matrix
            pose = max(pose, float(np.abs(off).max()))
    masses = [(there[module.prefix + link.name].mass_properties, link.mass_properties) for link in links]
    mass = max((abs(a.mass - b.mass) / b.mass for a, b in masses if b.mass), default=0.0)
    size = max((float(np.abs(b.inertia).max()) for _, b in masses), default=0.0) or 1.0
    inertia = 0.0
    for a, b in masses[1:]:
        inertia = max(inertia, float(np.abs(a.inertia - M @ np.array(b.inertia) @ M).max()) / size)
        inertia = max(inertia, float(np.abs(a.com - M @ np.array(b.com)).max()) if b.mass else 0.0)
    return ModuleDeviation(pose, mass, inertia)


def _configurations(robot: Robot) -> list[dict[str, float]]:
    """The drawn pose, and some near it: positions of all joints that follow no other."""
    free = [joint for joint in robot.joints if joint.kind.is_pair and joint.mimic is None]
    drawn = {joint.name: joint.drawn_position for joint in free}
    random = np.random.default_rng(0)
    return [
        {name: position + scale * _REACH * float(random.uniform(-1.0, 1.0)) for name, position in drawn.items()}
        for scale in (0.0, *(1.0,) * (_CONFIGURATIONS - 1))
    ]


def _image(X: Pose, M: Array) -> Pose:
    return Pose.of(M @ X.R @ M, M @ X.p)


def _any(name: str, patterns: Collection[str]) -> bool:
    return any(fnmatchcase(name, pattern) for pattern in patterns)
