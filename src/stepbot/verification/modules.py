"""Compares each module of a composed robot with the module alone; shares no code with the composition."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, ObservedShape, Quantity, Request
from stepbot.engines.reference import Reference
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, Pose, matrix3, vector3
from stepbot.robot.bounding_boxes import Bounds
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.model import Joint, JointKind, Module, Robot
from stepbot.robot.renaming import NewNames

from .compare import QuantityComparison, compare
from .counterparts import with_new_names

_CONFIGURATIONS = 4
_REACH = 0.4
"""Largest distance [rad] or [m] of a position from the drawn one."""
_NORMALS = {"x": (-1.0, 1.0, 1.0), "y": (1.0, -1.0, 1.0), "z": (1.0, 1.0, -1.0)}


class ModuleAlone(NamedTuple):
    """A module of a composed robot, and what it is compared with."""

    module: Module
    robot: Robot
    """Its robot alone."""
    flips: Collection[str] = ()
    """Joints, by their names in ``robot``, whose positive direction is reversed."""
    led: Collection[str] = ()
    """Joints, likewise, that follow through a loop of the whole, which formats without loops write as mimics."""

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


def in_initial_pose(alone: Robot, robot: Robot, prefix: str, flips: Collection[str]) -> Robot:
    """A module alone, in the initial pose that it has in the whole: some formats have their zeros there."""
    moved = []
    for joint in alone.joints:
        here = robot.joint_by_name.get(prefix + joint.name, joint).drawn_position
        moved.append(replace(joint, drawn_position=0.0 - here if joint.name in flips else here))
    return alone if alone.joints == tuple(moved) else replace(alone, joints=tuple(moved))


def in_model(robot: Robot, modules: Sequence[ModuleAlone]) -> Iterator[tuple[ModuleAlone, QuantityComparison]]:
    """Compare the modules in the model of a composed robot with the modules alone, in several configurations."""
    configurations: list[dict[str, float]] = [{} for _ in range(_CONFIGURATIONS)]
    joints = {joint.child: joint.name for joint in robot.joints}
    alone = {id(one.robot): _configurations(one.robot) for one in modules}
    for module, of, flips, _ in modules:
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
    one: ModuleAlone, lowered: Robot, robot: Robot, observed: Observation, request: Request, reference: Reference
) -> Iterator[QuantityComparison]:
    """Compare what an engine reports of a module in a composed robot with the module alone.

    The frame of a module's root link may be moved onto the axis of the joint that it hangs on, so only the mass of that
    link is compared below a joint. Drives with computed gains and those of reversed joints are left out.

    Args:
        lowered: The module's robot as the file's format expresses it.
        robot: The composed robot, likewise.
        observed: The engine's observation of the file.
        request: What the engine was asked.
    """
    module, alone, flips, led = one
    steps = _steps(alone) if module.mirror else {}
    added = {joint.parent for joint in lowered.joints} - set(alone.link_by_name)  # within joints of several steps
    links = {name: name.removeprefix(module.prefix) for name in module.links}
    links |= {name: link for link in added if (name := module.prefix + link) in robot.link_by_name}
    above, root = {joint.child: joint.name for joint in robot.joints}, module.links[0]
    joints = {above[name]: "" for name in links if name != root and name in above}
    joints |= {
        above[name]: joint.name
        for joint in lowered.joints
        if (name := module.prefix + joint.child) in above and above[name] in joints
    }
    mount = next((joint for joint in robot.joints if joint.child == root), None)
    is_moved = mount is not None and mount.kind not in (JointKind.FIXED, JointKind.FLOATING)
    moving = [joint.name for joint in moving_joints(lowered)]
    configurations = [*request.configurations, *request.closed]  # as in the poses of an observation
    names = {name: _coordinate(name, joints) for name in dict.fromkeys(chain.from_iterable(configurations))}
    images = _images(steps, module.mirror, lowered, robot, names)

    def of_alone(each: Mapping[str, float]) -> dict[str, float]:
        signed = {names[name]: -v if names[name] in flips else v for name, v in each.items() if names[name] in moving}
        sums = {name: exact_sum(each[here] * factor for here, factor in of.items()) for name, of in images.items()}
        return signed | {name: value for name, value in sums.items() if name in signed}

    q = tuple(map(of_alone, configurations))
    asked = replace(request, configurations=q, rates=(), closures=(), ways=(), driven=())
    driven = set(joints.values()) - set(flips)  # without what is left out
    planar = {joint.child for joint in lowered.joints if steps.get(joint.name, joint).kind is JointKind.PLANAR}
    compared_links = {name: link for name, link in links.items() if link in alone.link_by_name or link not in planar}
    given = {each.joint: each.name for each in lowered.actuators if each.tuning is None and each.joint in driven}
    of_file = reference.observe(lowered, asked, dynamics=False)
    expected = _part(of_file, tuple(compared_links.values()), given, is_moved=is_moved)
    for normal in module.mirror:
        expected = _reflected(expected, np.diag(_NORMALS[normal]))
    seen_here = (_with_own_axis(joint, images) for joint in expected.joints)
    expected = replace(expected, joints=tuple(_reversed(joint, flips) for joint in seen_here))
    drives_here = {name: module.prefix + given[of] for name, of in joints.items() if of in given}
    seen = with_new_names(
        _part(observed, tuple(compared_links), drives_here, is_moved=is_moved), NewNames(links, joints)
    )
    on_their_own = {joint.name for joint in expected.joints if joint.mimic is None}.intersection(led)
    freed = (replace(each, mimic=None) if each.name in on_their_own else each for each in seen.joints)
    seen = replace(seen, joints=tuple(freed))
    drives = tuple(replace(each, name=each.name and given[each.joint]) for each in seen.actuators or ())
    for compared in compare(expected, replace(seen, actuators=None if seen.actuators is None else drives)):
        if compared.quantity in _OF_MODULES and not compared.not_run:
            yield compared


def _coordinate(name: str, joints: Mapping[str, str]) -> str:
    """The name of a joint, or of a coordinate that is named after its joint, in the module alone."""
    if name in joints:
        return joints[name]
    whole = next((joint for joint in joints if name.startswith(joint) and name.removeprefix(joint) in _CHAINS), "")
    return joints[whole] + name.removeprefix(whole) if whole else ""


def _steps(alone: Robot) -> dict[str, Joint]:
    """The coordinates of joints whose mirror images have others, each with its joint."""
    joints = [joint for joint in alone.joints if joint.kind not in _SAME_COORDINATES]
    suffixes = {JointKind.SCREW: ("_slide",)}  # in formats that have no screws
    return {joint.name + suffix: joint for joint in joints for suffix in suffixes.get(joint.kind, joint.kind.chain)}


def _images(
    steps: Mapping[str, Joint], normals: str, lowered: Robot, whole: Robot, names: Mapping[str, str]
) -> dict[str, dict[str, float]]:
    """For each of ``steps``, the coordinates of the whole that it is the sum of, with their factors.

    They follow from the axes: that of a slide is mirrored as a vector, that of a rotation as a pseudovector.

    Args:
        names: Coordinates of the module alone by those of the whole.
    """
    here, there = ({joint.name: joint for joint in moving_joints(robot)} for robot in (whole, lowered))
    images: dict[str, dict[str, float]] = {}
    for step in (there[name] for name in steps if name in there):
        slides, image = step.kind is JointKind.PRISMATIC, np.array(step.axis)
        for normal in normals:
            image = (1.0 if slides else -1.0) * np.array(_NORMALS[normal]) * image
        kin = [here[name] for name, of in names.items() if steps.get(of) is steps[step.name]]
        alike = [one for one in kin if (one.kind is JointKind.PRISMATIC) == slides]
        images[step.name] = {one.name: exact_sum(image * one.axis) for one in alike}
    return images


def _part(observation: Observation, links: Sequence[str], drives: Mapping[str, str], *, is_moved: bool) -> Observation:
    """What an observation has of a module: its links, the joints between them and their drives.

    Args:
        links: Its links, the root first.
        drives: The names of drives by their joints.
        is_moved: Whether the frame of the root is another one: then only its mass is kept, and poses are relative to
            the second link instead of the root.
    """
    inside, first = set(links[is_moved:]), next(iter(links[is_moved:]), "")
    poses = []
    for each in observation.poses:
        X_FW = each[first].inverse() if first in each else None
        poses.append({} if X_FW is None else {name: X_FW @ X for name, X in each.items() if name in inside})
    known = tuple(link for link in observation.links if link.name in links)
    return Observation(
        observation.engine,
        observation.version,
        observation.format,
        links=tuple(link if link.name in inside else ObservedLink(link.name, link.mass) for link in known),
        joints=tuple(joint for joint in observation.joints if joint.child in links[1:]),
        poses=tuple(poses),
        actuators=observation.actuators
        and tuple(
            each for each in observation.actuators if each.joint in drives and each.name in ("", drives[each.joint])
        ),
        not_run=observation.not_run,
    )


def _reflected(observation: Observation, M: Array) -> Observation:
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

    poses = tuple({name: _image(X, M) for name, X in each.items()} for each in observation.poses)
    return replace(
        observation,
        links=tuple(map(link, observation.links)),
        joints=tuple(map(joint, observation.joints)),
        poses=poses,
    )


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


def _with_own_axis(joint: ObservedJoint, images: Mapping[str, Mapping[str, float]]) -> ObservedJoint:
    """A step of a joint, whose axis in the mirrored module is another one; a slide of a screw follows it likewise."""
    if joint.name not in images:
        return joint
    (factor, *_), mimic = [*images[joint.name].values(), 1.0], joint.mimic
    return replace(joint, axis=None, mimic=mimic and replace(mimic, multiplier=factor * mimic.multiplier))


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
