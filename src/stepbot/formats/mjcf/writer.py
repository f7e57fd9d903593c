"""MJCF, MuJoCo's own format: https://mujoco.readthedocs.io/en/stable/XMLreference.html.

Joints are at the origin of their body, so a body's frame is its link's, and q = 0 is the pose that the file describes.
A body may have several joints, which act one after the other: this is how multi-dof joints are written.
"""

from math import isfinite, isinf
from pathlib import PurePosixPath

import numpy as np

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.predicates import is_flat
from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.mesh_files import MeshFile, MeshFiles
from stepbot.robot.mesh_names import SCOPE, free_name
from stepbot.robot.model import (
    Base,
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
from stepbot.robot.multi_dof import steps_by_child
from stepbot.robot.sensors import SensorKind
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.tuning import Integrator

from ..features import USUAL, Feature, altered, exact, lowered, refused, reported
from ..format import Companion
from ..lowering.shapes import look, upright
from ..xml import Element, Patterns, Value, document, element, root
from . import FORMAT, constraints, contacts, devices
from .devices import MARK, NEW, mjcf_pose
from .scene import keyframe, scene

EXPRESSES = {
    **USUAL,
    Feature.FIXED_BASE: exact("child body of the world without a joint"),
    Feature.FLOATING_BASE: exact("`<freejoint>`, standing on z = 0"),
    Feature.INERTIA: exact("`<inertial>` with `fullinertia`"),
    Feature.MASSLESS: exact("`<inertial>` with a mass of 0"),
    Feature.MASSLESS_BODY: lowered("moving bodies without mass get 2e-15 kg, as MuJoCo requires some"),
    Feature.MESH: exact("OBJ in metres, path relative to the file"),
    Feature.STL_VISUAL: exact("as OBJ"),
    Feature.DAE_VISUAL: lowered("MuJoCo does not read COLLADA; visual meshes are OBJ"),
    Feature.GLB_VISUAL: lowered("MuJoCo does not read glTF; visual meshes are OBJ"),
    Feature.STL_COLLISION: exact("as OBJ"),
    Feature.SHAPE: exact("`box`, `cylinder`, `sphere`"),
    Feature.CAPSULE: exact("`capsule`"),
    Feature.FLAT_COLLISION: reported("MuJoCo cannot build the convex hull of a flat collision mesh; omitted"),
    Feature.CONCAVE_COLLISION: reported("MuJoCo collides with the convex hull of these meshes"),
    Feature.COLOR: exact("`rgba`"),
    Feature.NEIGHBOURS: exact("`<exclude>` for links connected by a joint or closure"),
    Feature.EXCLUDED_CONTACT: exact("`<exclude>`"),
    Feature.SURFACE: exact("`friction` with `priority`, so that the other shape's friction does not count"),
    Feature.SPIN: exact("`friction`, `condim` 4 or 6"),
    Feature.BOUNCE: exact("damping ratio of `solref`"),
    Feature.DEAD_BOUNCE: altered("a contact is critically damped at least, with a restitution of 0.14"),
    Feature.SOFTNESS: exact("time constant of `solref`; MuJoCo raises it to two time steps"),
    Feature.MIXED_SURFACE: exact("attributes of each geom"),
    Feature.FIXED: exact("body without a joint"),
    Feature.REVOLUTE: exact("`hinge` with `range`"),
    Feature.CONTINUOUS: exact("`hinge`"),
    Feature.PRISMATIC: exact("`slide`"),
    Feature.BALL: exact("`ball`"),
    Feature.UNIVERSAL: exact("two `hinge` in one body"),
    Feature.CYLINDRICAL: exact("`slide` and `hinge` in one body"),
    Feature.SCREW: exact("`slide` and `hinge` in one body, and an `<equality>` of the two"),
    Feature.PLANAR: exact("two `slide` and a `hinge` in one body"),
    Feature.FLOATING: exact("three `slide` and a `ball` in one body"),
    Feature.BALL_FORCE: exact("`damping`, `frictionloss`, `stiffness`"),
    Feature.FAR_LIMIT: exact("as any limit"),
    Feature.PASSIVE_LIMIT: exact("as any limit"),
    Feature.OPEN_POSITION: exact("infinite `range`, or no `range`"),
    Feature.OPEN_EFFORT: exact("no attribute"),
    Feature.EFFORT: exact("`actuatorfrcrange`, `forcerange`"),
    Feature.VELOCITY: lowered(
        "velocity limits are `<numeric>` data, which MuJoCo does not enforce; kv of a position actuator, up to effort "
        "/ velocity limit, is damping that its force range does not cut off (in 3.3 only in loops and with mimics)"
    ),
    Feature.FRICTION: exact("`damping`, `frictionloss`"),
    Feature.SPRING: exact("`stiffness`, `springref`"),
    Feature.ARMATURE: exact("`armature`"),
    Feature.STIFF_DAMPING: exact("as any damping"),
    Feature.MIMIC: exact("`<equality>` of two joints"),
    Feature.MIMIC_CHAIN: exact("`<equality>` of two joints"),
    Feature.MIXED_MIMIC: exact("`<equality>` of two joints"),
    Feature.CLOSURE: exact("`<equality>`: two `connect`, one `connect`, `weld`"),
    Feature.SLIDING_CLOSURE: lowered("no equality constraint allows sliding; the loops are cut at another joint"),
    Feature.STUCK_CLOSURE: refused("no equality constraint allows sliding, and the loop has no unlimited passive pin"),
    Feature.FOLLOWER: exact("held by the closure"),
    Feature.LOOP_ZERO: exact("sites on both links, and the keyframe `home`"),
    Feature.INITIAL_POSE: exact("keyframe `home`"),
    Feature.FRAME: exact("`<site>`"),
    Feature.ACTUATOR: exact("`<position>`, `<velocity>`, `<motor>`"),
    Feature.SECOND_ACTUATOR: exact("as any actuator"),
    Feature.GEAR: exact("`gear`"),
    Feature.ACTUATOR_INPUT: exact("`ctrlrange`"),
    Feature.UNLIMITED_ACTUATOR: exact("no attribute"),
    Feature.JOINT_SENSOR: exact("`<jointpos>`, `<jointvel>`; `<ballquat>`, `<ballangvel>`"),
    Feature.IMU: exact("`<accelerometer>`, `<gyro>`, `<framequat>` at a site"),
    Feature.FORCE_TORQUE: exact("`<force>`, `<torque>` at a site"),
    Feature.OFF_JOINT: exact("`<force>`, `<torque>` at a site"),
    Feature.CAMERA: exact("`<camera>`"),
    Feature.OPTICAL: exact("`<camera>`, which has no other frame"),
    Feature.LIDAR: exact("`<rangefinder>` at a site for each ray"),
    Feature.CONTACT: reported("contact sensors are omitted", NEW, "`<contact>` of a body"),
    Feature.SENSOR_PLACE: exact("`<site>`, `<camera>`"),
    Feature.SENSOR_RATE: reported("sensors measure in every step", NEW, "`interval`, with a buffer of one reading"),
    Feature.ENCODER_RATE: reported("sensors measure in every step", NEW, "`interval`, with a buffer of one reading"),
    Feature.CAMERA_EXTRAS: reported("MuJoCo renders on demand, with one near and one far plane for all cameras"),
    Feature.LIDAR_NEAREST: reported("`<rangefinder>` has no minimum range"),
    Feature.OPEN_VIEW: exact("no `cutoff`"),
    Feature.TIMESTEP: exact("`<option>`"),
    Feature.SOLVER: exact("`<option>`; `solref`, `solimp` of `<equality>`"),
    Feature.JOINT_NAME: exact("each element type has its own namespace"),
    Feature.FRAME_NAME: exact("each element type has its own namespace"),
    Feature.RESERVED_NAME: refused("`world` is the world body"),
}

_INTEGRATORS = {
    Integrator.IMPLICITFAST: "implicitfast",
    Integrator.IMPLICIT: "implicit",
    Integrator.EULER: "Euler",
    Integrator.RK4: "RK4",
}
_Z = (0.0, 0.0, 1.0)
_HIDDEN = 4
"""Group of sites that viewers do not draw by default: 3 to 5."""

_ROUNDING = 1e-12
"""Relative tolerance for MuJoCo's rounding of A + B >= C of principal moments that satisfy it exactly."""
_TINY = 1e-10
"""Volume [m^3] of a mesh's bounding box below which the volume of the mesh may be too small for MuJoCo."""


def reserves(name: str) -> bool:
    """Whether the name is that of MuJoCo's world body."""
    return name == "world"


def render(robot: Robot) -> bytes:
    """The MJCF of a lowered robot."""
    top = root("mujoco", robot.source, model=robot.name)
    if robot.joints or robot.sensors:
        element(top, "compiler", angle="radian")
    settings = settings_of(robot)
    friction = contacts.FRICTION if any(link.collisions for link in robot.links) else {}
    option = element(
        top, "option", timestep=settings.timestep, integrator=_INTEGRATORS[settings.integrator], **friction
    )
    if contacts.has_payload(robot):
        element(option, "flag", filterparent="disable")
    _defaults(top, robot)
    _assets(top, robot)
    _bodies(top, robot)
    contacts.excludes(top, robot)
    constraints.equality(top, robot)
    lines = constraints.motor_lines(robot)
    constraints.tendons(top, robot, lines)
    devices.actuators(top, robot, lines)
    devices.sensors(top, robot)
    _velocity_limits(top, robot)
    keyframe(top, robot)
    return document(top)


def companions(_robot: Robot) -> tuple[Companion, ...]:
    """No files beside the main one and its meshes."""
    return ()


def scenes(robot: Robot) -> dict[str, bytes]:
    """A scene with floor, light, sky and camera, which includes the robot."""
    return {f"{robot.name}{FORMAT.scene}": scene(robot, f"{robot.name}{FORMAT.suffix}")}


def _defaults(top: Element, robot: Robot) -> None:
    """Classes of geoms and equality constraints.

    Geoms are in the groups that model collections conventionally use: viewers hide the third by default.
    """
    classes: dict[str, dict[str, Value]] = {}
    if any(link.visuals for link in robot.links):
        classes["visual"] = {"group": 2, "contype": 0, "conaffinity": 0}
    if any(link.collisions for link in robot.links):
        classes["collision"] = {"group": 3, **contacts.stiffness(robot)}
    marked = bool(robot.closures) or any(sensor.kind in devices.AT_SITES for sensor in robot.sensors)
    default = element(top, "default") if classes or marked or constraints.is_constrained(robot) else top
    for name, settings in classes.items():
        element(element(default, "default", class_=name), "geom", **settings)
    if marked:
        element(element(default, "default", class_=MARK), "site", group=_HIDDEN)
    constraints.stiffness(default, robot)


def _assets(top: Element, robot: Robot) -> None:
    """Meshes; for one without volume, MuJoCo can compute the (unused) inertia only as that of a ``shell``.

    The rays of MJX, which reads older files, fail in a model without materials.
    """
    meshes = _Meshes(robot)
    has_rays = robot.versions.mjcf < NEW and any(sensor.kind is SensorKind.LIDAR for sensor in robot.sensors)
    asset = element(top, "asset") if meshes.files.all or has_rays else top
    if has_rays:
        element(asset, "material", name="plain")
    for file in meshes.files.all:
        name, mesh = meshes.name_of(file), file.asset.mesh
        optional: dict[str, Value] = {"name": name} if PurePosixPath(file.path).stem != name else {}
        if is_flat(mesh) or float(np.prod(np.ptp(mesh.bounds, axis=0))) < _TINY:
            optional["inertia"] = "shell"
        element(asset, "mesh", **optional, file=file.path)


class _Meshes:
    """The names of mesh files; with their format if the robot has two, since one mesh may have two files."""

    def __init__(self, robot: Robot) -> None:
        self.files = MeshFiles(robot)
        self._one_format = robot.mesh_formats.visual is robot.mesh_formats.collision

    def name(self, shape: Visual | Collision) -> str:
        return self.name_of(self.files.of(shape))

    def name_of(self, file: MeshFile) -> str:
        return file.stem if self._one_format else f"{file.stem}_{file.format.value}"


def _bodies(top: Element, robot: Robot) -> None:
    parents = {robot.root.name: element(top, "worldbody")}
    joint_of = {joint.child: joint for joint in robot.joints}
    names, meshes, steps, patterns = _GeomNames(), _Meshes(robot), steps_by_child(robot), Patterns()
    step = settings_of(robot).timestep
    standing = Pose.of(position=(0.0, 0.0, standing_height(robot, {})))
    for link in robot.links:
        joint = joint_of.get(link.name)
        above = parents[joint.parent] if joint else parents[robot.root.name]
        body = element(above, "body", name=link.name, **mjcf_pose(joint.X_PC if joint else standing))
        parents[link.name] = body
        _inertial(body, link.mass_properties)
        if joint is not None:
            for part in steps[link.name]:
                _joint(body, part)
        elif robot.base is Base.FLOATING:
            taken = set(robot.joint_by_name)
            element(body, "freejoint", name=free_name(f"{link.name}_floating", "_joint", taken))
        for shape in link.shapes:
            _geom(body, shape, names.of(shape.name, link.name), meshes, patterns, step)
        _sites(body, link, robot)
        devices.mounts(body, link, robot)


class _GeomNames:
    """Visuals and collisions are both geoms, and no two geoms may share a name, not even of two links."""

    def __init__(self) -> None:
        self._first: dict[str, str] = {}
        self._taken: set[str] = set()

    def of(self, name: str, link: str) -> str:
        is_first = self._first.setdefault(name, link) == link
        return free_name(name if is_first else f"{name}_{link}", "_geom", self._taken)


def _inertial(body: Element, mass: MassProperties) -> None:
    if not np.any(mass.inertia):  # MuJoCo takes neither none nor a point mass as `fullinertia`
        element(body, "inertial", pos=mass.com, mass=mass.mass or 0, diaginertia=(0.0, 0.0, 0.0))
        return
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = mass.inertia
    A, B, C = np.linalg.eigvalsh(np.array(mass.inertia)).tolist()
    if abs(A + B - C) < _ROUNDING * C:
        # A flat body has A + B = C; MuJoCo recomputes the moments and rejects the body if rounding makes C larger.
        ixx, iyy, izz = (moment + _ROUNDING * C for moment in (ixx, iyy, izz))
    element(body, "inertial", pos=mass.com, mass=mass.mass, fullinertia=(ixx, iyy, izz, ixy, ixz, iyz))


def _joint(body: Element, joint: Joint) -> None:
    if joint.kind is JointKind.FIXED:
        return
    optional: dict[str, Value] = {}
    limit, dynamics = joint.limit, joint.dynamics
    if joint.kind is not JointKind.CONTINUOUS and not (isinf(limit.lower) and isinf(limit.upper)):
        optional["range"] = (limit.lower, limit.upper)
    if isfinite(limit.effort):
        optional["actuatorfrcrange"] = (-limit.effort, limit.effort)
    given = {
        "damping": dynamics.damping,
        "frictionloss": dynamics.friction,
        "stiffness": dynamics.stiffness,
        "springref": dynamics.spring_reference,
        "armature": dynamics.armature,
    }
    optional.update({name: value for name, value in given.items() if value})
    if joint.kind is not JointKind.BALL and joint.axis != _Z:
        optional = {"axis": joint.axis, **optional}
    kind = {JointKind.PRISMATIC: "slide", JointKind.BALL: "ball"}.get(joint.kind)
    element(body, "joint", name=joint.name, **({"type": kind} if kind else {}), **optional)


def _geom(body: Element, shape: Visual | Collision, name: str, meshes: _Meshes, patterns: Patterns, dt: float) -> None:
    X = upright(shape)

    def make(parent: Element, name: str, position: str) -> Element:
        class_, finish = "visual", dict[str, Value]()
        if isinstance(shape, Visual):
            finish = {"rgba": shape.rgba}
        else:
            class_, finish = "collision", contacts.surface(shape.surface, dt)
        kind, size = _geometry(shape, meshes)
        type_: dict[str, Value] = {"type": kind} if kind != "sphere" else {}
        place = mjcf_pose(X)
        if "pos" in place:
            place["pos"] = position
        return element(parent, "geom", name=name, class_=class_, **type_, **size, **place, **finish)

    patterns.add(body, look(shape), make, name, X.position)


def _geometry(shape: Visual | Collision, meshes: _Meshes) -> tuple[str, dict[str, Value]]:
    """Type and size of a geom; MuJoCo uses half lengths."""
    match shape.geometry:
        case Box(size):
            return "box", {"size": [edge / 2 for edge in size]}
        case Cylinder(radius, length):
            return "cylinder", {"size": (radius, length / 2)}
        case Capsule(radius, length):
            return "capsule", {"size": (radius, length / 2)}
        case Sphere(radius):
            return "sphere", {"size": (radius,)}
        case MeshRef():
            return "mesh", {"mesh": meshes.name(shape)}


def _sites(body: Element, link: Link, robot: Robot) -> None:
    for frame in robot.frames:
        if frame.link == link.name:
            element(body, "site", name=frame.name, **mjcf_pose(frame.X_LF))
    constraints.closure_sites(body, link, robot)


def _velocity_limits(top: Element, robot: Robot) -> None:
    limited = [j for j in robot.joints if j.kind is not JointKind.FIXED and isfinite(j.limit.velocity)]
    if limited:
        custom = element(top, "custom")
        for joint in limited:
            element(custom, "numeric", name=f"{joint.name}{SCOPE}velocity", data=joint.limit.velocity)
