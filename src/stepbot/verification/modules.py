"""Compares each module of a composed robot with the module alone; shares no code with the composition."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.report.robot import Check, Status
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Actuator, Joint, JointKind, Module, Robot

_CONFIGURATIONS = 4
_REACH = 0.4
"""Largest distance [rad] or [m] of a position from the drawn one."""
_NORMALS = {"x": (-1.0, 1.0, 1.0), "y": (1.0, -1.0, 1.0), "z": (1.0, 1.0, -1.0)}


class Alone(NamedTuple):
    """A module of a composed robot, and what it is compared with."""

    module: Module
    robot: Robot
    """Its robot alone."""
    flips: Collection[str] = ()
    """Joints, by their names in ``robot``, whose positive direction is reversed."""


@dataclass(frozen=True)
class ModuleDeviation:
    """How far a module in a composed robot is from the module alone."""

    pose: float
    """Largest distance of a link's frame [m], and of its axes' ends [1]."""
    mass: float
    """Largest relative error of a link's mass."""
    inertia: float
    """Largest error of a link's centre of mass [m] and inertia [kg m^2], relative to the largest in the module."""
    settings: tuple[str, ...] = ()
    """Joints and actuators, by their names in the module, with another kind, limit, dynamics, mimic or given gain."""

    @property
    def largest(self) -> float:
        """The largest of all numbers."""
        return max(self.pose, self.mass, self.inertia)


ALLOWED = 1e-9
"""Deviation of a module from the module alone: rounding of its poses in the composed robot."""


def module_checks(module: Module, seen: ModuleDeviation) -> tuple[Check, ...]:
    """The comparison of a module with the module alone, as checks of the report."""
    measured = {
        "poses": (seen.pose, "m", f"{len(module.links)} links in {_CONFIGURATIONS} configurations"),
        "mass": (seen.mass, "of each link", f"{len(module.links)} links"),
        "inertia": (seen.inertia, "of the largest", f"{len(module.links)} links, with their centres of mass"),
    }
    against = f"module '{module.name}' alone"
    checks = [
        Check("", "", "stepbot", quantity, _status(off <= ALLOWED), off, ALLOWED, unit, where, against=against)
        for quantity, (off, unit, where) in measured.items()
    ]
    other = ", ".join(f"'{name}'" for name in seen.settings)
    where = other or "limits, dynamics, mimics, drives"
    settings = Check("", "", "stepbot", "settings", _status(not other), where=where, against=against)
    return *checks, settings


def _status(passed: bool) -> Status:
    return Status.PASSED if passed else Status.FAILED


def module_deviations(robot: Robot, modules: Sequence[Alone]) -> Iterator[ModuleDeviation]:
    """Compare the links of modules with those of their own robots, in several configurations.

    Each link's pose is compared relative to the module's other links; that of the whole in the composed robot is free.

    Yields:
        The deviation of each module.
    """
    configurations: list[dict[str, float]] = [{} for _ in range(_CONFIGURATIONS)]
    joints = {joint.child: joint.name for joint in robot.joints}
    robots = {id(one.robot): one.robot for one in modules}
    poses_alone = {key: [(q, link_poses(one, q)) for q in _configurations(one)] for key, one in robots.items()}
    for module, alone, flips in modules:
        inside = {joints[link] for link in module.links if link in joints}
        for whole, (q, _) in zip(configurations, poses_alone[id(alone)], strict=True):
            of_module = {module.prefix + name: -v if name in flips else v for name, v in q.items()}
            whole |= {name: v for name, v in of_module.items() if name in inside}
    poses = [link_poses(robot, q) for q in configurations]
    for one in modules:
        yield _deviation(robot, one, poses, [there for _, there in poses_alone[id(one.robot)]])


def _deviation(
    robot: Robot, one: Alone, poses: Sequence[dict[str, Pose]], poses_alone: Sequence[dict[str, Pose]]
) -> ModuleDeviation:
    module, alone, _ = one
    M: Array = np.eye(3)
    for normal in module.mirror:
        M = M @ np.diag(_NORMALS[normal])
    there = {name: robot.link_by_name[name] for name in module.links}
    links = [link for link in alone.links if module.prefix + link.name in there]
    pose = 0.0
    for X_W, X in zip(poses, poses_alone, strict=True):
        common = [(X_W[module.prefix + link.name], _image(X[link.name], M)) for link in links[1:]]
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
    return ModuleDeviation(pose, mass, inertia, tuple(_other_settings(robot, one)))


def _other_settings(robot: Robot, one: Alone) -> Iterator[str]:
    """Names of the joints and actuators whose numbers are not those of the module alone."""
    module, alone, flips = one
    inside = set(module.links)  # another module may have a name of what was left out of this one
    joints = {joint.name: joint for joint in robot.joints if joint.child in inside}
    actuators = {each.name: each for each in robot.actuators if each.joint in joints}
    for joint in alone.joints:
        here = joints.get(module.prefix + joint.name)
        is_image = len(module.mirror) == 1
        if here is not None and _numbers(here, "", ()) != _numbers(joint, module.prefix, flips, is_image):
            yield joint.name
    for actuator in alone.actuators:
        drive = actuators.get(module.prefix + actuator.name)
        if drive is not None and _drive(drive) != _drive(actuator, actuator.joint in flips):
            yield actuator.name


def _numbers(joint: Joint, prefix: str, flips: Collection[str], mirrored: bool = False) -> tuple[object, ...]:
    """What the composed robot is to have of a joint; the axis is compared by poses, the drawn position is `home`."""
    turned = joint.name in flips
    limit, dynamics, mimic = joint.limit, joint.dynamics, joint.mimic
    bounds = (-limit.upper, -limit.lower) if turned else (limit.lower, limit.upper)
    if turned:
        dynamics = replace(dynamics, spring_reference=0.0 - dynamics.spring_reference)
    follows: tuple[object, ...] = ()
    if mimic is not None:
        sign = -1.0 if turned != (mimic.joint in flips) else 1.0
        offset = -mimic.offset if turned else mimic.offset
        follows = (prefix + mimic.joint, sign * mimic.multiplier, offset)
    pitch = -joint.pitch if mirrored and joint.kind is JointKind.SCREW else joint.pitch
    return joint.kind, bounds, replace(limit, lower=0.0, upper=0.0), dynamics, follows, pitch


def _drive(actuator: Actuator, turned: bool = False) -> tuple[object, ...]:
    """An actuator's numbers; computed gains depend on the whole robot."""
    limit = actuator.limit
    bounds = (-limit.upper, -limit.lower) if turned else (limit.lower, limit.upper)
    gains = (actuator.kp, actuator.kv) if actuator.tuning is None else ()
    return actuator.kind, actuator.gear, bounds, replace(limit, lower=0.0, upper=0.0), gains, actuator.motor


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
