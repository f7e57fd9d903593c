"""Elements of a URDF for specific readers: `<contact>`, `<gazebo>`, `<transmission>` and `<ros2_control>`.

https://github.com/gazebosim/sdf_tutorials/blob/master/docs/urdf/sdf_extensions.md
"""

from stepbot.robot.model import Joint, JointKind, Link, Robot
from stepbot.robot.sensors import SensorKind
from stepbot.robot.surfaces import PLAIN, Surface

from ..sdformat.sensors import sensors_on_joint, sensors_on_link
from ..xml import Element, element
from .ros2_control import ros2_control, transmissions


def extensions(top: Element, robot: Robot) -> None:
    """Add friction, springs, actuators and sensors."""
    for joint in robot.joints:
        _of_joint(top, joint, robot)
    for link in robot.links:
        block = element(top, "gazebo", reference=link.name)
        friction = surface_of(link).friction
        if friction is not None:
            element(block, "mu1", friction)
            element(block, "mu2", friction)
        sensors_on_link(block, link, robot.sensors, _shapes_in_gazebo(link))
        if not len(block):
            top.remove(block)
    transmissions(top, robot)
    ros2_control(top, robot)


_BULLET = {
    "lateral_friction": "friction",
    "rolling_friction": "rolling",
    "spinning_friction": "torsional",
    "restitution": "restitution",
}


def surface_of(link: Link) -> Surface:
    """The contact properties of a link of a lowered robot, whose shapes all have the same."""
    return link.collisions[0].surface if link.collisions else PLAIN


def contact(xml: Element, link: Link) -> None:
    """Add PyBullet's contact properties of a link."""
    given = {tag: getattr(surface_of(link), name) for tag, name in _BULLET.items()}
    block = element(xml, "contact") if any(value is not None for value in given.values()) else xml
    for tag, value in given.items():
        if value is not None:
            element(block, tag, value=value)


def _shapes_in_gazebo(link: Link) -> list[str]:
    """Names of a link's collision shapes after Gazebo's conversion of URDF to SDFormat."""
    numbers = ["", *(f"_{i}" for i in range(1, len(link.collisions)))]
    return [f"{shape.name}_collision{number}" for shape, number in zip(link.collisions, numbers, strict=False)]


def _of_joint(top: Element, joint: Joint, robot: Robot) -> None:
    """The `<gazebo>` settings of a joint.

    Without them, Gazebo merges fixed joints, and loses their force-torque sensors and the names of shapes that contact
    sensors refer to.
    """
    fixed = joint.kind is JointKind.FIXED
    weighed = any(s.kind is SensorKind.FORCE_TORQUE and s.joint == joint.name for s in robot.sensors)
    watched = fixed and any(s.kind is SensorKind.CONTACT and s.link == joint.child for s in robot.sensors)
    spring = joint.dynamics.stiffness
    if not (weighed or watched or spring):
        return
    block = element(top, "gazebo", reference=joint.name)
    if spring:
        element(block, "springStiffness", spring)
        element(block, "springReference", joint.dynamics.spring_reference)
    if fixed:
        element(block, "preserveFixedJoint", "true")
    sensors_on_joint(block, joint.name, robot.sensors)
