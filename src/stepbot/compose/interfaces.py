"""Parts that both sides of a mount have: an adapter plate that is in the files of the arm and of the hand."""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import link_poses, rigid_bodies
from stepbot.robot.model import JointKind, MeshRef, Robot
from stepbot.sidecar.located import Sidecar

from .parts import Part
from .placing import Mount

_NEAR = 1e-5
"""Distance [m] between the corners of two boxes around one part."""


def report_shared_parts(
    sidecar: Sidecar, robot: Robot, parts: Mapping[str, Part], mounts: Mapping[str, Mount], found: Diagnostics
) -> None:
    """Report SB166: a part of a module that the other side of its mount has, too, at the same place.

    Args:
        mounts: The joint above each root link.
    """
    body, poses = rigid_bodies(robot.root.name, robot.joints), link_poses(robot, {})
    mounted = {
        name: part
        for name, part in parts.items()
        if (mount := mounts.get(part.robot.root.name)) is not None and mount.joint.kind is JointKind.FIXED
    }
    bodies = {body[part.robot.root.name] for part in mounted.values()}
    shown = list(_shown(robot, [link for link, of in body.items() if of in bodies], poses))
    if not shown:
        return
    boxes: Array = np.array([one.box for one in shown])
    for name, part in mounted.items():
        own = part.robot.link_by_name
        there = np.array([one.link not in own and body[one.link] == body[part.robot.root.name] for one in shown])
        for one in (one for one in shown if one.link in own and body[one.link] == body[part.robot.root.name]):
            near = np.flatnonzero(there & (np.abs(boxes - one.box).max(axis=1) < _NEAR))
            if len(near):
                twin = shown[near[0]]
                twins = f"'{one.part}' of link '{one.link}' and '{twin.part}' of link '{twin.link}'"
                message = f"module '{name}': equal parts at the same place: {twins}"
                help = [f"if it is in both files, leave it out of one: `parts: {{'{one.part}': {{ignore: true}}}}`"]
                found.add("SB166", message, sidecar.key_span("modules", name), help=help)


class _Shown(NamedTuple):
    link: str
    part: str
    """Its component, or the name of the visual."""
    box: Array
    """Shape (6,) [m]: the corners of its box in the root's frame."""


def _shown(robot: Robot, links: Iterable[str], poses: Mapping[str, Pose]) -> Iterator[_Shown]:
    """The visual meshes of some links."""
    meshes = {asset.name: asset.mesh for asset in robot.meshes}
    for link in links:
        for visual in robot.link_by_name[link].visuals:
            if isinstance(visual.geometry, MeshRef):
                points = (poses[link] @ visual.X_LG).apply(meshes[visual.geometry.name].vertices)
                box = np.concatenate([points.min(axis=0), points.max(axis=0)])
                yield _Shown(link, visual.component or visual.name, box)
