"""What a URDF says to some of its readers alone: `<gazebo>`, `<transmission>` and `<ros2_control>`.

https://github.com/gazebosim/sdf_tutorials/blob/master/docs/urdf/sdf_extensions.md
"""

from ..model import Joint, JointKind, Robot
from ..sensors import SensorKind
from ._ros2_control import ros2_control, transmissions
from ._sdf_sensors import sensors_on_joint, sensors_on_link
from ._xml import Element, element


def extensions(top: Element, robot: Robot) -> None:
    """Add springs, drives and sensors."""
    for joint in robot.joints:
        _of_joint(top, joint, robot)
    for link in robot.links:
        block = element(top, "gazebo", reference=link.name)
        sensors_on_link(block, link, robot.sensors)
        if not len(block):
            top.remove(block)
    transmissions(top, robot)
    ros2_control(top, robot)


def _of_joint(top: Element, joint: Joint, robot: Robot) -> None:
    """What Gazebo is told of a joint; fixed ones it would merge away, and a force-torque sensor with them."""
    weighed = any(s.kind is SensorKind.FORCE_TORQUE and s.joint == joint.name for s in robot.sensors)
    spring = joint.dynamics.stiffness
    if not (weighed or spring):
        return
    block = element(top, "gazebo", reference=joint.name)
    if spring:
        element(block, "springStiffness", spring)
        element(block, "springReference", joint.dynamics.spring_reference)
    if weighed and joint.kind is JointKind.FIXED:
        element(block, "preserveFixedJoint", "true")
    sensors_on_joint(block, joint.name, robot.sensors)
