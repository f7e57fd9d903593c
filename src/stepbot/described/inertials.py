"""Checks the mass properties of a description against the geometry of its links, as those given in a sidecar are."""

from collections.abc import Mapping

import numpy as np

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from stepbot.robot.bounding_boxes import primitive_bounds
from stepbot.robot.inertial_doubts import inertial_doubts
from stepbot.robot.model import Collision, JointKind, Link, MeshRef, Robot, Visual

_REMEDIES = {
    "SB518:large-inertia": "check that the inertia is about the com, along the axes of its origin, in kg m^2",
    "SB518:com": "check the origin of the inertial, which is in the frame of the link",
    "SB518:small-inertia": "check the unit: 1 kg mm^2 is 1e-6 kg m^2",
}


def check_inertials(robot: Robot, found: Diagnostics, span: Span) -> None:
    """Warn of a com or an inertia that no mass within the geometry of its rigid body has (SB518).

    Links that are fixed to each other are one body: descriptions often draw on one link what they weigh on another.
    """
    X_BL: dict[str, tuple[str, Pose]] = {robot.root.name: (robot.root.name, IDENTITY)}
    for joint in robot.joints:
        body, X_BP = X_BL[joint.parent]
        fixed = joint.kind is JointKind.FIXED
        X_BL[joint.child] = (body, X_BP @ joint.X_PC) if fixed else (joint.child, IDENTITY)
    points: dict[str, list[Array]] = {}
    for link in robot.links:
        body, X = X_BL[link.name]
        points.setdefault(body, []).append(_points(link, robot, X))
    known: Mapping[str, Array] = {body: np.concatenate(parts) for body, parts in points.items()}
    for link in robot.links:
        body, X = X_BL[link.name]
        if link.mass_properties.mass > 0.0:
            for doubt in inertial_doubts(link.mass_properties, X.inverse().apply(known[body])):
                found.add(doubt.code, f"link '{link.name}': {doubt.message}", span, help=(_REMEDIES[doubt.code],))


def _points(link: Link, robot: Robot, X_BL: Pose) -> Array:
    """Points (n, 3) [m] around the shapes of a link, in the frame of its body."""
    found = [np.zeros((0, 3))]
    shapes: tuple[Visual | Collision, ...] = (*link.visuals, *link.collisions)
    for shape in shapes:
        X_BG = X_BL @ shape.X_LG
        if isinstance(shape.geometry, MeshRef):
            found.append(X_BG.apply(robot.mesh_by_name[shape.geometry.name].mesh.vertices))
        else:
            low, high = primitive_bounds(shape.geometry, IDENTITY)
            corners = [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
            found.append(X_BG.apply(np.array(corners)))
    return np.concatenate(found)
