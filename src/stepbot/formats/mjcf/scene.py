"""A scene around the robot's MJCF, which it includes: floor, light, sky and a camera."""

from math import cos, radians, sin

import numpy as np

from stepbot.geometry.spatial import unit
from stepbot.robot.bounding_boxes import extent, floor_height, standing_height
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import ActuatorKind, Base, Joint, JointKind, Robot
from stepbot.robot.multi_dof import steps_by_child
from stepbot.robot.sensors import SensorKind

from ..xml import Element, document, element, root

_FLOOR, _CAMERA = "floor", "overview"
_AZIMUTH, _ELEVATION = radians(35.0), radians(25.0)
"""Direction from the robot to the camera: in front of it, on its left side, above it."""
_DISTANCE = 2.9
"""Distance of the camera in half diagonals of the robot: all of it is in the view of 45 degrees, MuJoCo's default."""
_DIGITS = 3


def scene(robot: Robot, main: str) -> bytes:
    """The scene for a robot in the file ``main``, in the same folder."""
    center, size = extent(robot)
    top = root("mujoco", robot.source, model=f"{robot.name} scene")
    element(top, "include", file=main)
    element(top, "statistic", center=_rounded(center), extent=max(round(size, _DIGITS), 10.0**-_DIGITS))
    visual = element(top, "visual")
    element(visual, "headlight", diffuse=(0.6, 0.6, 0.6), ambient=(0.3, 0.3, 0.3), specular=(0.0, 0.0, 0.0))
    element(visual, "rgba", haze=(0.15, 0.25, 0.35, 1.0))
    _floor_material(element(top, "asset"))
    world = element(top, "worldbody")
    above = (center[0], center[1], center[2] + 4.0 * size)
    element(world, "light", pos=_rounded(above), dir=(0.0, 0.0, -1.0), directional="true")
    shapes = {visual.name for link in robot.links for visual in link.visuals}
    shapes |= {collision.name for link in robot.links for collision in link.collisions}
    floor = {"name": free_name(_FLOOR, "_plane", shapes), "material": _FLOOR}
    height = floor_height(robot)
    place = {"pos": (0.0, 0.0, height)} if height else {}
    element(world, "geom", **floor, type="plane", size=(0.0, 0.0, 0.05), **place)
    cameras = {sensor.name for sensor in robot.sensors if sensor.kind is SensorKind.CAMERA}
    _camera(world, free_name(_CAMERA, "_camera", cameras), center, size)
    return document(top)


def _floor_material(asset: Element) -> None:
    """The sky, and a floor of squares of half a metre."""
    sky = {"rgb1": (0.3, 0.5, 0.7), "rgb2": (0.0, 0.0, 0.0)}
    element(asset, "texture", type="skybox", builtin="gradient", **sky, width=512, height=3072)
    squares = {"rgb1": (0.2, 0.3, 0.4), "rgb2": (0.1, 0.2, 0.3), "markrgb": (0.8, 0.8, 0.8)}
    element(asset, "texture", type="2d", name=_FLOOR, builtin="checker", mark="edge", **squares, width=300, height=300)
    element(asset, "material", name=_FLOOR, texture=_FLOOR, texuniform="true", texrepeat=(2.0, 2.0), reflectance=0.2)


def _camera(world: Element, name: str, center: tuple[float, float, float], size: float) -> None:
    """A camera that looks at the whole robot; it looks along -z with y up."""
    back = np.array([cos(_AZIMUTH) * cos(_ELEVATION), sin(_AZIMUTH) * cos(_ELEVATION), sin(_ELEVATION)])
    right = unit(np.cross((0.0, 0.0, 1.0), back))
    place = _rounded(np.array(center) + _DISTANCE * size * back)
    axes = _rounded([*right, *np.cross(back, right)], 6)
    element(world, "camera", name=name, pos=place, xyaxes=axes)


def _rounded(values: object, digits: int = _DIGITS) -> list[float]:
    return [float(value) + 0.0 for value in np.round(np.asarray(values, dtype=np.float64), digits)]


HOME = "home"
"""Name of the keyframe."""


def keyframe(top: Element, robot: Robot) -> None:
    """Add the drawn pose, if it is not q = 0, a loop must close, or the base floats; position actuators hold it."""
    drawn = initial_configuration(robot)
    floats = robot.base is Base.FLOATING
    if not (robot.closures or floats or any(drawn.values())):
        return
    base = [0.0, 0.0, standing_height(robot, drawn), 1.0, 0.0, 0.0, 0.0] if floats else []
    steps = steps_by_child(robot)
    qpos = base + [value for link in _depth_first(robot) for step in steps[link] for value in _drawn(step)]
    control = [
        drawn[actuator.joint] * actuator.gear if actuator.kind is ActuatorKind.POSITION else 0.0
        for actuator in robot.actuators
    ]
    element(element(top, "keyframe"), "key", name=HOME, qpos=qpos, **({"ctrl": control} if any(control) else {}))


def _drawn(step: Joint) -> list[float]:
    """MuJoCo's coordinates of a joint as drawn; multi-dof joints are drawn at 0."""
    if step.kind is JointKind.BALL:
        return [1.0, 0.0, 0.0, 0.0]
    return [] if step.kind is JointKind.FIXED else [step.drawn_position]


def _depth_first(robot: Robot) -> list[str]:
    """Names of the links below the root in the order of MuJoCo's coordinates: that of the nested bodies."""
    below: dict[str, list[Joint]] = {link.name: [] for link in robot.links}
    for joint in robot.joints:
        below[joint.parent].append(joint)
    order: list[str] = []
    stack = list(reversed(below[robot.root.name]))
    while stack:
        joint = stack.pop()
        order.append(joint.child)
        stack += reversed(below[joint.child])
    return order
