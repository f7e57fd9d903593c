"""The robot as a xacro macro, with a prefix for all names, to be mounted on a link: https://wiki.ros.org/xacro."""

import re

from msgspec.structs import replace

from stepbot.robot.model import Robot
from stepbot.robot.renaming import KINDS, renamed

from ...lowering.masses import massless_bodies, massless_fixed
from ...xml import Element, document, element, root
from ..extensions import HARDWARE, INITIAL, systems
from ..package import with_package

_XACRO = "http://www.ros.org/wiki/xacro"
_PREFIX = "${prefix}"
GAZEBO_LIBRARY = "gz_ros2_control-system"
GAZEBO_PLUGIN = "gz_ros2_control::GazeboSimROS2ControlPlugin"
GAZEBO_HARDWARE = "gz_ros2_control/GazeboSimSystem"
_CONTROL = {"hardware": f"'{HARDWARE}'", "controllers": "''"}
"""The plugin of ros2_control, and the settings of its controllers if Gazebo is to run them."""
_START = "initial_positions"
_POSITIONS = f"{_START}_file"
LEAST_MASS = 1e-5
"""Mass [kg] at which libsdformat keeps a moving link that has none: it takes up to 1e-6 kg for no mass."""
_GYRATION = 1e-3
"""Square of the radius of gyration [m^2] of such a mass: 3 cm."""
_LEAST = {"least_mass": "0"}
"""Mass of moving links that have none, for Gazebo: its conversion drops them, with all below. It merges links on fixed
joints, and divides by the mass of both: with a mass for those that move, those that are fixed have no ``<inertial>``.
"""
_PLACE = {"parent": "''", "xyz": "'0 0 0'", "rpy": "'0 0 0'"}


def macro_name(robot: Robot) -> str:
    """The robot's name as the name of an XML element."""
    name = re.sub(r"\W", "_", robot.name, flags=re.ASCII)
    return f"_{name}" if name[0].isdigit() else name


def macro_xacro(robot: Robot, package: str) -> bytes:
    """The file that defines the macro."""
    from ..writer import content

    top = _top(robot.source)
    given = _parameters(robot) | ({_START: "${dict()}"} if robot.actuators else {})
    parameters = " ".join(f"{name}:={value}" for name, value in given.items())
    macro = element(top, _tag("macro"), name=macro_name(robot), params=parameters)
    mounted = element(macro, _tag("if"), value="${parent != ''}")
    joint = element(mounted, "joint", name=f"{_PREFIX}mount", type="fixed")
    element(joint, "origin", xyz="${xyz}", rpy="${rpy}")
    element(joint, "parent", link="${parent}")
    element(joint, "child", link=_prefixed(robot.root.name))
    content(macro, with_prefix(robot))
    _weigh(macro, robot)
    if robot.actuators:
        _control(macro, robot)
    return with_package(document(top), package)


def instance_xacro(robot: Robot) -> bytes:
    """The file of one robot, which takes the parameters of the macro as arguments; `parent:=world` adds that link."""
    from ..writer import version_of

    top = _top(robot.source, name=_escaped(robot.name), **version_of(robot))
    element(top, _tag("include"), filename=f"{_escaped(robot.name)}.macro.xacro")
    defaults = _parameters(robot)
    for name, value in defaults.items():
        element(top, _tag("arg"), name=name, default=value.strip("'"))
    parameters = {name: f"$(arg {name})" for name in defaults}
    if robot.actuators:
        element(top, _tag("arg"), name=_POSITIONS, default=f"../config/{_START}.yaml")
        parameters[_START] = f"${{xacro.load_yaml('$(arg {_POSITIONS})')['{_START}']}}"
    world = element(top, _tag("if"), value="${'$(arg parent)' == 'world'}")
    element(world, "link", name="world")
    element(top, _tag(macro_name(robot)), **parameters)
    return document(top)


def _parameters(robot: Robot) -> dict[str, str]:
    """The parameters of the macro, with their defaults; those of ros2_control for a robot with actuators only."""
    place = _PLACE | (_LEAST if needs_least_mass(robot) else {})
    if not robot.actuators:
        return {"prefix": "''", **place}
    return {"prefix": "''", **place, **_CONTROL, **dict.fromkeys(filter(None, _hardware(robot)), "''")}


def needs_least_mass(robot: Robot) -> bool:
    """Whether Gazebo cannot convert the URDF as it is, for its links without mass."""
    return bool(massless_bodies(robot) or massless_fixed(robot))


def _weigh(macro: Element, robot: Robot) -> None:
    """Let the caller give a mass to moving links that have none."""
    light = {_prefixed(name) for name in massless_bodies(robot)}
    held = {_prefixed(name) for name in massless_fixed(robot)} - light
    for link in macro.iterfind("link"):
        for inertial in link.findall("inertial") if link.get("name") in held else ():
            known = element(link, _tag("if"), value="${least_mass == 0}")
            link.remove(known)
            link[list(link).index(inertial)] = known
            known.append(inertial)
    for link in macro.iterfind("link"):
        if link.get("name") in light:
            for mass in link.iterfind("inertial/mass"):
                mass.set("value", "${least_mass}")
            for inertia in link.iterfind("inertial/inertia"):
                for axis in ("ixx", "iyy", "izz"):
                    inertia.set(axis, f"${{least_mass*{_GYRATION:g}}}")


def _hardware(robot: Robot) -> list[str]:
    """For each ``<ros2_control>`` block the parameter with its hardware, empty for ``hardware`` itself."""
    return [module and re.sub(r"\W", "_", f"{module}_hardware", flags=re.ASCII) for module in systems(robot)]


def _control(macro: Element, robot: Robot) -> None:
    """Let the caller choose the hardware and the start, and Gazebo run the controllers.

    https://control.ros.org/rolling/doc/gz_ros2_control
    """
    names = {_prefixed(joint.name): _literal(joint.name) for joint in robot.joints}
    for joint in macro.iterfind("ros2_control/joint"):
        for start in joint.iterfind(f"state_interface/param[@name='{INITIAL}']"):
            start.text = f"${{{_START}.get({names[str(joint.get('name'))]}, '{start.text}')}}"
    for system, own in zip(macro.iterfind("ros2_control"), _hardware(robot), strict=True):
        hardware = f"({own} or hardware)" if own else "hardware"
        for plugin in system.iterfind("hardware/plugin"):
            plugin.text = f"${{{hardware}}}"
        for joint in [one for one in system.iterfind("joint") if one.find("command_interface") is None]:
            # a driver of hardware rejects joints that it does not know
            known = element(system, _tag("if"), value=f"${{{hardware} in {[HARDWARE, GAZEBO_HARDWARE]!r}}}")
            system.remove(known)
            system[list(system).index(joint)] = known
            known.append(joint)
    gazebo = element(element(macro, _tag("if"), value="${controllers != ''}"), "gazebo")
    plugin = element(gazebo, "plugin", filename=GAZEBO_LIBRARY, name=GAZEBO_PLUGIN)
    element(plugin, "parameters", "${controllers}")


def with_prefix(robot: Robot) -> Robot:
    """The robot with the prefix before all names of links, joints, shapes, actuators and sensors."""
    return replace(renamed(robot, **dict.fromkeys(KINDS, _prefixed)), name=_prefixed(robot.name))


def _prefixed(name: str) -> str:
    return _PREFIX + _escaped(name)


def _escaped(text: str) -> str:
    """A name that xacro evaluates to itself: dollars, which begin expressions, are written by their code."""
    return re.sub(r"\$+", lambda dollars: "${'" + r"\x24" * len(dollars[0]) + "'}", text)


def _literal(name: str) -> str:
    """A name as a text in an expression of xacro."""
    return (
        "'"
        + "".join(one if one.isascii() and (one.isalnum() or one == "_") else f"\\U{ord(one):08x}" for one in name)
        + "'"
    )


def _tag(name: str) -> str:
    return f"{{{_XACRO}}}{name}"


def _top(source: str, **attributes: str) -> Element:
    return root("robot", source, {"xacro": _XACRO}, **attributes)
