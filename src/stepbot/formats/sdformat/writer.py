"""SDFormat, as Gazebo and Drake read it: http://sdformat.org/spec.

Poses are flat: each link's in the model at q = 0, each joint's in its child, so that readers without ``relative_to``
understand them. A loop is closed by an additional joint: its frame is given in the child, and its frame in the parent
follows from the poses in the file, so the loop must close at q = 0 (:data:`Feature.LOOP_ZERO`).
"""

from math import isfinite, isinf, pi

from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY, Pose, Vector3
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import (
    Base,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Joint,
    JointDynamics,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshRef,
    Robot,
    Sphere,
    Visual,
)
from stepbot.robot.renaming import names_of
from stepbot.robot.surfaces import Surface

from ..features import USUAL, Feature, altered, deferred, exact, lowered, refused, reported
from ..format import Companion
from ..lowering.rerooted_loops import reroot_loops
from ..lowering.shapes import look, upright
from ..xml import Element, Patterns, document, element, root, text_of
from . import FORMAT
from . import drake as _drake
from .sensors import plugins, sdf_pose, sensors_on_joint, sensors_on_link
from .world import world_around

VERSION = "1.9"
MIMIC_VERSION = "1.11"
"""The first version that has ``<mimic>``."""
SCREW_VERSION = "1.10"
"""The first version that has ``<screw_thread_pitch>``, whose sign and unit all readers agree on."""

EXPRESSES = {
    **USUAL,
    Feature.FIXED_BASE: exact("fixed joint to `world`"),
    Feature.FLOATING_BASE: exact("no joint to `world`"),
    Feature.INERTIA: exact("`<inertial>` at the centre of mass, along the axes of the link"),
    Feature.MASSLESS: exact("`<mass>` of 0"),
    Feature.MASSLESS_BODY: exact("`<mass>` of 0"),
    Feature.MESH: exact("OBJ in metres, path relative to the file"),
    Feature.STL_VISUAL: exact("as OBJ, in single precision"),
    Feature.DAE_VISUAL: exact("as OBJ, with `up_axis` Z and the colour"),
    Feature.GLB_VISUAL: exact("`.glb` with the colour, for Gazebo; PyBullet rejects the file"),
    Feature.STL_COLLISION: exact("as OBJ, in single precision; not read by Drake"),
    Feature.SHAPE: exact("`<box>`, `<cylinder>`, `<sphere>`"),
    Feature.CAPSULE: exact("`<capsule>`"),
    Feature.FLAT_COLLISION: exact("as any mesh"),
    Feature.CONCAVE_COLLISION: exact("as any mesh"),
    Feature.COLOR: exact("`<ambient>`, `<diffuse>`, with the opacity as alpha"),
    Feature.NEIGHBOURS: exact("links of a model do not collide unless `<self_collide>` is set"),
    Feature.EXCLUDED_CONTACT: exact("links of a model do not collide unless `<self_collide>` is set"),
    Feature.SURFACE: exact("`<mu>`, `<mu2>`; of two shapes Gazebo takes the smaller"),
    Feature.BOUNCE: exact("`<restitution_coefficient>`"),
    Feature.DEAD_BOUNCE: exact("as any restitution"),
    Feature.MIXED_SURFACE: exact("a `<surface>` in each collision"),
    Feature.FIXED: exact("`fixed`"),
    Feature.REVOLUTE: exact("`revolute`"),
    Feature.CONTINUOUS: exact("`revolute` with limits of ±1e16; Gazebo's DART fixes a `continuous` joint"),
    Feature.PRISMATIC: exact("`prismatic`"),
    Feature.BALL: exact("`ball`"),
    Feature.UNIVERSAL: exact("`universal`"),
    Feature.SCREW: exact("`screw` with `<screw_thread_pitch>`, of version 1.10"),
    Feature.FAR_LIMIT: exact("as any limit"),
    Feature.PASSIVE_LIMIT: exact("as any limit"),
    Feature.OPEN_POSITION: exact("±1e16, which the format defines as unlimited"),
    Feature.OPEN_EFFORT: exact("no element"),
    Feature.EFFORT: exact("`<effort>`"),
    Feature.VELOCITY: exact("`<velocity>`"),
    Feature.FRICTION: exact("`<dynamics>`"),
    Feature.SPRING: exact("`<spring_stiffness>`, `<spring_reference>`"),
    Feature.STIFF_DAMPING: exact("as any damping"),
    Feature.MIMIC: lowered("`<mimic>` requires version 1.11 (Gazebo Harmonic) instead of 1.9"),
    Feature.MIXED_MIMIC: exact("`<mimic>`"),
    Feature.CLOSURE: exact(
        "a second joint to the child, which Gazebo's DART ignores; `drake:ball_constraint` in `<robot>.drake.sdf`"
    ),
    Feature.SLIDING_CLOSURE: exact("a second joint to the child, after all joints of the tree"),
    Feature.STUCK_CLOSURE: exact("a second joint to the child; no file for Drake is written"),
    Feature.FOLLOWER: exact("held by the closure"),
    Feature.LOOP_ZERO: altered("loops must close at q = 0, so zeros are moved to the drawn pose"),
    Feature.INITIAL_POSE: deferred("the drawn pose of these joints is omitted"),
    Feature.FRAME: exact("`<frame>` attached to its link"),
    Feature.ACTUATOR: lowered("actuators are Gazebo plugins, without a name"),
    Feature.SECOND_ACTUATOR: exact("a plugin each"),
    Feature.UNLIMITED_ACTUATOR: lowered("a missing effort limit of an actuator is written as 1e9"),
    Feature.JOINT_SENSOR: lowered("joint sensors are Gazebo plugins, without a name"),
    Feature.IMU: exact("`imu`"),
    Feature.FORCE_TORQUE: exact("`force_torque` in its joint"),
    Feature.CAMERA: exact("`camera`"),
    Feature.OPTICAL: lowered("images of these cameras are in frames `<camera>_optical_frame`"),
    Feature.LIDAR: exact("`gpu_lidar`"),
    Feature.CONTACT: exact("`contact` with the collisions of its link"),
    Feature.SENSOR_PLACE: exact("`<pose>`"),
    Feature.SENSOR_RATE: exact("`<update_rate>`"),
    Feature.ENCODER_RATE: reported("joint states are published in every step"),
    Feature.CAMERA_EXTRAS: exact("`<update_rate>`, `<clip>`"),
    Feature.LIDAR_NEAREST: exact("`<range>`"),
    Feature.TIMESTEP: exact("`<max_step_size>` in `<robot>.world.sdf`"),
    Feature.SOLVER: deferred("settings of the physics engine; Drake's ball constraints have no stiffness"),
    Feature.JOINT_NAME: altered("links, joints and frames share one namespace"),
    Feature.RESERVED_NAME: refused("`world`, `__x__` and `a::b` are reserved"),
}

_NO_LIMIT = 1e16
"""SDFormat 1.9's position limit for an unlimited joint."""


def reserves(name: str) -> bool:
    """Whether the name is the world's, reserved by the format (``__model__``), or parsed as a path of names."""
    return name == "world" or "::" in name or (name.startswith("__") and name.endswith("__"))


def render(robot: Robot) -> bytes:
    """The SDFormat of a lowered robot."""
    top = root("sdf", robot.source, version=sdf_version(robot))
    _whole(top, robot)
    return document(top)


def _whole(parent: Element, robot: Robot) -> Element:
    """The model with everything in it."""
    model = _tree(parent, robot)
    for closure in robot.closures:
        _closure(model, closure, robot)
    plugins(model, robot)
    return model


def companions(robot: Robot) -> tuple[Companion, ...]:
    """A file for Drake, if there are loops that its constraints can close: it rejects joints that close one."""
    cut = _drake.for_drake(reroot_loops(robot))
    if not cut.closures or any(closure.kind is JointKind.PRISMATIC for closure in cut.closures):
        return ()
    top = root("sdf", robot.source, {_drake.PREFIX: _drake.URI}, version=sdf_version(cut))
    _drake.constrain(_tree(top, cut), cut)
    return (Companion(f"{robot.name}.drake{FORMAT.suffix}", _drake.FORMAT, cut, document(top)),)


def scenes(robot: Robot) -> dict[str, bytes]:
    """A world with physics, floor, light and sky, in which the robot stands."""
    top = root("sdf", robot.source, version=sdf_version(robot))
    model = _whole(world_around(top, robot), robot)
    height = standing_height(robot, {})
    if height:
        sdf_pose(model, Pose.of(position=(0.0, 0.0, height)))
        pose = model[-1]
        model.remove(pose)
        model.insert(0, pose)
    return {f"{robot.name}{FORMAT.scene}": document(top)}


def _tree(top: Element, robot: Robot) -> Element:
    """The model with its links, the joints of its tree, and its frames."""
    model = element(top, "model", name=robot.name)
    X_ML, files, patterns = _link_poses(robot), MeshFiles(robot), Patterns()
    for link in robot.links:
        link = _with_own_names(link, robot)
        shapes = [collision.name for collision in link.collisions]
        sensors_on_link(_link(model, link, X_ML[link.name], files, patterns), link, robot.sensors, shapes)
    if robot.base is Base.FIXED:
        taken = set(names_of(robot, "links", "joints", "closures", "frames"))
        name = free_name(f"world_to_{robot.root.name}", "_joint", taken)
        _joint_head(model, name, "fixed", "world", robot.root.name)
    for joint in robot.joints:
        sensors_on_joint(_joint(model, joint), joint.name, robot.sensors)
    for frame in robot.frames:
        sdf_pose(element(model, "frame", name=frame.name, attached_to=frame.link), frame.X_LF)
    return model


def sdf_version(robot: Robot) -> str:
    """The first version that has everything that the robot needs, so that older readers can read the file."""
    if any(joint.mimic is not None for joint in robot.joints):
        return MIMIC_VERSION
    return SCREW_VERSION if any(joint.kind is JointKind.SCREW for joint in robot.joints) else VERSION


def _link_poses(robot: Robot) -> dict[str, Pose]:
    """X_ML of every link with all joints at q = 0, mimics too."""
    poses = {robot.root.name: IDENTITY}
    for joint in robot.joints:
        poses[joint.child] = poses[joint.parent] @ joint.X_PC
    return poses


def _with_own_names(link: Link, robot: Robot) -> Link:
    """A link with names of shapes that no other element in it has."""
    taken = {sensor.name for sensor in robot.sensors if sensor.link == link.name}
    return replace(
        link,
        visuals=tuple(replace(visual, name=free_name(visual.name, "_geom", taken)) for visual in link.visuals),
        collisions=tuple(
            replace(collision, name=free_name(collision.name, "_geom", taken)) for collision in link.collisions
        ),
    )


def _link(model: Element, link: Link, X_ML: Pose, files: MeshFiles, patterns: Patterns) -> Element:
    xml = element(model, "link", name=link.name)
    sdf_pose(xml, X_ML)
    mass = link.mass_properties
    inertial = element(xml, "inertial")
    element(inertial, "pose", (*mass.com, 0.0, 0.0, 0.0))
    element(inertial, "mass", mass.mass)
    inertia = element(inertial, "inertia")
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = mass.inertia
    for tag, value in (("ixx", ixx), ("ixy", ixy), ("ixz", ixz), ("iyy", iyy), ("iyz", iyz), ("izz", izz)):
        if value or tag in ("ixx", "iyy", "izz"):
            element(inertia, tag, value)
    for shape in link.shapes:
        _shape(xml, shape, files, patterns)
    return xml


def _shape(parent: Element, shape: Visual | Collision, files: MeshFiles, patterns: Patterns) -> None:
    X = upright(shape)

    def make(parent: Element, name: str, position: str) -> Element:
        xml = element(parent, "visual" if isinstance(shape, Visual) else "collision", name=name)
        if not X.is_identity:
            element(xml, "pose", f"{position} {text_of(X.rpy)}")
        _geometry(element(xml, "geometry"), shape, files)
        if isinstance(shape, Visual):
            material = element(xml, "material")
            element(material, "ambient", shape.rgba)
            element(material, "diffuse", shape.rgba)
        else:
            _surface(xml, shape.surface)
        return xml

    patterns.add(parent, look(shape), make, shape.name, X.position)


def _surface(collision: Element, given: Surface) -> None:
    """Friction and restitution of a collision."""
    if given.friction is None and given.restitution is None:
        return
    surface = element(collision, "surface")
    if given.restitution is not None:
        element(element(surface, "bounce"), "restitution_coefficient", given.restitution)
    if given.friction is not None:
        ode = element(element(surface, "friction"), "ode")
        element(ode, "mu", given.friction)
        element(ode, "mu2", given.friction)


def _geometry(parent: Element, shape: Visual | Collision, files: MeshFiles) -> None:
    match shape.geometry:
        case Box(size):
            element(element(parent, "box"), "size", size)
        case Cylinder(radius, length):
            _round(parent, "cylinder", radius, length)
        case Capsule(radius, length):
            _round(parent, "capsule", radius, length)
        case Sphere(radius):
            element(element(parent, "sphere"), "radius", radius)
        case MeshRef():
            element(element(parent, "mesh"), "uri", files.of(shape).path)


def _round(parent: Element, tag: str, radius: float, length: float) -> None:
    xml = element(parent, tag)
    element(xml, "radius", radius)
    element(xml, "length", length)


def _joint_head(model: Element, name: str, kind: str, parent: str, child: str) -> Element:
    xml = element(model, "joint", name=name, type=kind)
    element(xml, "parent", parent)
    element(xml, "child", child)
    return xml


def _joint(model: Element, joint: Joint) -> Element:
    # DART's plugin of Gazebo makes a fixed joint of a continuous one; without limits a revolute joint is the same.
    kind = JointKind.REVOLUTE if joint.kind is JointKind.CONTINUOUS else joint.kind
    xml = _joint_head(model, joint.name, kind.value, joint.parent, joint.child)
    if joint.kind is JointKind.SCREW:
        element(xml, "screw_thread_pitch", joint.pitch * 2.0 * pi)
    if not joint.kind.has_axis:
        return xml
    axis = _axis(xml, "axis", joint.axis)
    _limit(axis, joint.kind, joint.limit)
    _dynamics(axis, joint.dynamics)
    if joint.kind is JointKind.UNIVERSAL:
        second = _axis(xml, "axis2", joint.axis2)
        _limit(second, joint.kind, joint.limit)
        _dynamics(second, joint.dynamics)
    if joint.mimic is not None:
        mimic = element(axis, "mimic", joint=joint.mimic.joint)
        element(mimic, "multiplier", joint.mimic.multiplier)
        if joint.mimic.offset:
            element(mimic, "offset", joint.mimic.offset)
    return xml


def _closure(model: Element, closure: LoopClosure, robot: Robot) -> None:
    """The joint that closes a loop; the root is never its child, so that every reader still finds one root."""
    parent, child, X_CF = closure.link_a, closure.link_b, closure.X_BF
    if child == robot.root.name:
        parent, child, X_CF = closure.link_b, closure.link_a, closure.X_AF
    xml = _joint_head(model, closure.name, closure.kind.value, parent, child)
    sdf_pose(xml, X_CF)
    if closure.kind.has_axis:
        _limit(_axis(xml, "axis", closure.axis), closure.kind, Limit())


def _axis(joint: Element, tag: str, axis: Vector3) -> Element:
    xml = element(joint, tag)
    element(xml, "xyz", axis)
    return xml


def _limit(axis: Element, kind: JointKind, limit: Limit) -> None:
    bounded = kind is not JointKind.UNIVERSAL
    if not (bounded or isfinite(limit.effort) or isfinite(limit.velocity)):
        return
    xml = element(axis, "limit")
    if bounded:
        element(xml, "lower", -_NO_LIMIT if isinf(limit.lower) else limit.lower)
        element(xml, "upper", _NO_LIMIT if isinf(limit.upper) else limit.upper)
    if isfinite(limit.effort):
        element(xml, "effort", limit.effort)
    if isfinite(limit.velocity):
        element(xml, "velocity", limit.velocity)


def _dynamics(axis: Element, dynamics: JointDynamics) -> None:
    given = {"damping": dynamics.damping, "friction": dynamics.friction}
    if dynamics.stiffness:  # without which its rest position has no effect
        given |= {"spring_reference": dynamics.spring_reference, "spring_stiffness": dynamics.stiffness}
    nonzero = {tag: value for tag, value in given.items() if value}
    if nonzero and not ("damping" in nonzero or "friction" in nonzero):
        nonzero = {"damping": 0.0, **nonzero}  # PyBullet rejects an element with springs only
    if nonzero:
        xml = element(axis, "dynamics")
        for tag, value in nonzero.items():
            element(xml, tag, value)
