"""What both sides of a mount have: one part twice, such as an adapter plate in both files, or one space."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from stepbot.diagnostics import Diagnostics, cut
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.solids.box_pairs import box_pairs
from stepbot.geometry.solids.manifolds import TOUCHING
from stepbot.geometry.solids.overlapping import Candidate, Group, Overlaps, Search
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.bounding_boxes import mesh_bounds, primitive_bounds
from stepbot.robot.kinematics import link_poses, rigid_bodies
from stepbot.robot.model import Geometry, MeshRef, Robot
from stepbot.sidecar.located import Sidecar

_NEAR = 1e-5
"""Distance [m] between the corners of two boxes around one part."""
_MAX_FACES = 200_000
"""Maximum number of faces to intersect: some tenths of a second."""
_MOST_NOTES = 4

Intersect = Callable[[Search], Mapping[str, Overlaps]]
"""Intersects solids; the result is by module."""


def report_interfaces(sidecar: Sidecar, robot: Robot, intersect: Intersect, diagnostics: Diagnostics) -> None:
    """Report SB166: a part of a module that what it is fixed to has, too, at the same place, or solids that overlap.

    Compared are the visuals of links that are one body; a mesh that is no solid overlaps nothing.
    """
    body, poses = rigid_bodies(robot.root.name, robot.joints), link_poses(robot, {})
    modules = {link: one.name for one in robot.modules if "/" not in one.name for link in one.links}
    inside: dict[str, set[str]] = {}
    for link, of in body.items():
        inside.setdefault(of, set()).add(modules.get(link, ""))
    shown = list(_shown(robot, [one.name for one in robot.links if len(inside[body[one.name]]) > 1], poses))
    if not shown:
        return
    low, high = (np.array([one.box[side] for one in shown]) for side in (0, 1))
    order = {"": -1} | {name: at for at, name in enumerate(sidecar.document.modules)}
    twins: dict[str, tuple[_Shown, _Shown]] = {}
    meeting = list[tuple[str, int, int]]()
    for i, j in zip(*(side.tolist() for side in box_pairs(low, high, TOUCHING)), strict=True):
        if body[shown[i].link] != body[shown[j].link]:
            continue
        sides = ((modules.get(shown[k].link, ""), k) for k in (i, j))
        (base, j), (module, i) = sorted(sides, key=lambda side: order[side[0]])
        if base == module:
            continue
        a, b = shown[i], shown[j]
        if type(a.geometry) is type(b.geometry) and np.abs(a.box - b.box).max() < _NEAR:
            twins.setdefault(module, (a, b))
        elif isinstance(a.geometry, MeshRef) and isinstance(b.geometry, MeshRef):
            meeting.append((module, i, j))
    for module, (mine, other) in twins.items():
        message = f"module '{module}': equal parts at the same place: {mine} and {other}"
        out = f": `parts: {{'{mine.part}': {{ignore: true}}}}`" if mine.is_component else ""
        help = [f"if it is in both files, leave it out of one{out}"]
        diagnostics.add("SB166:part", message, sidecar.key_span("modules", module), help=help)
    for module, overlaps in intersect(_search(robot, shown, meeting)).items() if meeting else ():
        lines = [
            f"{shown[pair.first]} and {shown[pair.second]} share {1e6 * pair.volume:.3g} cm^3"
            for pair in overlaps.pairs
        ]
        if lines and module not in twins:
            message = f"module '{module}': solids overlap where it is fixed: {lines[0]}"
            help = ["move it by its `offset`, or place it by another port; `without` leaves out what makes room"]
            notes = cut(lines[1:], _MOST_NOTES)
            diagnostics.add("SB166:overlap", message, sidecar.key_span("modules", module), help=help, notes=notes)


class _Shown(NamedTuple):
    link: str
    part: str
    """Its component, or the name of the visual."""
    is_component: bool
    geometry: Geometry
    X_RG: Pose
    """Its pose in the root's frame."""
    box: Array
    """Shape (2, 3) [m]: the corners of its box in the root's frame."""

    def __str__(self) -> str:
        return f"'{self.part}' of link '{self.link}'"


def _shown(robot: Robot, links: Iterable[str], poses: Mapping[str, Pose]) -> Iterator[_Shown]:
    """The visuals of some links."""
    for link in links:
        for visual in robot.link_by_name[link].visuals:
            X_RG, geometry = poses[link] @ visual.X_LG, visual.geometry
            if isinstance(geometry, MeshRef):
                box = mesh_bounds(robot.mesh_by_name[geometry.name].mesh.vertices, X_RG)
            else:
                box = primitive_bounds(geometry, X_RG)
            yield _Shown(link, visual.component or visual.name, bool(visual.component), geometry, X_RG, np.array(box))


def _search(robot: Robot, shown: list[_Shown], meeting: list[tuple[str, int, int]]) -> Search:
    """The solids to intersect, of pairs whose boxes overlap."""
    number = {asset.name: index for index, asset in enumerate(robot.meshes)}
    groups, meshes = list[Group](), dict[int, TriMesh]()
    for module, i, j in meeting:
        bodies = tuple(number[one.geometry.name] for one in (shown[i], shown[j]) if isinstance(one.geometry, MeshRef))
        meshes |= {body: robot.meshes[body].mesh for body in bodies}
        smaller = min(abs(meshes[body].signed_volume) for body in bodies)
        common = np.minimum(shown[i].box[1], shown[j].box[1]) - np.maximum(shown[i].box[0], shown[j].box[0])
        pair = Candidate(module, i, j, 1.0, float(common.prod()))
        groups.append(Group((bodies[0], bodies[1]), shown[i].X_RG.inverse() @ shown[j].X_RG, smaller, (pair,)))
    modules = tuple(dict.fromkeys(module for module, _, _ in meeting))
    return Search(modules, tuple(groups), meshes, {i: shown[i].X_RG for _, i, _ in meeting}, _MAX_FACES)
