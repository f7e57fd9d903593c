"""Geometry and materials: native shapes, and meshes that are in the file once each.

Visuals with a mesh are instances of it. Collisions refer to it without being instances, because physics attributes
cannot be changed inside of one. Their purpose is ``guide``, which renderers do not draw.
"""

import numpy as np

from stepbot.geometry.colors import linear_from_srgb
from stepbot.geometry.fixed_point import fixed_point_lines
from stepbot.geometry.mesh import GRID_DECIMALS, GRID_PER_METRE
from stepbot.geometry.mesh_bytes import unit_normals
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from stepbot.robot.model import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Geometry,
    MeshAsset,
    MeshRef,
    Rgba,
    Robot,
    Sphere,
    Visual,
)

from ..lowering.shapes import concave_meshes, upright
from ..xml import number
from .names import Names, named
from .usda import Prim, doubles, single, singles

MESH = "mesh"
"""Name of the mesh in the prim of an asset."""
_PLACE_DECIMALS, _COLOR_DECIMALS, _NORMAL_DECIMALS = 12, 9, 6
"""Decimals of positions [m] and quaternions, of linear colours, and of normals: the same on all machines."""


class Library:
    """Meshes and materials of a robot, and the prims that refer to them."""

    def __init__(self, robot: Robot, top: str) -> None:
        """Lay them out.

        Args:
            robot: The robot.
            top: Path of its prim.
        """
        self._concave = concave_meshes(robot)
        names = Names()
        self._meshes = {asset.name: names.of(asset.name) for asset in robot.meshes}
        self._assets = robot.mesh_by_name
        self._colors: dict[Rgba, str] = {}
        self._used: set[str] = set()
        self._top = top

    def prims(self) -> list[Prim]:
        """The meshes and materials that are in use."""
        meshes = Prim("Scope", "meshes", specifier="class")
        meshes.children = [
            _asset(self._assets[name], identifier) for name, identifier in self._meshes.items() if name in self._used
        ]
        materials = Prim("Scope", "materials")
        materials.children = [_material(f"{self._top}/materials", *one) for one in self._colors.items()]
        return [scope for scope in (meshes, materials) if scope.children]

    def visual(self, visual: Visual, names: Names) -> Prim:
        """A visual."""
        if isinstance(visual.geometry, MeshRef):
            prim = named("Xform", visual.name, names)
            prim.metadata += ["instanceable = true", f"prepend references = <{self._mesh(visual.geometry)}>"]
        else:
            prim = _primitive(visual.geometry, visual.name, names)
        prim.schemas.append("MaterialBindingAPI")
        color = self._colors.setdefault(visual.rgba, f"color_{len(self._colors) + 1}")
        prim.set("rel material:binding", f"<{self._top}/materials/{color}>")
        place(prim, upright(visual), scale=_scale(visual.geometry))
        return prim

    def collision(self, collision: Collision, names: Names) -> Prim:
        """A collision."""
        if isinstance(collision.geometry, MeshRef):
            prim = named("Mesh", collision.name, names)
            prim.metadata.append(f"prepend references = <{self._mesh(collision.geometry)}/{MESH}>")
            prim.schemas += ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "NewtonMeshCollisionAPI"]
            concave = collision.geometry.name in self._concave
            prim.set("uniform token physics:approximation", '"convexDecomposition"' if concave else '"convexHull"')
        else:
            prim = _primitive(collision.geometry, collision.name, names)
            prim.schemas.append("PhysicsCollisionAPI")
        prim.set("uniform token purpose", '"guide"')
        place(prim, upright(collision), scale=_scale(collision.geometry))
        return prim

    def _mesh(self, mesh: MeshRef) -> str:
        self._used.add(mesh.name)
        return f"{self._top}/meshes/{self._meshes[mesh.name]}"


def place(prim: Prim, X: Pose, *, scale: str = "") -> None:
    """The pose of a prim in its parent, and its scale."""
    operations = []
    if X.position != IDENTITY.position:
        prim.set("double3 xformOp:translate", doubles(round(x, _PLACE_DECIMALS) for x in X.position))
        operations.append('"xformOp:translate"')
    if X.rotation != IDENTITY.rotation:
        prim.set("quatd xformOp:orient", doubles(round(q, _PLACE_DECIMALS) for q in X.quaternion))
        operations.append('"xformOp:orient"')
    if scale:
        prim.set("double3 xformOp:scale", scale)
        operations.append('"xformOp:scale"')
    if operations:
        prim.set("uniform token[] xformOpOrder", f"[{', '.join(operations)}]")


def _scale(geometry: Geometry) -> str:
    """A cube has one size; the others come from its scale."""
    return doubles(geometry.size) if isinstance(geometry, Box) else ""


def _primitive(geometry: Geometry, name: str, names: Names) -> Prim:
    match geometry:
        case Box():
            prim = named("Cube", name, names)
            prim.set("double size", "1")
            half = (0.5, 0.5, 0.5)
        case Sphere(radius):
            prim = named("Sphere", name, names)
            prim.set("double radius", number(radius))
            half = (radius, radius, radius)
        case Cylinder(radius, length) | Capsule(radius, length):
            capsule = isinstance(geometry, Capsule)
            prim = named("Capsule" if capsule else "Cylinder", name, names)
            prim.set("uniform token axis", '"Z"')
            prim.set("double height", number(length))
            prim.set("double radius", number(radius))
            half = (radius, radius, 0.5 * length + (radius if capsule else 0.0))
        case MeshRef():
            raise TypeError("a mesh is not a primitive")
    prim.set("float3[] extent", f"[{singles(-x for x in half)}, {singles(half)}]")
    return prim


def _asset(asset: MeshAsset, identifier: str) -> Prim:
    """A mesh, to be referred to: triangles with flat faces, on the grid of the mesh files."""
    mesh = asset.mesh
    prim = Prim("Mesh", MESH)
    nanometres = np.rint(mesh.vertices * GRID_PER_METRE).astype(np.int64)
    low, high = (nanometres.min(axis=0), nanometres.max(axis=0)) if len(nanometres) else (np.zeros(3), np.zeros(3))
    corners = ((corner / GRID_PER_METRE).tolist() for corner in (low, high))
    prim.set("float3[] extent", f"[{', '.join(map(singles, corners))}]")
    prim.set("int[] faceVertexCounts", f"[{', '.join(['3'] * len(mesh.faces))}]")
    prim.set("int[] faceVertexIndices", f"[{', '.join(map(str, mesh.faces.ravel().tolist()))}]")
    prim.set("normal3f[] normals", _triples(np.rint(unit_normals(mesh) * 10**_NORMAL_DECIMALS), _NORMAL_DECIMALS))
    prim.properties[-1] += ' (interpolation = "uniform")'
    prim.set("point3f[] points", _triples(nanometres.astype(np.float64), GRID_DECIMALS))
    prim.set("uniform token subdivisionScheme", '"none"')
    return Prim("Xform", identifier, children=[prim])


def _triples(rows: Array, decimals: int) -> str:
    """An array of triples, from integers (n, 3) in units of the last decimal."""
    lines = fixed_point_lines("", rows.astype(np.int64), decimals).decode().splitlines()
    return "[" + ", ".join(f"({', '.join(line.split())})" for line in lines) + "]"


def _material(scope: str, rgba: Rgba, identifier: str) -> Prim:
    """A material with one colour; USD's colours are linear, those of CAD programs are sRGB."""
    shader = Prim("Shader", "surface")
    shader.set("uniform token info:id", '"UsdPreviewSurface"')
    shader.set("color3f inputs:diffuseColor", singles(round(linear_from_srgb(c), _COLOR_DECIMALS) for c in rgba[:3]))
    shader.set("float inputs:opacity", single(rgba[3]))
    shader.properties.append("token outputs:surface")
    material = Prim("Material", identifier, children=[shader])
    material.set("token outputs:surface.connect", f"<{scope}/{identifier}/surface.outputs:surface>")
    return material
