"""What is read of a URDF: http://wiki.ros.org/urdf/XML, ros2_control, and sensors and springs of Gazebo's blocks."""

from .vocabulary import SENSOR, Vocabulary, each, paths

BULLET = {
    "lateral_friction": "friction",
    "rolling_friction": "rolling",
    "spinning_friction": "torsional",
    "restitution": "restitution",
}
"""PyBullet's elements of `<contact>`, and the contact properties of the model."""
_ORIGIN = {"origin": "xyz rpy quat_xyzw"}
_GEOMETRY = {
    "geometry": "",
    "geometry/box": "size",
    "geometry/cylinder": "radius length",
    "geometry/capsule": "radius length",
    "geometry/sphere": "radius",
    "geometry/mesh": "filename scale",
}
_MATERIAL = {"material": "name", "material/color": "rgba"}
_CONTROL = {
    "": "name type",
    "hardware": "",
    "joint": "name",
    "joint/command_interface": "name",
    "joint/command_interface/param": "name",
    "joint/state_interface": "name",
    "joint/state_interface/param[initial_value]": "name",
    "sensor": "name",
    "sensor/state_interface": "name",
    "sensor/param": "name",
    "transmission": "name",
    "transmission/plugin": "",
    "transmission/actuator": "name role",
    "transmission/joint": "name role",
    "transmission/joint/mechanical_reduction": "",
}
_TRANSMISSION = {
    "": "name type",
    "type": "",
    "joint": "name",
    "joint/hardwareInterface": "",
    "actuator": "name",
    "actuator/mechanicalReduction": "",
}
_GAZEBO = {
    "": "reference",
    "mu1": "value",
    "springStiffness": "",
    "springReference": "",
    "preserveFixedJoint": "",  # the model keeps all fixed joints
    "disableFixedJointLumping": "",
    **paths("sensor", SENSOR),
}

_LINK = {
    "": "name",
    "inertial": "",
    "inertial/mass": "value",
    "inertial/inertia": "ixx ixy ixz iyy iyz izz",
    **paths("inertial", _ORIGIN),
    "contact": "",
    **paths("contact", dict.fromkeys(BULLET, "value")),
    "visual": "name",
    **paths("visual", {**_ORIGIN, **_GEOMETRY, **_MATERIAL}),
    "collision": "name",
    **paths("collision", {**_ORIGIN, **_GEOMETRY}),
}
_JOINT = {"": "name type", **_ORIGIN, "parent": "link", "child": "link", "axis": "xyz"}
_DRIVEN = {
    **_JOINT,
    "limit": "lower upper effort velocity acceleration deceleration jerk",
    "dynamics": "damping friction",
    "mimic": "joint multiplier offset",
}
_TYPES = ("revolute", "continuous", "prismatic", "fixed")
"""Types of joints that have one position, or none."""

URDF = Vocabulary(
    read={
        "robot": "name version",
        **each(["robot"], _MATERIAL),
        **paths("robot/link", _LINK),
        **each([f"robot/joint[{kind}]" for kind in _TYPES], _DRIVEN),
        "robot/joint[*]": "",
        **each(["robot/joint[planar]", "robot/joint[floating]"], _JOINT),
        **paths("robot/transmission", _TRANSMISSION),
        **paths("robot/ros2_control", _CONTROL),
        **paths("robot/gazebo", _GAZEBO),
    },
    neutral={
        "robot/gazebo/turnGravityOff": ("", "false", "0"),
        "robot/gazebo/gravity": ("", "true", "1"),
        "robot/gazebo/selfCollide": ("", "false", "0"),
        "robot/gazebo/provideFeedback": ("", "false", "0"),
        "robot/ros2_control/hardware/plugin": ("mock_components/GenericSystem",),
    },
    effects={
        "texture": "the visual has its plain colour",
        "safety_controller": "soft limits are not enforced",
        "turnGravityOff": "gravity acts on the link",
        "gravity": "gravity acts on the link",
        "selfCollide": "which links collide is left to the formats' defaults",
        "mu2": "friction is the same in all directions",
        "plugin": "simulator plugins and hardware interfaces are set up anew",
        "drake:proximity_properties": "contact properties are those of the formats' defaults",
    },
    kinds={"robot/joint": "type", "robot/ros2_control/joint/state_interface/param": "name"},
    twins={"robot/gazebo/mu2": "mu1"},
)
