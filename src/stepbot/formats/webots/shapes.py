"""Visuals and collisions as shapes of Webots; cylinders and capsules are along z."""

from collections.abc import Sequence

from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, MeshRef, Sphere, Visual

from ..lowering.shapes import upright
from .vrml import Node, text


def visual_node(visual: Visual, files: MeshFiles) -> Node:
    """A visual in its link."""
    red, green, blue, alpha = visual.rgba
    appearance = Node("PBRAppearance").set("baseColor", (red, green, blue)).set("roughness", 0.5).set("metalness", 0.0)
    if alpha < 1.0:
        appearance.set("transparency", 1.0 - alpha)
    shape = Node("Shape").set("appearance", appearance).set("geometry", _geometry(visual, files))
    return _placed(visual, shape)


def bounding_object(collisions: Sequence[Collision], files: MeshFiles) -> Node:
    """All collisions of a link."""
    nodes = [_placed(shape, _geometry(shape, files)) for shape in collisions]
    return nodes[0] if len(nodes) == 1 else Node("Group").set("children", nodes)


def _placed(shape: Visual | Collision, node: Node) -> Node:
    return Node("Pose").place(upright(shape)).set("children", [node])


def _geometry(shape: Visual | Collision, files: MeshFiles) -> Node:
    match shape.geometry:
        case Box(size):
            return Node("Box").set("size", size)
        case Cylinder(radius, length):
            return Node("Cylinder").set("radius", radius).set("height", length)
        case Capsule(radius, length):
            return Node("Capsule").set("radius", radius).set("height", length)
        case Sphere(radius):
            return Node("Sphere").set("radius", radius)
        case MeshRef():
            return Node("Mesh").set("url", f"[ {text(files.of(shape).path)} ]")
