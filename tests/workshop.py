"""Links of boxes and rods for robots in memory: real meshes, mass properties in closed form."""

import math
from collections.abc import Iterable

import numpy as np

from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import Collision, Link, MeshAsset, MeshRef, Rgba, Visual

DENSITY = 2700.0
"""Density [kg/m^3] of all parts: aluminium."""

STEEL: Rgba = (0.6, 0.62, 0.65, 1.0)
ORANGE: Rgba = (0.9, 1 / 3, 0.05, 1.0)
GLASS: Rgba = (0.1, 0.4, 0.8, 0.25)


def _box_mesh(size: tuple[float, float, float], X_LG: Pose) -> TriMesh:
    import trimesh

    box = trimesh.creation.box(extents=size)
    return TriMesh.of(X_LG.apply(box.vertices), box.faces)


def _rod_mesh(radius: float, length: float, X_LG: Pose) -> TriMesh:
    import trimesh

    rod = trimesh.creation.cylinder(radius=radius, height=length, sections=24)
    return TriMesh.of(X_LG.apply(rod.vertices), rod.faces)


def box_mass(size: tuple[float, float, float], X_LG: Pose = IDENTITY) -> MassProperties:
    """Closed form of a homogeneous box centred at the origin of G."""
    x, y, z = size
    mass = DENSITY * x * y * z
    inertia = np.diag([y * y + z * z, x * x + z * z, x * x + y * y]) * mass / 12
    return MassProperties.of(mass, (0, 0, 0), inertia).moved(X_LG)


def rod_mass(radius: float, length: float, X_LG: Pose = IDENTITY) -> MassProperties:
    """Closed form of a homogeneous cylinder along z of G, centred at the origin."""
    mass = DENSITY * math.pi * radius**2 * length
    across = (3 * radius**2 + length**2) / 12
    return MassProperties.of(mass, (0, 0, 0), np.diag([across, across, radius**2 / 2]) * mass).moved(X_LG)


class Workshop:
    """Collects the mesh assets of the links that it makes."""

    def __init__(self) -> None:
        self.meshes: list[MeshAsset] = []

    def link(
        self,
        name: str,
        boxes: Iterable[tuple[tuple[float, float, float], Pose]] = (),
        rods: Iterable[tuple[float, float, Pose]] = (),
        rgba: Rgba = STEEL,
    ) -> Link:
        """A link of boxes (size [m], pose) and rods (radius [m], length [m], pose), each with its own mesh."""
        solids = [(_box_mesh(size, X_LG), box_mass(size, X_LG)) for size, X_LG in boxes]
        solids += [(_rod_mesh(radius, length, X_LG), rod_mass(radius, length, X_LG)) for radius, length, X_LG in rods]
        visuals, collisions = [], []
        for number, (mesh, _) in enumerate(solids, start=1):
            asset = MeshAsset(f"{name}_{number}", mesh)
            self.meshes.append(asset)
            visuals.append(Visual(f"{name}_visual_{number}", MeshRef(asset.name), rgba=rgba))
            collisions.append(Collision(f"{name}_collision_{number}", MeshRef(asset.name)))
        return Link(name, combined(mass for _, mass in solids), tuple(visuals), tuple(collisions))

    def sorted_meshes(self) -> tuple[MeshAsset, ...]:
        """The assets of all links made so far, by name."""
        return tuple(sorted(self.meshes, key=lambda asset: asset.name))


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, rpy: tuple[float, float, float] = (0, 0, 0)) -> Pose:
    """Pose from a position [m] and fixed-axis roll, pitch, yaw [rad]."""
    return Pose.from_xyz_rpy((x, y, z), rpy)
