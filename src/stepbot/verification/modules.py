"""Compares each module of a composed robot with the module alone; shares no code with the composition."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, ObservedShape, Quantity, Request
from stepbot.engines.reference import Reference
from stepbot.geometry.spatial import Array, Pose, matrix3, vector3
from stepbot.report.robot import Check, Status
from stepbot.robot.bounding_boxes import Bounds
from stepbot.robot.kinematics import link_poses, moving_joints
from stepbot.robot.model import Actuator, Joint, JointKind, Module, Robot

from .compare import Compared, compare
from .counterparts import Renaming
from .deviation import EQUAL, Deviations

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

    @property
    def against(self) -> str:
        """What its checks are against."""
        return f"module '{self.module.name}' alone"


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


_OF_MODULES = (
    Quantity.LINKS,
    Quantity.JOINTS,
    Quantity.AXES,
    Quantity.LIMITS,
    Quantity.DYNAMICS,
    Quantity.MIMIC,
    Quantity.MASS,
    Quantity.COM,
    Quantity.INERTIA,
    Quantity.POSES,
    Quantity.MESHES,
    Quantity.ACTUATORS,
)
"""Quantities of a module that do not depend on what it is attached to."""
_SAME_COORDINATES = (
    JointKind.FIXED,
    JointKind.REVOLUTE,
    JointKind.CONTINUOUS,
    JointKind.PRISMATIC,
    JointKind.UNIVERSAL,
)
"""Joints whose positions are those of their mirror images, however a format represents them."""
_CHAINS = frozenset(suffix for kind in JointKind for suffix in kind.chain)
"""What the names of coordinates add to those of their joints."""


def as_alone(
    one: Alone, lowered: Robot, whole: Robot, observed: Observation, request: Request, reference: Reference
) -> Iterator[Compared]:
    """Compare what an engine reports of a module in a composed robot with the module alone.

    The frame of a module's root link may be moved onto the axis of the joint that it hangs on, so that link is left out
    below a joint. Computed gains depend on the whole robot, and drives of reversed joints are left out.

    Args:
        lowered: The module's robot as the file's format expresses it.
        whole: The composed robot, likewise.
        observed: The engine's observation of the file.
        request: What the engine was asked.
    """
    module, alone, flips = one
    if module.mirror and any(joint.kind not in _SAME_COORDINATES for joint in alone.joints):
        why = "its joints of several degrees of freedom have other coordinates than their mirror images"
        yield Compared(Quantity.POSES, Deviations(EQUAL), why)
        return
    added = {joint.parent for joint in lowered.joints} - set(alone.link_by_name)  # within joints of several steps
    links = {name: name.removeprefix(module.prefix) for name in module.links}
    links |= {name: link for link in added if (name := module.prefix + link) in whole.link_by_name}
    above, root = {joint.child: joint.name for joint in whole.joints}, module.links[0]
    joints = {above[name]: "" for name in links if name != root and name in above}
    joints |= {
        above[name]: joint.name
        for joint in lowered.joints
        if (name := module.prefix + joint.child) in above and above[name] in joints
    }
    is_moved = not module.at and root != whole.root.name
    kept = {name: link for name, link in links.items() if not (is_moved and name == root)}
    if not kept:
        return
    moving = [joint.name for joint in moving_joints(lowered)]
    names = {name: _coordinate(name, joints) for name in (request.configurations or ({},))[0]}
    q = tuple(
        {
            names[name]: -value if names[name] in flips else value
            for name, value in each.items()
            if names[name] in moving
        }
        for each in request.configurations
    )
    asked = replace(request, configurations=q, rates=(), closures=(), ways=(), driven=())
    given = {each.joint: each.name for each in lowered.actuators if each.tuning is None and each.joint not in flips}
    expected = _part(reference.observe(lowered, asked, dynamics=False), list(kept.values()), lowered.root.name, given)
    for normal in module.mirror:
        expected = _reflected(expected, np.diag(_NORMALS[normal]))
    expected = replace(expected, joints=tuple(_reversed(joint, flips) for joint in expected.joints))
    driven = {name: module.prefix + given[of] for name, of in joints.items() if of in given}
    seen = Renaming(links, joints).seen(_part(observed, list(kept), root, driven))
    drives = tuple(replace(each, name=each.name and given[each.joint]) for each in seen.actuators or ())
    for compared in compare(expected, replace(seen, actuators=None if seen.actuators is None else drives)):
        if compared.quantity in _OF_MODULES and not compared.not_run:
            yield compared


def _coordinate(name: str, joints: Mapping[str, str]) -> str:
    """The name of a joint, or of a coordinate that is named after its joint, in the module alone."""
    if name in joints:
        return joints[name]
    whole = next((one for one in joints if name.startswith(one) and name.removeprefix(one) in _CHAINS), "")
    return joints[whole] + name.removeprefix(whole) if whole else ""


def _part(seen: Observation, links: Sequence[str], root: str, drives: Mapping[str, str]) -> Observation:
    """What an observation has of some links, the joints between them and their drives; poses relative to the first.

    Args:
        root: The module's root, whose joint is not a part of it.
        drives: The names of drives by their joints.
    """
    inside, first = set(links), links[0]
    poses = []
    for each in seen.poses:
        X_FW = each[first].inverse() if first in each else None
        poses.append({} if X_FW is None else {name: X_FW @ X for name, X in each.items() if name in inside})
    return Observation(
        seen.engine,
        seen.version,
        seen.format,
        links=tuple(link for link in seen.links if link.name in inside),
        joints=tuple(joint for joint in seen.joints if joint.child in inside and joint.child != root),
        poses=tuple(poses),
        actuators=seen.actuators
        and tuple(each for each in seen.actuators if each.joint in drives and each.name in ("", drives[each.joint])),
        not_run=seen.not_run,
    )


def _reflected(seen: Observation, M: Array) -> Observation:
    """The mirror image of a part, each frame mirrored in its own coordinates."""

    def box(bounds: Bounds | None) -> Bounds | None:
        if bounds is None:
            return None
        ends = np.array(bounds) @ M
        return vector3(ends.min(axis=0)), vector3(ends.max(axis=0))

    def shapes(ones: tuple[ObservedShape, ...] | None) -> tuple[ObservedShape, ...] | None:
        return ones and tuple(replace(each, bounds=box(each.bounds), oblique=None) for each in ones)

    def link(each: ObservedLink) -> ObservedLink:
        return replace(
            each,
            com=each.com and vector3(M @ np.array(each.com)),
            inertia=each.inertia and matrix3(M @ np.array(each.inertia) @ M),
            visual_bounds=box(each.visual_bounds),
            collision_bounds=box(each.collision_bounds),
            visuals=shapes(each.visuals),
            collisions=shapes(each.collisions),
        )

    def joint(each: ObservedJoint) -> ObservedJoint:
        sign = 1.0 if each.kind == JointKind.PRISMATIC else -1.0  # an axis of rotation is a pseudovector
        axes = [axis and vector3(sign * (M @ np.array(axis))) for axis in (each.axis, each.axis2)]
        return replace(each, axis=axes[0], axis2=axes[1])

    poses = tuple({name: _image(X, M) for name, X in each.items()} for each in seen.poses)
    return replace(seen, links=tuple(map(link, seen.links)), joints=tuple(map(joint, seen.joints)), poses=poses)


def _reversed(joint: ObservedJoint, flips: Collection[str]) -> ObservedJoint:
    """A joint with its positive direction reversed if it is one of some, and following those that are."""
    turned, limit, dynamics, mimic = joint.name in flips, joint.limit, joint.dynamics, joint.mimic
    if mimic is not None:
        sign = -1.0 if turned != (mimic.joint in flips) else 1.0
        mimic = replace(mimic, multiplier=sign * mimic.multiplier, offset=-mimic.offset if turned else mimic.offset)
    if not turned:
        return replace(joint, mimic=mimic)
    limit = limit and replace(limit, lower=-limit.upper, upper=-limit.lower)
    dynamics = dynamics and replace(dynamics, spring_reference=-dynamics.spring_reference)
    axis = joint.axis and vector3(-np.array(joint.axis))
    return replace(joint, axis=axis, limit=limit, dynamics=dynamics, mimic=mimic)
