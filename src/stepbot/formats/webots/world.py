"""A world around the robot's PROTO: time step, floor, light and sky, of nodes that are part of Webots."""

from stepbot.robot.model import Robot
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.standing import extent, floor_height

from .names import proto_name
from .shapes import contact_properties
from .vrml import Node, text

_FLOOR = 20.0
"""Edge [m] of the floor."""


def world(robot: Robot, header: str) -> bytes:
    """The world for a robot whose PROTO is in the same folder."""
    name = proto_name(robot.name)
    (x, y, z), size = extent(robot)
    grey = Node("PBRAppearance").set("baseColor", (0.6, 0.6, 0.6)).set("roughness", 1.0).set("metalness", 0.0)
    floor = Node("Solid").set("translation", (0.0, 0.0, floor_height(robot))).set("name", text("floor"))
    plane = Node("Plane").set("size", (_FLOOR, _FLOOR))
    floor.set("children", [Node("Shape").set("appearance", grey).set("geometry", plane)])
    floor.set("boundingObject", Node("Plane").set("size", (_FLOOR, _FLOOR)))
    view = (round(x - 3.0 * size, 3), round(y, 3), round(z + size, 3))
    info = Node("WorldInfo").set("basicTimeStep", 1000.0 * settings_of(robot).timestep)
    if contacts := contact_properties(robot):
        info.set("contactProperties", contacts)
    nodes = [
        info,
        Node("Viewpoint").set("orientation", (0.0, 1.0, 0.0, 0.3)).set("position", view),
        Node("Background").set("skyColor", "[ 0.7 0.8 0.9 ]"),
        Node("DirectionalLight")
        .set("ambientIntensity", 1.0)
        .set("direction", (0.5, 0.1, -0.9))
        .set("castShadows", "TRUE"),
        floor,
        Node(name),
    ]
    lines = [header, f"EXTERNPROTO {text(f'{name}.proto')}"]
    for node in nodes:
        lines += [f"{node.type} {{", *node.lines()]
    return ("\n".join(lines) + "\n").encode()
