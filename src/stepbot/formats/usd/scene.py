"""A scene around the robot's file, which it refers to: gravity, a floor and light."""

from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.model import Robot
from stepbot.robot.standing import floor_height

from .names import Names
from .usda import Prim, asset_path, layer, single, singles

_SUN, _SKY = 2000.0, 300.0
"""Intensities of the lights [nit]: a sunny workshop."""


def scene(robot: Robot, main: str) -> bytes:
    """The scene for a robot in the file ``main``, in the same folder."""
    world = Prim("Xform", "World", metadata=['kind = "assembly"'])  # the robot is a component, a model of its own
    physics = world.add(Prim("PhysicsScene", "physics"))
    physics.set("vector3f physics:gravityDirection", "(0, 0, -1)")
    physics.set("float physics:gravityMagnitude", single(-GRAVITY[2]))
    world.add(_floor(floor_height(robot)))
    sun = world.add(Prim("DistantLight", "sun"))
    sun.set("float inputs:intensity", single(_SUN))
    sky = world.add(Prim("DomeLight", "sky"))
    sky.set("float inputs:intensity", single(_SKY))
    names = Names(child.name for child in world.children)
    world.add(Prim("", names.of(robot.name), metadata=[f"prepend references = {asset_path(f'./{main}')}"]))
    return layer(world)


def _floor(height: float) -> Prim:
    floor = Prim("Plane", "floor", schemas=["PhysicsCollisionAPI"])
    floor.set("uniform token axis", '"Z"')
    floor.set("double length", "100")
    floor.set("double width", "100")
    floor.set("float3[] extent", f"[{singles((-50.0, -50.0, 0.0))}, {singles((50.0, 50.0, 0.0))}]")
    if height:
        floor.set("double3 xformOp:translate", f"(0, 0, {height!r})")
        floor.set("uniform token[] xformOpOrder", '["xformOp:translate"]')
    return floor
