"""Mass properties assumed from geometry and a density, where the user asks for them.

Links whose stated inertia is impossible keep their mass and centre of mass. Links of a rigid body in which nothing has
mass get the mass of their collisions, or else of their visuals; a mesh that is not closed counts as its convex hull.
Without being asked, an impossible inertia of a slight link moves to what it is fixed to, which keeps the motion.
"""

from collections.abc import Mapping, Sequence
from math import pi

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.observation import Quantity
from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import Primitive
from stepbot.geometry.spatial import IDENTITY, ZERO33, Array, Pose, box_corners, dot, turn_inertia
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.bounding_boxes import primitive_bounds
from stepbot.robot.inertial_doubts import inertial_doubts
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import Base, Collision, JointKind, Link, MeshRef, Robot, Visual
from stepbot.robot.validity import inertia_fault

from .finding import ASSUMED, CHANGED_INERTIA, Finding

_DIFFERS = (
    *(Quantity.MASS, Quantity.COM, Quantity.INERTIA),
    *(Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS),
)
_LEAST = 1e-6
"""Volume [m^3] of a link without geometry: a cubic centimetre."""
_MOST = 1e60
"""Volume [m^3] from which moments of inertia may overflow: sizes that are reported (SB414, SB420)."""
_SLIGHT = 0.01
"""Share of mass and inertia of what a link is fixed to, up to which an impossible inertia is that of a mere frame."""
_MOST_UNEVEN = 1e-6
"""Least ratio of principal moments: that of a flatter shape is of rounding errors."""
Shapes = Sequence[tuple[TriMesh | Primitive, Pose]]


def lacking(robot: Robot) -> dict[str, Shapes]:
    """The links that need assumed mass properties, and the shapes to compute them from, in the frame of the link."""
    bodies = rigid_bodies(robot.root.name, robot.joints)
    heavy = {bodies[link.name] for link in robot.links if link.mass_properties.mass > 0.0}
    assumed: dict[str, Shapes] = {}
    for link in robot.links:
        shapes: Sequence[Collision | Visual] = link.collisions or link.visuals
        light = bodies[link.name] not in heavy and (shapes or link.mass_properties.mass < 0.0)
        if light or inertia_fault(link.mass_properties):
            assumed[link.name] = [(_geometry(shape, robot), shape.X_LG) for shape in shapes]
    return assumed | {name: [] for name in _bare(robot, bodies, heavy, assumed)}


def _bare(robot: Robot, bodies: Mapping[str, str], heavy: set[str], shapes: Mapping[str, Shapes]) -> list[str]:
    """Moving links that have neither mass nor geometry, and carry none."""
    weighed = heavy | {bodies[name] for name in shapes}
    above = {joint.child: bodies[joint.parent] for joint in robot.joints}
    carrying = set(weighed)
    for body in reversed(list(dict.fromkeys(bodies.values()))):
        if body in carrying and body in above:
            carrying.add(above[body])
    root, floats = robot.root.name, robot.base is Base.FLOATING
    light = [body for body in dict.fromkeys(bodies.values()) if body not in weighed]
    return [body for body in light if (floats if body == root else body not in carrying)]


def _geometry(shape: Collision | Visual, robot: Robot) -> TriMesh | Primitive:
    if isinstance(shape.geometry, MeshRef):
        return robot.mesh_by_name[shape.geometry.name].mesh
    return shape.geometry


def solids_of(links: Mapping[str, Shapes]) -> dict[str, MassProperties]:
    """Mass properties of each link at 1 kg/m^3; without mass where its shapes have no volume. For a worker process."""
    return {
        name: combined([_solid(geometry).moved(X_LG) for geometry, X_LG in shapes]) for name, shapes in links.items()
    }


def _solid(geometry: TriMesh | Primitive) -> MassProperties:
    """Mass properties of a solid, or of the hull of an open mesh, at 1 kg/m^3."""
    from stepbot.geometry.solids.manifolds import mesh_arrays, of_same_volume

    solid = of_same_volume(geometry)
    if not 0.0 < solid.volume() < _MOST:
        return MassProperties()
    vertices, faces = mesh_arrays(solid)
    return _integrated(vertices, faces)


def _integrated(vertices: Array, faces: NDArray[np.int64]) -> MassProperties:
    """Mass properties at 1 kg/m^3 of a closed surface, as the sum of tetrahedra from its centre (n,)."""
    center = vertices.mean(axis=0)
    a, b, c = (vertices[faces[:, i]] - center for i in range(3))
    volumes = dot(a, np.cross(b, c)) / 6.0
    volume = float(volumes.sum())
    total = a + b + c
    com = (volumes[:, None] * total).sum(axis=0) / (4.0 * volume)
    products = sum((p[:, :, None] * p[:, None, :] for p in (a, b, c, total)), np.zeros((len(faces), 3, 3)))
    second = (volumes[:, None, None] * products).sum(axis=0) / 20.0 - volume * com[:, None] * com[None, :]
    inertia = np.trace(second) * np.eye(3) - second
    return VolumeProperties.rounded(volume, com + center, inertia).unit_density


def with_assumed(robot: Robot, solids: Mapping[str, MassProperties], density: float, findings: list[Finding]) -> Robot:
    """The robot with assumed mass properties; each is listed.

    Args:
        solids: For each link that lacks them, those of its geometry at 1 kg/m^3 (:func:`solids_of`).
        density: [kg/m^3].
    """
    links = tuple(
        _assumed(link, solids[link.name], density, findings) if link.name in solids else link for link in robot.links
    )
    return replace(robot, links=links)


def _assumed(link: Link, solid: MassProperties, density: float, findings: list[Finding]) -> Link:
    given = link.mass_properties
    has_shape = solid.mass > 0.0 and _is_even(solid)
    what = "its geometry" if has_shape else "a ball, without geometry,"
    at = f"at {density:g} kg/m^3"
    if given.mass > 0.0:
        made = solid if has_shape else _ball(given.mass / density)
        made = replace(made.scaled(given.mass / made.mass), mass=given.mass, com=given.com)
        text = f"inertia assumed to be that of {what} {at}; mass and com are those of the file"
    else:
        made = (solid if has_shape else _ball(_LEAST)).scaled(density)
        text = f"{made.mass:.4g} kg, com and inertia assumed to be those of {what} {at}"
    findings.append(Finding(ASSUMED, f"link '{link.name}': {text}", _DIFFERS))
    return replace(link, mass_properties=made)


def _is_even(solid: MassProperties) -> bool:
    """Whether a computed inertia is one of a body, and not of rounding errors."""
    moments = np.linalg.eigvalsh(np.array(solid.inertia))
    return bool(moments[0] > _MOST_UNEVEN * moments[2]) and not inertia_fault(solid)


def _ball(volume: float) -> MassProperties:
    """A ball of a volume [m^3] at 1 kg/m^3, around the origin."""
    radius = (3.0 * volume / (4.0 * pi)) ** (1.0 / 3.0)
    return MassProperties.of(volume, (0.0, 0.0, 0.0), 0.4 * volume * radius**2 * np.eye(3))


_REMEDIES = {
    "SB518:large-inertia": "check that the inertia is about the com, along the axes of its origin, in kg m^2",
    "SB518:com": "check the origin of the inertial, which is in the frame of the link",
    "SB518:small-inertia": "check the unit: 1 kg mm^2 is 1e-6 kg m^2",
}


def lumped(robot: Robot, findings: list[Finding]) -> Robot:
    """The robot with impossible inertias of slight links on the heaviest of the links that they are fixed to.

    Many files have a root link for programs that need a mass there, of 1e-6 kg, with an inertia of ones or zeros. Links
    that are fixed to each other are one body, whose mass properties remain.
    """
    X_BL = _in_bodies(robot)
    properties = {link.name: link.mass_properties for link in robot.links}
    faults = {name: fault for name, one in properties.items() if np.any(one.inertia) and (fault := inertia_fault(one))}
    for name, fault in faults.items():
        body, X = X_BL[name]
        given = properties[name]
        beside = [one for one in properties if X_BL[one][0] == body and not inertia_fault(properties[one])]
        heaviest = max(beside, key=lambda one: properties[one].mass, default=name)
        onto = properties[heaviest]
        moved = turn_inertia(X_BL[heaviest][1].R.T @ X.R, np.array(given.inertia))
        sum_of_both = MassProperties.of(onto.mass, onto.com, np.array(onto.inertia) + moved)
        is_slight = np.abs(moved).max() <= _SLIGHT * np.abs(onto.inertia).max()
        if not (0.0 < given.mass <= _SLIGHT * onto.mass and is_slight) or inertia_fault(sum_of_both):
            continue
        properties |= {name: replace(given, inertia=ZERO33), heaviest: sum_of_both}
        text = f"link '{name}': {fault}: added to that of '{heaviest}', which it is fixed to"
        findings.append(Finding(CHANGED_INERTIA, text, (Quantity.INERTIA,)))
    links = tuple(replace(link, mass_properties=properties[link.name]) for link in robot.links)
    return replace(robot, links=links)


def _in_bodies(robot: Robot) -> dict[str, tuple[str, Pose]]:
    """For each link the topmost of those that it is fixed to, and its pose in that one."""
    X_BL: dict[str, tuple[str, Pose]] = {robot.root.name: (robot.root.name, IDENTITY)}
    for joint in robot.joints:
        body, X_BP = X_BL[joint.parent]
        fixed = joint.kind is JointKind.FIXED
        X_BL[joint.child] = (body, X_BP @ joint.X_PC) if fixed else (joint.child, IDENTITY)
    return X_BL


def check_inertials(robot: Robot, diagnostics: Diagnostics, span: Span) -> None:
    """Warn of a com or an inertia that no mass within the geometry of its rigid body has (SB518).

    Links that are fixed to each other are one body: descriptions often draw on one link what they weigh on another.
    """
    X_BL = _in_bodies(robot)
    points: dict[str, list[Array]] = {}
    for link in robot.links:
        body, X = X_BL[link.name]
        points.setdefault(body, []).append(_points(link, robot, X))
    known: Mapping[str, Array] = {body: np.concatenate(parts) for body, parts in points.items()}
    for link in robot.links:
        body, X = X_BL[link.name]
        if link.mass_properties.mass > 0.0:
            for doubt in inertial_doubts(link.mass_properties, X.inverse().apply(known[body])):
                diagnostics.add(doubt.code, f"link '{link.name}': {doubt.message}", span, help=(_REMEDIES[doubt.code],))


def _points(link: Link, robot: Robot, X_BL: Pose) -> Array:
    """Points (n, 3) [m] around the shapes of a link, in the frame of its body."""
    points = [np.zeros((0, 3))]
    shapes: tuple[Visual | Collision, ...] = (*link.visuals, *link.collisions)
    for shape in shapes:
        X_BG = X_BL @ shape.X_LG
        if isinstance(shape.geometry, MeshRef):
            points.append(X_BG.apply(robot.mesh_by_name[shape.geometry.name].mesh.vertices))
        else:
            points.append(X_BG.apply(box_corners(*primitive_bounds(shape.geometry, IDENTITY))))
    return np.concatenate(points)
