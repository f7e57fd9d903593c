"""Visuals and collisions as shapes of Webots; cylinders and capsules are along z."""

from collections.abc import Sequence

from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Box, Capsule, Collision, Cylinder, MeshRef, Robot, Sphere, Visual
from stepbot.robot.surfaces import Surface

from ..lowering.shapes import upright
from ..xml import number
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


def contact_materials(robot: Robot) -> dict[Surface, str]:
    """The names of the contact properties of a lowered robot, of which a link has one."""
    stated = dict.fromkeys(shape.surface for link in robot.links for shape in link.collisions[:1])
    surfaces = [surface for surface in stated if surface.is_stated]
    return {surface: f"{robot.name} {i}" for i, surface in enumerate(surfaces, start=1)}


def contact_properties(robot: Robot) -> list[Node]:
    """The contact properties of a robot, against what has none."""
    nodes = []
    for surface, name in contact_materials(robot).items():
        node = Node("ContactProperties").set("material1", text(name))
        if surface.friction is not None:
            node.set("coulombFriction", f"[ {number(surface.friction)} ]")
        if surface.restitution is not None:
            node.set("bounce", surface.restitution)
        if surface.rolling is not None or surface.torsional is not None:
            rolling = surface.rolling or 0.0
            node.set("rollingFriction", (rolling, rolling, surface.torsional or 0.0))
        nodes.append(node)
    return nodes


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
