"""Compares each module of a composed robot with the module alone; shares no code with the composition."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, ObservedShape, Quantity, Request
from stepbot.engines.reference import Reference
from stepbot.geometry.spatial import Array, Pose, matrix3, vector3
from stepbot.robot.bounding_boxes import Bounds
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.model import JointKind, Module, Robot
from stepbot.robot.renaming import NewNames

from .compare import Compared, compare
from .counterparts import with_new_names
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


def in_model(robot: Robot, modules: Sequence[Alone]) -> Iterator[tuple[Alone, Compared]]:
    """Compare the modules in the model of a composed robot with the modules alone, in several configurations."""
    configurations: list[dict[str, float]] = [{} for _ in range(_CONFIGURATIONS)]
    joints = {joint.child: joint.name for joint in robot.joints}
    alone = {id(one.robot): _configurations(one.robot) for one in modules}
    for module, of, flips in modules:
        inside = {joints[link] for link in module.links if link in joints}
        for whole, q in zip(configurations, alone[id(of)], strict=True):
            of_module = {module.prefix + name: -v if name in flips else v for name, v in q.items()}
            whole |= {name: v for name, v in of_module.items() if name in inside}
    request, reference = Request("", "", tuple(configurations)), Reference()
    seen = reference.observe(robot, request, dynamics=False)
    for one in modules:
        for compared in as_alone(one, one.robot, robot, seen, request, reference):
            yield one, compared


def as_alone(
    one: Alone, lowered: Robot, whole: Robot, observed: Observation, request: Request, reference: Reference
) -> Iterator[Compared]:
    """Compare what an engine reports of a module in a composed robot with the module alone.

    The frame of a module's root link may be moved onto the axis of the joint that it hangs on, so only the mass of that
    link is compared below a joint. Drives with computed gains and those of reversed joints are left out.

    Args:
        lowered: The module's robot as the file's format expresses it.
        whole: The composed robot, likewise.
        observed: The engine's observation of the file.
        request: What the engine was asked.
    """
    module, alone, flips = one
    if module.mirror and lowered is not alone and any(joint.kind not in _SAME_COORDINATES for joint in alone.joints):
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
    mount = next((joint for joint in whole.joints if joint.child == root), None)
    is_moved = mount is not None and mount.kind not in (JointKind.FIXED, JointKind.FLOATING)
    moving = [joint.name for joint in moving_joints(lowered)]
    configurations = [*request.configurations, *request.closed]  # as in the poses of an observation
    names = {name: _coordinate(name, joints) for name in dict.fromkeys(chain.from_iterable(configurations))}
    q = tuple(
        {
            names[name]: -value if names[name] in flips else value
            for name, value in each.items()
            if names[name] in moving
        }
        for each in configurations
    )
    asked = replace(request, configurations=q, rates=(), closures=(), ways=(), driven=())
    driven = set(joints.values()) - set(flips)  # without what is left out
    given = {each.joint: each.name for each in lowered.actuators if each.tuning is None and each.joint in driven}
    expected = _part(reference.observe(lowered, asked, dynamics=False), tuple(links.values()), given, is_moved=is_moved)
    for normal in module.mirror:
        expected = _reflected(expected, np.diag(_NORMALS[normal]))
    expected = replace(expected, joints=tuple(_reversed(joint, flips) for joint in expected.joints))
    drives_here = {name: module.prefix + given[of] for name, of in joints.items() if of in given}
    seen = with_new_names(_part(observed, tuple(links), drives_here, is_moved=is_moved), NewNames(links, joints))
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


def _part(seen: Observation, links: Sequence[str], drives: Mapping[str, str], *, is_moved: bool) -> Observation:
    """What an observation has of a module: its links, the joints between them and their drives.

    Args:
        links: Its links, the root first.
        drives: The names of drives by their joints.
        is_moved: Whether the frame of the root is another one: then only its mass is kept, and poses are relative to
            the second link instead of the root.
    """
    inside, first = set(links[is_moved:]), next(iter(links[is_moved:]), "")
    poses = []
    for each in seen.poses:
        X_FW = each[first].inverse() if first in each else None
        poses.append({} if X_FW is None else {name: X_FW @ X for name, X in each.items() if name in inside})
    known = tuple(link for link in seen.links if link.name in links)
    return Observation(
        seen.engine,
        seen.version,
        seen.format,
        links=tuple(link if link.name in inside else ObservedLink(link.name, link.mass) for link in known),
        joints=tuple(joint for joint in seen.joints if joint.child in links[1:]),
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
        if each.kind not in (*_SAME_COORDINATES, JointKind.SCREW):
            return replace(each, axis=None)
        sign = 1.0 if each.kind == JointKind.PRISMATIC else -1.0  # an axis of rotation is a pseudovector
        axes = [axis and vector3(sign * (M @ np.array(axis))) for axis in (each.axis, each.axis2)]
        return replace(each, axis=axes[0], axis2=axes[1], pitch=each.pitch and -each.pitch)

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


def _image(X: Pose, M: Array) -> Pose:
    return Pose.of(M @ X.R @ M, M @ X.p)


def _configurations(robot: Robot) -> list[dict[str, float]]:
    """The drawn pose, and some near it: positions of all joints that follow no other."""
    free = [joint for joint in robot.joints if joint.kind.is_pair and joint.mimic is None]
    drawn = {joint.name: joint.drawn_position for joint in free}
    random = np.random.default_rng(0)
    return [
        {name: position + scale * _REACH * float(random.uniform(-1.0, 1.0)) for name, position in drawn.items()}
        for scale in (0.0, *(1.0,) * (_CONFIGURATIONS - 1))
    ]
