"""SDFormat by stepbot's own reader."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import displacement
from stepbot.robot.model import Joint, JointKind

from .. import engine_of
from ..observation import EngineCannotRead, Observation, ObservedJoint, Request
from ..sdformat_reader.frames import number_at, numbers, read_pose
from ..sdformat_reader.tree import read_model
from .description import DescribedShape, Description
from .meshes import MeshFiles, corners

if TYPE_CHECKING:
    from lxml.etree import _Element as Element
else:
    Element = object


def describe_sdf(file: str) -> Description:
    """Read an SDFormat file.

    Raises:
        EngineRefused: It violates its format.
        EngineCannotRead: It uses unsupported features.
    """
    observation = engine_of("reader").observer.observe(Request(file, "sdf", configurations=({},), simulate=0.0))
    files = MeshFiles(Path(file))
    shapes = tuple(shape for link in read_model(Path(file)).findall("link") for shape in _shapes(link, files))
    return Description(observation, _at_zero(observation), shapes, files.unread)


def _at_zero(observation: Observation) -> dict[str, Pose]:
    """Poses in the parents at q = 0; mimicking joints are at the positions given by their leaders."""
    if not observation.poses:
        raise EngineCannotRead("the poses of its links are not known")
    poses, joints = observation.poses[0], {joint.name: joint for joint in observation.joints}
    found = {}
    for joint in observation.joints:
        X_PC = poses[joint.parent].inverse() @ poses[joint.child]
        q = _followed(joint, joints)
        if q and joint.axis is not None:
            one = Joint(joint.name, JointKind(joint.kind), joint.parent, joint.child, axis=joint.axis)
            X_PC = X_PC @ displacement(one, q).inverse()
        found[joint.child] = X_PC
    return found


def _followed(joint: ObservedJoint, joints: Mapping[str, ObservedJoint]) -> float:
    """Position of a joint with all independent joints at 0."""
    q, factor, seen = 0.0, 1.0, {joint.name}
    while joint.mimic is not None:
        q, factor = q + factor * joint.mimic.offset, factor * joint.mimic.multiplier
        joint = joints[joint.mimic.joint]
        if joint.name in seen:
            break
        seen.add(joint.name)
    return q


def _shapes(link: Element, files: MeshFiles) -> Iterator[DescribedShape]:
    for shape in link.findall("visual") or link.findall("collision"):
        geometry = shape.find("geometry")
        points = None if geometry is None else _points(geometry, files)
        if points is not None:
            yield DescribedShape(link.get("name", ""), shape.get("name", ""), read_pose(shape).apply(points))


def _points(geometry: Element, files: MeshFiles) -> Array | None:
    for shape in geometry:
        if shape.tag == "mesh":
            vertices = files.vertices((shape.findtext("uri") or "").strip())
            return None if vertices is None else vertices * np.array(numbers(shape.findtext("scale") or "1 1 1"))
        if shape.tag == "box":
            x, y, z = numbers(shape.findtext("size") or "0 0 0")
            return corners((0.5 * x, 0.5 * y, 0.5 * z), Pose())
        if shape.tag in ("cylinder", "sphere", "capsule"):
            radius, length = number_at(shape, "radius", 0.0), number_at(shape, "length", 0.0)
            ends = radius if shape.tag != "cylinder" else 0.0
            return corners((radius, radius, 0.5 * length + ends), Pose())
    return None
