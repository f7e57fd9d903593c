"""A PROTO of Webots: https://cyberbotics.com/doc/reference/nodes-and-functions.

Links are `Solid` nodes inside each other, in the drawn pose: the stops of a hinge must include the position at which a
simulation starts. The base of a robot that is fixed to the world is a `Solid` in a `Robot` without physics, which
Webots attaches to the world. Every joint has a position sensor with its name, because joints have none.
"""

from collections.abc import Iterator

from stepbot.diagnostics import one_line
from stepbot.geometry.spatial import Pose, vector3
from stepbot.robot.bounding_boxes import extent, floor_height, standing_height
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Base, Joint, JointKind, Link, LoopClosure, Robot
from stepbot.robot.simulation_settings import settings_of
from stepbot.version import __version__

from ..features import USUAL, Feature, altered, deferred, exact, lowered, reported
from ..format import Companion
from ..lowering.joints import closure_points
from ..xml import number, text_of
from . import FORMAT, proto_name
from .nodes import (
    bounding_object,
    contact_materials,
    contact_properties,
    joint_devices,
    sensor_nodes,
    stops,
    visual_node,
)
from .vrml import Node, text

HEADER = "#VRML_SIM R2023b utf8"
_NO_SENSOR = reported("force-torque and contact sensors are omitted")
EXPRESSES = {
    **USUAL,
    Feature.FIXED_BASE: exact("a `Robot` without `Physics` around the base, which Webots attaches to the world"),
    Feature.FLOATING_BASE: exact("a `Robot` with `Physics`, standing on z = 0"),
    Feature.INERTIA: exact("`Physics` with mass, centre of mass and both vectors of the inertia"),
    Feature.MASSLESS_BODY: exact("as any link without mass"),
    Feature.MESH: exact("`Mesh` with the OBJ, path relative to the file"),
    Feature.STL_VISUAL: exact("as OBJ, in single precision"),
    Feature.DAE_VISUAL: exact("as OBJ, with `up_axis` Z and the colour"),
    Feature.GLB_VISUAL: lowered("`Mesh` has no glTF; visual meshes are OBJ"),
    Feature.STL_COLLISION: exact("as OBJ, in single precision"),
    Feature.SHAPE: exact("`Box`, `Cylinder`, `Sphere`"),
    Feature.CAPSULE: exact("`Capsule`"),
    Feature.FLAT_COLLISION: exact("as any mesh"),
    Feature.CONCAVE_COLLISION: exact("as any mesh"),
    Feature.COLOR: exact("`PBRAppearance`"),
    Feature.NEIGHBOURS: exact("links of a robot do not collide unless `selfCollision` is set"),
    Feature.EXCLUDED_CONTACT: exact("links of a robot do not collide unless `selfCollision` is set"),
    Feature.SURFACE: exact("`contactMaterial` of the solid, `ContactProperties` in `<robot>.wbt`"),
    Feature.SPIN: exact("`rollingFriction` of `ContactProperties`"),
    Feature.BOUNCE: exact("`bounce` of `ContactProperties`"),
    Feature.DEAD_BOUNCE: exact("as any restitution"),
    Feature.FIXED: exact("a `Solid` in its parent, merged by Webots"),
    Feature.REVOLUTE: exact("`HingeJoint` with stops"),
    Feature.CONTINUOUS: exact("`HingeJoint`"),
    Feature.PRISMATIC: exact("`SliderJoint`"),
    Feature.BALL: exact("`BallJoint`"),
    Feature.FAR_LIMIT: reported("a hinge has no such stops; only the motor keeps within the limits"),
    Feature.PASSIVE_LIMIT: reported("only motors have effort and velocity limits"),
    Feature.OPEN_POSITION: exact("no stops"),
    Feature.OPEN_EFFORT: exact("1e9 in a motor"),
    Feature.EFFORT: exact("`maxTorque`, `maxForce` of the motor"),
    Feature.VELOCITY: exact("`maxVelocity` of the motor"),
    Feature.FRICTION: exact("`dampingConstant`, `staticFriction`"),
    Feature.SPRING: reported("springs are omitted: theirs have no rest position of their own"),
    Feature.STIFF_DAMPING: exact("as any damping"),
    Feature.MIMIC: altered("mimics are motors coupled with that of the joint they follow, without offset"),
    Feature.CLOSURE: exact("a joint to a `SolidReference`; a fixed closure is three ball joints"),
    Feature.SLIDING_CLOSURE: exact("a `SliderJoint` to a `SolidReference`"),
    Feature.STUCK_CLOSURE: exact("a `SliderJoint` to a `SolidReference`"),
    Feature.FOLLOWER: exact("held by the closure"),
    Feature.LOOP_ZERO: exact("links in the drawn pose"),
    Feature.INITIAL_POSE: exact("links in the drawn pose, `position` of each joint"),
    Feature.FRAME: exact("`Solid` without content"),
    Feature.ACTUATOR: lowered("actuators are motors, whose controller is Webots': gains and kind are omitted"),
    Feature.SECOND_ACTUATOR: reported("a joint has one motor; its further actuators are omitted"),
    Feature.GEAR: lowered("gears are folded into inputs, which apply at the joint"),
    Feature.UNLIMITED_ACTUATOR: exact("1e9"),
    Feature.JOINT_SENSOR: reported("every joint has a position sensor, `<joint>_sensor`, in place of these"),
    Feature.IMU: exact("`InertialUnit`, `Accelerometer`, `Gyro`"),
    Feature.FORCE_TORQUE: _NO_SENSOR,
    Feature.OFF_JOINT: _NO_SENSOR,
    Feature.CAMERA: exact("`Camera`"),
    Feature.OPTICAL: exact("`Camera`, which has no other frame"),
    Feature.LIDAR: exact("`Lidar`"),
    Feature.CONTACT: _NO_SENSOR,
    Feature.SENSOR_PLACE: exact("`translation`, `rotation`"),
    Feature.SENSOR_RATE: reported("the controller sets rates"),
    Feature.ENCODER_RATE: reported("the controller sets rates"),
    Feature.CAMERA_EXTRAS: exact("`near`, `far`"),
    Feature.LIDAR_NEAREST: exact("`minRange`"),
    Feature.TIMESTEP: exact("`basicTimeStep` in `<robot>.wbt`"),
    Feature.SOLVER: deferred("settings of the physics engine"),
    Feature.JOINT_NAME: exact("joints have no names, their sensors have"),
    Feature.FRAME_NAME: exact("names are of nodes inside each other"),
    Feature.RESERVED_NAME: exact("any name is a string"),
}


def reserves(_name: str) -> bool:
    """No name is reserved: all are strings."""
    return False


def render(robot: Robot) -> bytes:
    """The PROTO of a lowered robot."""
    licensed = f"# license: {one_line(robot.metadata.license)}\n" if robot.metadata.license else ""
    origin = f" from {one_line(robot.source)}" if robot.source else ""
    height = standing_height(robot, initial_configuration(robot))
    body = "\n".join(_robot(robot).lines("  "))
    return f"""{HEADER}
{licensed}# Written by stepbot {__version__}{origin}.
PROTO {proto_name(robot.name)} [
  field SFVec3f translation 0 0 {number(height)}
  field SFRotation rotation 0 0 1 0
  field SFString name {text(robot.name)}
  field SFString controller "<none>"
  field MFString controllerArgs []
  field SFBool supervisor FALSE
  field SFBool synchronization TRUE
  field SFBool selfCollision FALSE
]
{{
  Robot {{
{body}
}}
""".encode()


def companions(_robot: Robot) -> tuple[Companion, ...]:
    """None: one file is enough."""
    return ()


def scenes(robot: Robot) -> dict[str, bytes]:
    """A world with floor and light, in which the robot stands."""
    return {f"{proto_name(robot.name)}{FORMAT.scene}": world(robot, HEADER)}


def _robot(robot: Robot) -> Node:
    top = Node("Robot")
    for name in ("translation", "rotation", "name", "controller", "controllerArgs", "supervisor", "synchronization"):
        top.set(name, f"IS {name}")
    top.set("selfCollision", "IS selfCollision")
    base = _Solids(robot).solid(robot.root)
    if robot.base is Base.FIXED:
        base.set("name", text(robot.root.name))
        return top.set("children", [base])
    top.set("model", text(robot.root.name))
    top.fields += base.fields
    return top


class _Solids:
    """The links of a robot as nodes."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.files = MeshFiles(robot)
        self.materials = contact_materials(robot)
        self.drawn = initial_configuration(robot)
        self.X_RL = link_poses(robot, self.drawn)

    def solid(self, link: Link) -> Node:
        """A link with all that is on it, and with the links below it."""
        robot = self.robot
        children = [visual_node(visual, self.files) for visual in link.visuals]
        children += [node for sensor in robot.sensors if sensor.link == link.name for node in sensor_nodes(sensor)]
        for frame in robot.frames:
            if frame.link == link.name:
                children.append(Node("Solid").place(frame.X_LF).set("name", text(frame.name)))
        children += [self._joint(joint) for joint in robot.joints if joint.parent == link.name]
        children += [node for closure in robot.closures if closure.link_a == link.name for node in _closure(closure)]
        solid = Node("Solid")
        if children:
            solid.set("children", children)
        if link.collisions:
            solid.set("boundingObject", bounding_object(link.collisions, self.files))
            if link.collisions[0].surface.is_stated:
                solid.set("contactMaterial", text(self.materials[link.collisions[0].surface]))
        return solid.set("physics", _physics(link))

    def _joint(self, joint: Joint) -> Node:
        child = self.solid(self.robot.link_by_name[joint.child]).set("name", text(joint.child))
        child.place(self.X_RL[joint.parent].inverse() @ self.X_RL[joint.child])
        if joint.kind is JointKind.FIXED:
            return child
        node = _joint_node(joint.kind, joint.X_PC, joint.axis)
        (_, parameters), *_ = node.fields
        assert isinstance(parameters, Node)
        if joint.kind is not JointKind.BALL:
            if self.drawn[joint.name]:
                parameters.set("position", self.drawn[joint.name])
            stops(parameters, joint)
        node.set("device", joint_devices(joint, self.robot))
        return node.set("endPoint", child)


def _joint_node(kind: JointKind, X_PJ: Pose, axis: tuple[float, float, float]) -> Node:
    """A joint with its anchor and axis in the parent, at q = 0."""
    turned = vector3(X_PJ.turn(axis))
    if kind is JointKind.PRISMATIC:
        return Node("SliderJoint").set("jointParameters", Node("JointParameters").set("axis", turned))
    if kind is JointKind.BALL:
        return Node("BallJoint").set("jointParameters", Node("BallJointParameters").set("anchor", X_PJ.position))
    parameters = Node("HingeJointParameters").set("axis", turned).set("anchor", X_PJ.position)
    return Node("HingeJoint").set("jointParameters", parameters)


def _closure(closure: LoopClosure) -> Iterator[Node]:
    """The joints that close a loop: one, or three ball joints in place of a fixed one."""
    fixed = closure.kind is JointKind.FIXED
    for p_F in closure_points(closure)[: None if fixed else 1]:
        X_AP = closure.X_AF @ Pose.of(position=p_F)
        end = Node("SolidReference").set("solidName", text(closure.link_b))
        kind = JointKind.BALL if fixed else closure.kind
        yield _joint_node(kind, X_AP, closure.axis).set("endPoint", end)


def _physics(link: Link) -> Node:
    body = link.mass_properties
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = body.inertia
    physics = Node("Physics").set("density", -1.0).set("mass", body.mass)
    physics.set("centerOfMass", f"[ {text_of(body.com)} ]")
    return physics.set("inertiaMatrix", f"[ {text_of((ixx, iyy, izz))}, {text_of((ixy, ixz, iyz))} ]")


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
