"""A world around the robot's SDFormat: physics, floor, light, sky, and the systems of Gazebo that its sensors need.

The model is written into the world and not included, because programs search for included files in different folders.
"""

from stepbot.robot.bounding_boxes import extent, floor_height
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Robot
from stepbot.robot.sensors import SensorKind
from stepbot.robot.simulation_settings import settings_of

from ..xml import Element, element

_FLOOR_SIZE = 20.0
"""Edge [m] of the floor as drawn; as a collision shape it has no edge."""
_SYSTEMS = (
    ("gz-sim-physics-system", "gz::sim::systems::Physics"),
    ("gz-sim-user-commands-system", "gz::sim::systems::UserCommands"),
    ("gz-sim-scene-broadcaster-system", "gz::sim::systems::SceneBroadcaster"),
)
"""Gazebo's defaults, which it loads only into a world that names no system."""
_RENDERED = ("gz-sim-sensors-system", "gz::sim::systems::Sensors")
_SYSTEM_OF = {
    SensorKind.IMU: ("gz-sim-imu-system", "gz::sim::systems::Imu"),
    SensorKind.FORCE_TORQUE: ("gz-sim-forcetorque-system", "gz::sim::systems::ForceTorque"),
    SensorKind.CONTACT: ("gz-sim-contact-system", "gz::sim::systems::Contact"),
    SensorKind.CAMERA: _RENDERED,
    SensorKind.LIDAR: _RENDERED,
}


def world_around(top: Element, robot: Robot) -> Element:
    """Add a world for a lowered robot, without the robot."""
    world = element(top, "world", name=f"{robot.name}_world")
    physics = element(world, "physics", name="physics", type="ignored")
    element(physics, "max_step_size", settings_of(robot).timestep)
    element(physics, "real_time_factor", 1)
    kinds = [sensor.kind for sensor in robot.sensors]
    for system in dict.fromkeys((*_SYSTEMS, *(_SYSTEM_OF[kind] for kind in kinds if kind in _SYSTEM_OF))):
        plugin = element(world, "plugin", filename=system[0], name=system[1])
        if system is _RENDERED:
            element(plugin, "render_engine", "ogre2")
    element(world, "gravity", GRAVITY)
    scene = element(world, "scene")
    element(scene, "ambient", (0.4, 0.4, 0.4, 1.0))
    element(scene, "background", (0.7, 0.8, 0.9, 1.0))
    element(scene, "sky")
    _light(world, robot)
    _floor(world, robot)
    return world


def _light(world: Element, robot: Robot) -> None:
    (_, _, z), size = extent(robot)
    light = element(world, "light", name="sun", type="directional")
    element(light, "cast_shadows", "true")
    element(light, "pose", (0.0, 0.0, round(z + 4.0 * size, 3), 0.0, 0.0, 0.0))
    element(light, "diffuse", (0.8, 0.8, 0.8, 1.0))
    element(light, "specular", (0.2, 0.2, 0.2, 1.0))
    element(light, "direction", (-0.5, 0.1, -0.9))


def _floor(world: Element, robot: Robot) -> None:
    model = element(world, "model", name=free_name("floor", "_plane", {robot.name}))
    element(model, "static", "true")
    height = floor_height(robot)
    if height:
        element(model, "pose", (0.0, 0.0, height, 0.0, 0.0, 0.0))
    link = element(model, "link", name="link")
    for tag in ("collision", "visual"):
        shape = element(link, tag, name=tag)
        plane = element(element(shape, "geometry"), "plane")
        element(plane, "normal", (0.0, 0.0, 1.0))
        element(plane, "size", (_FLOOR_SIZE, _FLOOR_SIZE))
    material = element(shape, "material")
    element(material, "ambient", (0.6, 0.6, 0.6, 1.0))
    element(material, "diffuse", (0.6, 0.6, 0.6, 1.0))
