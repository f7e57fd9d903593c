"""Brings what engines see in different formats to the same form, where formats say the same thing in different ways."""

from dataclasses import replace
from math import isfinite

from ..model import Mimic
from ..simulators.observation import Observation
from .bounds import without_stand_ins
from .chains import is_bare

WORLD = "world"
"""Name of the link that stands for the world in many a URDF."""


def alike(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    """Both observations, told in the same way as far as they can be.

    A massless link called ``world`` is the world. A link that is nothing but a frame is a frame where the other side
    has no link of that name. Mimics are resolved to the joint that leads. Only frames that both name are kept: formats
    mark different places, and that makes no other robot. Nor does what the robot and its shapes are called, or which
    colours they have. A file without any velocity limit is taken to say nothing of them: MJCF has no word for them.
    Numbers that stand for no limit are none.
    """
    a, b = (without_stand_ins(_without_world(side)) for side in (a, b))
    links_a, links_b = ({link.name for link in side.links} for side in (a, b))
    a, b = _with_leaders(_with_frames(a, links_b)), _with_leaders(_with_frames(b, links_a))
    a, b = _with_velocities(_without_looks(a)), _with_velocities(_without_looks(b))
    return _with_common_frames(a, b)


def _without_world(observation: Observation) -> Observation:
    """A massless root link called ``world`` on a fixed joint says that the base is fixed."""
    joints = [joint for joint in observation.joints if joint.parent == WORLD]
    world = [link for link in observation.links if link.name == WORLD and is_bare(link)]
    if not world or len(joints) != 1 or joints[0].kind != "fixed":
        return observation
    root = joints[0].child
    poses = []
    for X_W in observation.poses:
        X_RW = X_W[root].inverse()
        poses.append({link: X_RW @ X for link, X in X_W.items() if link != WORLD})
    return replace(
        observation,
        base="fixed",
        links=tuple(link for link in observation.links if link.name != WORLD),
        joints=tuple(joint for joint in observation.joints if joint.parent != WORLD),
        poses=tuple(poses),
    )


def _with_frames(observation: Observation, links: set[str]) -> Observation:
    """Links without mass and shape at the end of a fixed joint are URDF's frames, unless they are among ``links``."""
    parents = {joint.parent for joint in observation.joints}
    bare = {link.name for link in observation.links if is_bare(link)} - parents - links
    mounts = {
        joint.child: joint.parent for joint in observation.joints if joint.kind == "fixed" and joint.child in bare
    }
    if not mounts or not observation.poses:
        return observation
    X_W = observation.poses[0]
    frames = {name: (parent, X_W[parent].inverse() @ X_W[name]) for name, parent in mounts.items()}
    return replace(
        observation,
        links=tuple(link for link in observation.links if link.name not in mounts),
        joints=tuple(joint for joint in observation.joints if joint.child not in mounts),
        poses=tuple({link: X for link, X in poses.items() if link not in mounts} for poses in observation.poses),
        frames={**(observation.frames or {}), **frames},
    )


def _with_leaders(observation: Observation) -> Observation:
    """Every mimic in terms of a joint that does not mimic itself: not every format and reader follows a chain."""
    mimics = {joint.name: joint.mimic for joint in observation.joints if joint.mimic is not None}

    def led(mimic: Mimic) -> Mimic:
        for _ in mimics:
            above = mimics.get(mimic.joint)
            if above is None:
                return mimic
            offset = mimic.multiplier * above.offset + mimic.offset
            mimic = Mimic(above.joint, mimic.multiplier * above.multiplier, offset)
        return mimic  # a circle: nothing to resolve it to

    joints = tuple(
        joint if joint.mimic is None else replace(joint, mimic=led(joint.mimic)) for joint in observation.joints
    )
    return replace(observation, joints=joints)


def _without_looks(observation: Observation) -> Observation:
    links = tuple(replace(link, visuals=None, collisions=None) for link in observation.links)
    return replace(observation, name=None, links=links)


def _with_velocities(observation: Observation) -> Observation:
    if observation.format != "mjcf" or any(j.limit and isfinite(j.limit.velocity) for j in observation.joints):
        return observation
    joints = tuple(
        replace(joint, limit_fields=tuple(field for field in joint.limit_fields if field != "velocity"))
        for joint in observation.joints
    )
    return replace(observation, joints=joints)


def _with_common_frames(a: Observation, b: Observation) -> tuple[Observation, Observation]:
    if a.frames is None or b.frames is None:
        return replace(a, frames=None), replace(b, frames=None)
    names = [name for name in a.frames if name in b.frames]
    return _with_only(a, names), _with_only(b, names)


def _with_only(observation: Observation, names: list[str]) -> Observation:
    known = observation.frames or {}
    return replace(observation, frames={name: known[name] for name in names})
