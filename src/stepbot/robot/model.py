"""The robot that every writer writes and every engine is compared with: plain data, SI, independent of formats.

The frame of a link is the frame of the joint above it; the root link's is the base. All ``X_*`` are poses at q = 0, in
the notation of :mod:`stepbot.geometry.spatial`.
"""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from functools import cached_property
from math import inf

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.poses import Poses
from stepbot.geometry.primitives import Box as Box  # noqa: PLC0414
from stepbot.geometry.primitives import Capsule as Capsule  # noqa: PLC0414
from stepbot.geometry.primitives import Cylinder as Cylinder  # noqa: PLC0414
from stepbot.geometry.primitives import Primitive
from stepbot.geometry.primitives import Sphere as Sphere  # noqa: PLC0414
from stepbot.geometry.spatial import IDENTITY, Pose, Vector3

from .joint_types import JointKind as JointKind  # noqa: PLC0414
from .metadata import NO_METADATA, Metadata
from .motors import Motor
from .self_collision import SelfCollision
from .sensors import Sensor
from .surfaces import PLAIN, Surface
from .tuning import DEFAULTS, Simulation, Tuning

SECOND_AXIS: Vector3 = (1.0, 0.0, 0.0)
"""Of a universal joint, if nothing states another."""


class Base(StrEnum):
    """Whether the root link is fixed to the world."""

    FIXED = "fixed"
    FLOATING = "floating"


class MeshFormat(StrEnum):
    """The format of mesh files; the value is their suffix."""

    OBJ = "obj"
    STL = "stl"
    DAE = "dae"
    GLB = "glb"


class MeshFormats(Struct, frozen=True):
    """The formats of a robot's mesh files."""

    visual: MeshFormat = MeshFormat.OBJ
    collision: MeshFormat = MeshFormat.OBJ
    is_chosen: bool = False
    """Whether the user has chosen the format of visual meshes, so that no target may prefer another one."""


class FormatVersions(Struct, frozen=True):
    """The versions of formats to write; each default is what today's readers of the format read."""

    urdf: float = 1.0
    """1.1 has quaternions and capsules, 1.2 also limits of acceleration and jerk."""
    mjcf: float = 3.7
    """The oldest MuJoCo that reads it: 3.3 has no contact sensors, intervals of sensors and damping of actuators."""


class MeshRef(Struct, frozen=True):
    """One of the robot's mesh assets, scale 1."""

    name: str
    """Name of the asset in :attr:`Robot.meshes`."""


Geometry = Primitive | MeshRef


class MeshAsset(Struct, frozen=True, eq=False, weakref=True):
    """A mesh that is written once and referred to by name; :mod:`.mesh_files` has its files."""

    name: str
    """Unique among the robot's assets, valid as a file name and as a name in every format."""
    mesh: TriMesh
    source: str = ""
    """Path of the component that it was first made for, or name of the link whose meshes it merges."""


Rgba = tuple[float, float, float, float]
"""Colour and opacity, each 0 to 1, sRGB as CAD programs show it."""
GREY: Rgba = (0.8, 0.8, 0.8, 1.0)
"""Colour of what has none."""


class Visual(Struct, frozen=True):
    """A visual of a link."""

    name: str
    """Unique in the robot."""
    geometry: Geometry
    X_LG: Pose = IDENTITY
    """Pose of the geometry in the link."""
    rgba: Rgba = GREY
    component: str = ""
    """Path of the component that it shows; empty without an assembly."""


class Collision(Struct, frozen=True):
    """A collision of a link."""

    name: str
    """Unique in the robot."""
    geometry: Geometry
    X_LG: Pose = IDENTITY
    """Pose of the geometry in the link."""
    surface: Surface = PLAIN


def _by_geometry(shapes: "Sequence[Visual | Collision]") -> Mapping[Geometry, Poses]:
    poses: dict[Geometry, list[Pose]] = {}
    for shape in shapes:
        poses.setdefault(shape.geometry, []).append(shape.X_LG)
    return {geometry: Poses.of(X_LG) for geometry, X_LG in poses.items()}


class ComponentMass(Struct, frozen=True):
    """The mass of one component and its source."""

    component: str
    """Path of the component in the assembly; empty for a mass that is given for a whole link."""
    mass: float | None
    """Mass [kg]; None if no source gives a mass or a density. Known in a robot that was built without errors."""
    density: float | None
    """Density [kg/m^3] that the mass was computed with; None if the mass is given or unknown."""
    volume: float | None
    """Volume [m^3]; None for a mass that is given for a whole link."""
    origin: str
    """For messages: ``parts rule '**/M3*'``, ``STEP``, ``defaults``, ``inertial``; empty if the mass is unknown."""
    method: str
    """``mesh`` or ``exact``: the source of volume, com and inertia; ``given`` for neither."""
    material: str = ""
    """The material whose density this is, in the sidecar or the STEP; empty if none is named."""


class Link(Struct, frozen=True, dict=True):
    """A rigid body."""

    name: str
    mass_properties: MassProperties = field(default_factory=MassProperties)
    """In the link's frame."""
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()
    masses: tuple[ComponentMass, ...] = ()
    """Mass of each component that adds to the link's."""
    components: tuple[str, ...] = ()
    """Paths of the link's components in the assembly."""

    @property
    def shapes(self) -> "tuple[Visual | Collision, ...]":
        """All visuals, then all collisions."""
        return (*self.visuals, *self.collisions)

    @cached_property
    def visual_poses(self) -> Mapping[Geometry, Poses]:
        """Each geometry of a visual, and where it is in the link."""
        return _by_geometry(self.visuals)

    @cached_property
    def collision_poses(self) -> Mapping[Geometry, Poses]:
        """Each geometry of a collision, and where it is in the link."""
        return _by_geometry(self.collisions)


class Limit(Struct, frozen=True):
    """Bounds of a joint's position, velocity, effort, acceleration and jerk; infinite if there is none."""

    lower: float = -inf
    """[rad] or [m]."""
    upper: float = inf
    """[rad] or [m]."""
    velocity: float = inf
    """[rad/s] or [m/s]."""
    effort: float = inf
    """[N m] or [N]."""
    acceleration: float = inf
    """[rad/s^2] or [m/s^2]."""
    deceleration: float = inf
    """[rad/s^2] or [m/s^2]; infinite if it is that of the acceleration."""
    jerk: float = inf
    """[rad/s^3] or [m/s^3]."""

    def without_beyond(self, position: float, rate: float = inf) -> "Limit":
        """Without bounds that stand for none: positions, and velocities and efforts, from one size on."""
        return replace(
            self,
            lower=-inf if self.lower <= -position else self.lower,
            upper=inf if self.upper >= position else self.upper,
            velocity=inf if self.velocity >= rate else self.velocity,
            effort=inf if self.effort >= rate else self.effort,
        )

    @property
    def is_smooth(self) -> bool:
        """Whether acceleration, deceleration or jerk is limited."""
        return min(self.acceleration, self.deceleration, self.jerk) < inf


class JointDynamics(Struct, frozen=True):
    """Passive forces of a joint."""

    damping: float = 0.0
    """Viscous damping [N m s/rad] or [N s/m]."""
    friction: float = 0.0
    """Coulomb friction [N m] or [N]."""
    stiffness: float = 0.0
    """Spring rate [N m/rad] or [N/m]."""
    spring_reference: float = 0.0
    """Rest position [rad] or [m] of the spring."""
    armature: float = 0.0
    """Inertia [kg m^2] or mass [kg] of the actuator, reflected to the joint."""


class Mimic(Struct, frozen=True):
    """q = multiplier * q_leader + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0
    """[rad] or [m]."""


class Joint(Struct, frozen=True):
    """A joint of the tree; its frame at q = 0 is the frame of its child link."""

    name: str
    kind: JointKind
    parent: str
    child: str
    X_PC: Pose = IDENTITY
    """Pose of the child link in the parent link at q = 0."""
    axis: Vector3 = (0.0, 0.0, 1.0)
    """Unit axis in the joint's frame, axis_C; the normal of a planar joint."""
    axis2: Vector3 = SECOND_AXIS
    """Second axis of a universal joint, in the joint's frame."""
    limit: Limit = Limit()
    dynamics: JointDynamics = JointDynamics()
    mimic: Mimic | None = None
    pitch: float = 0.0
    """Advance of a screw joint [m/rad]."""
    drawn_position: float = 0.0
    """q [rad] or [m] of the joint as drawn in the CAD, its ``zero``; the initial pose."""


class LoopClosure(Struct, frozen=True):
    """A joint that closes a loop: the two F frames coincide up to the degrees of freedom of its kind."""

    name: str
    kind: JointKind
    link_a: str
    X_AF: Pose
    link_b: str
    X_BF: Pose
    axis: Vector3 = (0.0, 0.0, 1.0)
    """Unit axis of a revolute or prismatic closure, in F."""


class Frame(Struct, frozen=True):
    """A named frame on a link: a tool centre point, a mounting flange."""

    name: str
    link: str
    X_LF: Pose = IDENTITY
    source: str = ""
    """How it was found, for messages."""


class ActuatorKind(StrEnum):
    """The meaning of an actuator's input."""

    POSITION = "position"
    VELOCITY = "velocity"
    MOTOR = "motor"


class Actuator(Struct, frozen=True):
    """An actuator on a joint."""

    name: str
    joint: str
    kind: ActuatorKind
    kp: float = 0.0
    """Position gain [N m/rad] or [N/m]."""
    kv: float = 0.0
    """Velocity gain [N m s/rad] or [N s/m]."""
    gear: float = 1.0
    """Motor position / joint position."""
    limit: Limit = Limit()
    """Its own bounds, at the joint, in addition to those of the joint."""
    tuning: Tuning | None = None
    """How its gains are computed; None if they are given."""
    motor: Motor | None = None
    """The motor of the catalogue whose figures it has; None if it is not known."""


class Module(Struct, frozen=True):
    """A robot that is a part of another one."""

    name: str
    """Its name in the composing robot; a path for a module of a module: ``arm/hand``."""
    file: str
    """Name of the file that it comes from."""
    prefix: str
    """Text in front of all its names."""
    links: tuple[str, ...]
    """Its links in the composing robot, the root first."""
    at: str = ""
    """The link that it is fixed to; empty for the root, and below a joint of the composing robot."""
    mirror: str = ""
    """Normals of the planes of its root link's frame that it is mirrored through: x, y or z; two for the image of an
    image; empty if it is not."""
    gains_alone: tuple[tuple[str, float, float], ...] = ()
    """Name, kp and kv of each actuator whose gains are computed, as they are where the module is a robot alone; those
    of a module of a module are with the module that contains it."""


class Robot(Struct, frozen=True, dict=True, weakref=True):
    """A robot: a tree of links and joints, and the closures that form its loops."""

    name: str
    links: tuple[Link, ...]
    """The root first, each parent before its children."""
    joints: tuple[Joint, ...] = ()
    """In the order of their children in ``links``."""
    closures: tuple[LoopClosure, ...] = ()
    frames: tuple[Frame, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    meshes: tuple[MeshAsset, ...] = ()
    """Sorted by name."""
    base: Base = Base.FIXED
    source: str = ""
    """File name of the STEP that it was built from."""
    sensors: tuple[Sensor, ...] = ()
    simulation: Simulation = DEFAULTS
    """Settings that the sidecar gives for simulations; :func:`.simulation_settings.settings_of` has the defaults."""
    excluded_contacts: tuple[tuple[str, str], ...] = ()
    """Pairs of links that are not adjacent whose contacts the source excludes; each sorted, and all."""
    self_collision: SelfCollision | None = None
    """Which links can overlap, if that was searched."""
    metadata: Metadata = NO_METADATA
    """Maintainer and licence, for packages."""
    mesh_formats: MeshFormats = MeshFormats()
    """The formats of mesh files, for formats that have such files."""
    versions: FormatVersions = FormatVersions()
    """The versions of formats to write, for formats that have several."""
    modules: tuple[Module, ...] = ()
    """The robots that it is composed of, modules of modules after them; empty for a robot that is described alone."""

    @property
    def root(self) -> Link:
        """The link without a parent joint."""
        return self.links[0]

    @cached_property
    def link_by_name(self) -> dict[str, Link]:
        """Links by name."""
        return {link.name: link for link in self.links}

    @cached_property
    def joint_by_name(self) -> dict[str, Joint]:
        """Joints by name."""
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def distinct_shapes(self) -> "tuple[Visual | Collision, ...]":
        """One visual for each geometry and colour, then one collision shape for each geometry: the first of each."""
        first: dict[object, Visual | Collision] = {}
        for link in self.links:
            for visual in link.visuals:
                first.setdefault((visual.geometry, visual.rgba), visual)
        for link in self.links:
            for collision in link.collisions:
                first.setdefault(collision.geometry, collision)
        return tuple(first.values())

    @cached_property
    def mesh_by_name(self) -> dict[str, MeshAsset]:
        """Mesh assets by name."""
        return {asset.name: asset for asset in self.meshes}
