"""URDF, as ROS and most simulators read it: http://wiki.ros.org/urdf/XML.

The root link is the robot's; there is no link called ``world``, because loaders treat it differently. Inertias are
about the centre of mass along the axes of the link (rpy = 0), since some readers ignore that rotation. Every link has
an ``<inertial>``, zero if it is massless: some engines assume 1 kg for a link without one.
"""

from collections.abc import Sequence
from math import isfinite

from msgspec import Struct

from stepbot.geometry.spatial import IDENTITY, Pose, Vector3, quaternion_from_rotation
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Joint,
    JointKind,
    Link,
    MeshRef,
    Robot,
    Sphere,
    Visual,
)

from ..features import USUAL, Feature, altered, deferred, exact, lowered, refused, reported
from ..format import Companion
from ..lowering.shapes import look, upright
from ..xml import Element, Patterns, document, element, root
from .extensions import contact, extensions
from .srdf import srdf

_SIMULATOR = "settings of the loading program"
_CAPSULES, _SMOOTH = 1.1, 1.2
"""The versions that have quaternions and capsules, and that have limits of acceleration and jerk."""

EXPRESSES = {
    **USUAL,
    Feature.FIXED_BASE: deferred("the loading program decides whether the base is fixed"),
    Feature.FLOATING_BASE: deferred("the loading program decides whether the base is fixed"),
    Feature.INERTIA: exact("`<inertial>` at the centre of mass with rpy = 0, on every link"),
    Feature.MASSLESS: exact("`<mass>` of 0"),
    Feature.MASSLESS_BODY: deferred(
        "Gazebo drops moving links without mass, and all below them, when it converts a URDF"
    ),
    Feature.MESH: exact("OBJ in metres, path relative to the file, or `package://`"),
    Feature.STL_VISUAL: exact("as OBJ, in single precision"),
    Feature.DAE_VISUAL: exact("as OBJ, with `up_axis` Z and the colour; not read by MuJoCo"),
    Feature.GLB_VISUAL: lowered("PyBullet rejects a URDF with glTF; visual meshes are OBJ"),
    Feature.STL_COLLISION: exact("as OBJ, in single precision; not read by Drake"),
    Feature.SHAPE: exact("`<box>`, `<cylinder>`, `<sphere>`"),
    Feature.CAPSULE: lowered("a capsule is written as a cylinder and two spheres", _CAPSULES, "`<capsule>`"),
    Feature.FLAT_COLLISION: reported("MuJoCo rejects a URDF with a flat collision mesh; omitted"),
    Feature.CONCAVE_COLLISION: exact("as any mesh"),
    Feature.COLOR: exact("a `<material>` in each visual"),
    Feature.NEIGHBOURS: exact("readers disable it between parent and child"),
    Feature.EXCLUDED_CONTACT: lowered("excluded pairs of links are in `<robot>.srdf`"),
    Feature.SURFACE: lowered("friction is in PyBullet's `<contact>` and `<gazebo>`"),
    Feature.SPIN: lowered("torsional and rolling friction are in PyBullet's `<contact>`"),
    Feature.BOUNCE: lowered("restitution is in PyBullet's `<contact>`"),
    Feature.DEAD_BOUNCE: exact("as any restitution"),
    Feature.FIXED: exact("`fixed`"),
    Feature.REVOLUTE: exact("`revolute`"),
    Feature.CONTINUOUS: exact("`continuous`"),
    Feature.PRISMATIC: exact("`prismatic`"),
    Feature.BALL: altered("a ball joint is written as yaw, pitch and roll joints, with gimbal lock at pitch = ±90°"),
    Feature.BALL_LIMIT: exact("limits of the yaw, pitch and roll joints"),
    Feature.BALL_FORCE: exact("forces on the yaw, pitch and roll joints"),
    Feature.FAR_LIMIT: exact("as any limit"),
    Feature.PASSIVE_LIMIT: exact("as any limit"),
    Feature.OPEN_POSITION: lowered(
        "a missing position limit is written as 1e9; a revolute joint without both is written as continuous"
    ),
    Feature.OPEN_EFFORT: lowered("a missing effort or velocity limit is written as 1e9"),
    Feature.EFFORT: exact("`effort`"),
    Feature.VELOCITY: exact("`velocity`"),
    Feature.ACCELERATION: reported(
        "limits of acceleration, deceleration and jerk are omitted",
        _SMOOTH,
        "`acceleration`, `deceleration`, `jerk`; a joint without `acceleration` has the one that its efforts allow",
    ),
    Feature.FRICTION: exact("`<dynamics>`"),
    Feature.SPRING: lowered("springs are in `<gazebo>`"),
    Feature.STIFF_DAMPING: reported("PyBullet, whose step is 4.2 ms by default, diverges by the damping of joints"),
    Feature.MIMIC: exact("`<mimic>`"),
    Feature.MIXED_MIMIC: exact("`<mimic>`"),
    Feature.CLOSURE: reported("a tree has no loops; left out"),
    Feature.SLIDING_CLOSURE: reported("a tree has no loops; left out"),
    Feature.STUCK_CLOSURE: reported("a tree has no loops; left out"),
    Feature.FOLLOWER: lowered("joints that follow a driven one through a loop are written with `<mimic>`"),
    Feature.LOOP_ZERO: exact("only the tree is written"),
    Feature.INITIAL_POSE: deferred("only `<ros2_control>` has the drawn pose, as `initial_value`"),
    Feature.FRAME: lowered("frames are massless links on fixed joints"),
    Feature.ACTUATOR: lowered("actuators are in `<ros2_control>` and `<transmission>`"),
    Feature.SECOND_ACTUATOR: exact("as any actuator"),
    Feature.GEAR: exact("`<mechanical_reduction>` in `<ros2_control>`"),
    Feature.ACTUATOR_INPUT: exact("`min`, `max` of the command interface"),
    Feature.UNLIMITED_ACTUATOR: exact("no limit"),
    Feature.JOINT_SENSOR: lowered("joint sensors are in `<ros2_control>`"),
    Feature.IMU: lowered("IMUs are in `<gazebo>` and `<ros2_control>`"),
    Feature.FORCE_TORQUE: lowered("force-torque sensors are in `<gazebo>` and `<ros2_control>`"),
    Feature.CAMERA: lowered("cameras are in `<gazebo>`"),
    Feature.OPTICAL: lowered("images of these cameras are in links `<camera>_optical_frame`"),
    Feature.LIDAR: lowered("lidars are in `<gazebo>`"),
    Feature.CONTACT: lowered("contact sensors are in `<gazebo>`"),
    Feature.SENSOR_PLACE: lowered("these sensors are on massless links with fixed joints"),
    Feature.SENSOR_RATE: exact("`<update_rate>`"),
    Feature.ENCODER_RATE: reported("ros2_control reads all joints at its own rate"),
    Feature.CAMERA_EXTRAS: exact("`<update_rate>`, `<clip>`"),
    Feature.LIDAR_NEAREST: exact("`<range>`"),
    Feature.TIMESTEP: deferred(_SIMULATOR),
    Feature.SOLVER: deferred(f"{_SIMULATOR}; PyBullet's point-to-point constraints ignore `erp`"),
    Feature.JOINT_NAME: exact("links and joints have separate namespaces"),
    Feature.RESERVED_NAME: refused("`world` is the world body"),
}


def reserves(name: str) -> bool:
    """Whether readers interpret the name as the world."""
    return name == "world"


def render(robot: Robot) -> bytes:
    """The URDF of a lowered robot."""
    top = root("robot", robot.source, name=robot.name, **version_of(robot))
    content(top, robot)
    return document(top)


def version_of(robot: Robot) -> dict[str, str]:
    """The attribute with the version of the format; none for 1.0, which some readers take for unknown."""
    return {} if robot.versions.urdf == 1.0 else {"version": f"{robot.versions.urdf:g}"}


def content(top: Element, robot: Robot) -> None:
    """Add everything in a URDF's root element to an element."""
    files, patterns, turned = MeshFiles(robot), Patterns(), _Turned(robot.versions.urdf)
    for link in robot.links:
        _link(top, link, files, patterns, turned)
    for joint in robot.joints:
        _joint(top, joint, turned)
    extensions(top, robot)


def companions(robot: Robot) -> tuple[Companion, ...]:
    """An SRDF, if it is known which links can overlap, or some must not touch."""
    if robot.self_collision is None and not robot.excluded_contacts:
        return ()
    excluded = robot.excluded_contacts
    content = srdf(robot.name, robot.self_collision, robot.source, robot, excluded=excluded)
    return (Companion(f"{robot.name}.srdf", "", robot, content),)


def scenes(_robot: Robot) -> dict[str, bytes]:
    """None: a URDF contains one robot and no world."""
    return {}


def _link(top: Element, link: Link, files: MeshFiles, patterns: Patterns, turned: "_Turned") -> None:
    xml = element(top, "link", name=link.name)
    mass = link.mass_properties
    inertial = element(xml, "inertial")
    turned.origin(inertial, mass.com)
    element(inertial, "mass", value=mass.mass)
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = mass.inertia
    element(inertial, "inertia", ixx=ixx, ixy=ixy, ixz=ixz, iyy=iyy, iyz=iyz, izz=izz)
    for shape in link.shapes:
        _shape(xml, shape, files, patterns, turned)
    contact(xml, link)


def _shape(parent: Element, shape: Visual | Collision, files: MeshFiles, patterns: Patterns, turned: "_Turned") -> None:
    X = upright(shape)

    def make(parent: Element, name: str, position: str) -> Element:
        xml = element(parent, "visual" if isinstance(shape, Visual) else "collision", name=name)
        turned.origin(xml, position if any(X.position) else X.position, X)
        _geometry(element(xml, "geometry"), shape, files)
        if isinstance(shape, Visual):
            element(element(xml, "material", name=name), "color", rgba=shape.rgba)
        return xml

    patterns.add(parent, look(shape), make, shape.name, X.position)


def _geometry(parent: Element, shape: Visual | Collision, files: MeshFiles) -> None:
    match shape.geometry:
        case Box(size):
            element(parent, "box", size=size)
        case Cylinder(radius, length):
            element(parent, "cylinder", radius=radius, length=length)
        case Sphere(radius):
            element(parent, "sphere", radius=radius)
        case MeshRef():
            element(parent, "mesh", filename=files.of(shape).path)
        case Capsule(radius, length):
            element(parent, "capsule", radius=radius, length=length)


def _joint(top: Element, joint: Joint, turned: "_Turned") -> None:
    xml = element(top, "joint", name=joint.name, type=joint.kind.value)
    turned.origin(xml, joint.X_PC.position, joint.X_PC)
    element(xml, "parent", link=joint.parent)
    element(xml, "child", link=joint.child)
    if joint.kind is JointKind.FIXED:
        return
    element(xml, "axis", xyz=joint.axis)
    limit = joint.limit
    bounds = {"lower": limit.lower, "upper": limit.upper, "effort": limit.effort, "velocity": limit.velocity}
    further = ("acceleration", "deceleration", "jerk") if turned.version >= _SMOOTH else ()
    smooth = {name: getattr(limit, name) for name in further}
    given = {name: value for name, value in (bounds | smooth).items() if isfinite(value)}
    if given:
        element(xml, "limit", **given)
    dynamics = {"damping": joint.dynamics.damping, "friction": joint.dynamics.friction}
    if any(dynamics.values()):
        element(xml, "dynamics", **{name: value for name, value in dynamics.items() if value})
    if joint.mimic is not None:
        multiplier, offset = joint.mimic.multiplier, joint.mimic.offset
        relation = {"multiplier": multiplier} if multiplier != 1.0 else {}
        element(xml, "mimic", joint=joint.mimic.joint, **relation, **({"offset": offset} if offset else {}))


class _Turned(Struct, frozen=True):
    """Writes where elements are, their rotations as the version of the format has them."""

    version: float

    def origin(self, parent: Element, xyz: str | Vector3, X: Pose = IDENTITY) -> None:
        """Add the ``<origin>`` of an element, unless it is at the origin and not turned."""
        rotation: dict[str, Sequence[float]] = {"rpy": X.rpy} if any(X.rpy) else {}
        if rotation and self.version >= _CAPSULES:
            w, *xyz_of = quaternion_from_rotation(X.R)
            rotation = {"quat_xyzw": (*xyz_of, w)}
        place = {"xyz": xyz} if any(xyz) else {}
        if place or rotation:
            element(parent, "origin", **place, **rotation)
