"""Geometry and materials: native shapes, and meshes that are in a file of their own.

Visuals with a mesh are instances of it. Collisions refer to it without being instances, because physics attributes
cannot be changed inside of one. Their purpose is ``guide``, which renderers do not draw.
"""

from stepbot.geometry.primitives import linear_from_srgb
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, Geometry, MeshRef, Rgba, Robot, Sphere, Visual
from stepbot.robot.surfaces import Surface

from ..lowering.shapes import concave_meshes, upright
from ..xml import number
from .meshes import MESH, MeshLayer
from .usda import Names, Prim, doubles, named, single, singles

MATERIALS = "materials"
"""The scope of the materials."""
_PLACE_DECIMALS, _COLOR_DECIMALS = 12, 9
"""Decimals of positions [m] and quaternions, and of linear colours: the same on all machines."""


class Library:
    """Meshes and materials of a robot, and the prims that refer to them."""

    def __init__(self, robot: Robot, top: str, meshes: MeshLayer) -> None:
        """Lay them out."""
        self._concave = concave_meshes(robot)
        self._meshes = meshes
        self._colors: dict[Rgba, str] = {}
        self._surfaces: dict[Surface, str] = {}
        self._top = top

    def colors(self, top: str) -> list[Prim]:
        """The materials of visuals that are in use.

        Args:
            top: Path of the prim that their scope is in.
        """
        return [_material(f"{top}/{MATERIALS}", *item) for item in self._colors.items()]

    def contacts(self) -> list[Prim]:
        """The materials of collisions that are in use."""
        return [_contact(*item) for item in self._surfaces.items()]

    def visual(self, visual: Visual, names: Names) -> Prim:
        """A visual."""
        if isinstance(visual.geometry, MeshRef):
            prim = named("Xform", visual.name, names)
            prim.metadata += ["instanceable = true", self._meshes.reference(visual.geometry)]
        else:
            prim = _primitive(visual.geometry, visual.name, names)
        prim.schemas.append("MaterialBindingAPI")
        color = self._colors.setdefault(visual.rgba, f"color_{len(self._colors) + 1}")
        prim.set("rel material:binding", f"<{self._top}/{MATERIALS}/{color}>")
        prim.set("color3f[] primvars:displayColor", f"[{_linear(visual.rgba)}]")  # for viewers without materials
        if visual.rgba[3] != 1.0:
            prim.set("float[] primvars:displayOpacity", f"[{single(visual.rgba[3])}]")
        place(prim, upright(visual), scale=_scale(visual.geometry))
        return prim

    def collision(self, collision: Collision, names: Names) -> Prim:
        """A collision."""
        if isinstance(collision.geometry, MeshRef):
            prim = named("Mesh", collision.name, names)
            prim.metadata.append(self._meshes.reference(collision.geometry, MESH))
            prim.schemas += ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "NewtonMeshCollisionAPI"]
            concave = collision.geometry.name in self._concave
            prim.set("uniform token physics:approximation", '"convexDecomposition"' if concave else '"convexHull"')
        else:
            prim = _primitive(collision.geometry, collision.name, names)
            prim.schemas.append("PhysicsCollisionAPI")
        if collision.surface.is_stated:
            contact = self._surfaces.setdefault(collision.surface, f"contact_{len(self._surfaces) + 1}")
            prim.schemas.append("MaterialBindingAPI")
            prim.set("rel material:binding:physics", f"<{self._top}/{MATERIALS}/{contact}>")
        prim.set("uniform token purpose", '"guide"')
        place(prim, upright(collision), scale=_scale(collision.geometry))
        return prim


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


def _material(scope: str, rgba: Rgba, identifier: str) -> Prim:
    """A material with one colour; USD's colours are linear, those of CAD programs are sRGB."""
    shader = Prim("Shader", "surface")
    shader.set("uniform token info:id", '"UsdPreviewSurface"')
    shader.set("color3f inputs:diffuseColor", _linear(rgba))
    shader.set("float inputs:opacity", single(rgba[3]))
    shader.properties.append("token outputs:surface")
    material = Prim("Material", identifier, children=[shader])
    material.set("token outputs:surface.connect", f"<{scope}/{identifier}/surface.outputs:surface>")
    return material


def _contact(surface: Surface, identifier: str) -> Prim:
    material = Prim("Material", identifier)
    material.schemas.append("PhysicsMaterialAPI")
    if surface.friction is not None:
        material.set("float physics:staticFriction", single(surface.friction))
        material.set("float physics:dynamicFriction", single(surface.friction))
    if surface.restitution is not None:
        material.set("float physics:restitution", single(surface.restitution))
    return material


def _linear(rgba: Rgba) -> str:
    """The colour of a material as a linear one."""
    return singles(round(linear_from_srgb(c), _COLOR_DECIMALS) for c in rgba[:3])
