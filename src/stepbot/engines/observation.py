"""What an engine reports about a file, in one form for all engines, so that one comparison serves them all.

Quantities are SI. Centre of mass and inertia are in the link's frame, as the file defines it, joint axes in the child's
frame, poses of links relative to the root link. A quantity that an engine does not report is ``None``, with the reason
in ``not_run``.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from enum import StrEnum
from itertools import chain, repeat

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace
from numpy.typing import NDArray

from stepbot.geometry.spatial import ZERO3, Matrix3, Pose, Vector3, vector3
from stepbot.robot.dynamics import Rates
from stepbot.robot.model import JointDynamics, JointKind, Limit, LoopClosure, Mimic
from stepbot.robot.surfaces import Surface


class Quantity(StrEnum):
    """The compared quantities, in the order of the report."""

    LOAD = "load"
    LINKS = "links"
    JOINTS = "joints"
    AXES = "axes"
    LIMITS = "limits"
    DYNAMICS = "dynamics"
    MIMIC = "mimic"
    MASS = "mass"
    COM = "com"
    INERTIA = "inertia"
    GRAVITY_SETTINGS = "gravity"
    POSES = "poses"
    MASS_MATRIX = "mass matrix"
    GRAVITY = "gravity forces"
    INVERSE_DYNAMICS = "inverse dynamics"
    CLOSURES = "closures"
    MESHES = "meshes"
    SHAPES = "shapes"
    CONTACTS = "contacts"
    FRAMES = "frames"
    ACTUATORS = "actuators"
    SENSORS = "sensors"
    INITIAL = "initial pose"
    TEXT = "text"
    SELF_COLLISION = "self-collision"
    SIMULATION = "simulation"
    WARNINGS = "warnings"


OBLIQUE = Pose.from_xyz_rpy(ZERO3, (0.7, -0.4, 1.1))
"""A frame that is turned about no axis of symmetry of anything."""


class ObservedShape(Struct, frozen=True):
    """One visual or collision of a link; None if not reported."""

    name: str | None = None
    """Empty if the file gives none."""
    rgba: tuple[float, ...] | None = None
    """Red, green, blue, opacity, in [0, 1]; empty if the file gives none."""
    ambient: tuple[float, ...] | None = None
    """The ambient colour, likewise; SDFormat only."""
    bounds: tuple[Vector3, Vector3] | None = None
    """Lowest and highest corner [m] in the link's frame."""
    oblique: tuple[Vector3, Vector3] | None = None
    """The same along the axes of :data:`OBLIQUE`: a shape that is turned or mirrored may fill the same upright box."""
    groups: tuple[int, ...] | None = None
    """MJCF only: the group that viewers show and hide together, by convention 2 for visuals and 3 for collisions; the
    bits of what a shape is to others, and of what it collides with."""
    surface: Surface | None = None
    """Contact properties of a collision; those that the engine does not report are None."""
    surface_default: Surface | None = None
    """What the engine reports for a shape without contact properties."""
    rgba_is_default: bool = False
    """Whether the engine reports its `rgba` for a shape without one, too."""


class ObservedLink(Struct, frozen=True):
    """A link as reported by an engine; None if not reported."""

    name: str
    mass: float | None = None
    """[kg]."""
    com: Vector3 | None = None
    """[m] in the link's frame."""
    inertia: Matrix3 | None = None
    """[kg m^2] about the com, along the axes of the link's frame."""
    visual_bounds: tuple[Vector3, Vector3] | None = None
    """Lowest and highest corner [m] of all visual geometry, in the link's frame."""
    collision_bounds: tuple[Vector3, Vector3] | None = None
    """Lowest and highest corner [m] of all collision geometry, in the link's frame."""
    has_visuals: bool | None = None
    has_collisions: bool | None = None
    visuals: tuple[ObservedShape, ...] | None = None
    """Each visual of the link, in the order of the file."""
    collisions: tuple[ObservedShape, ...] | None = None
    """Each collision of the link, in the order of the file."""
    gravity_compensation: float | None = None
    """Share of the weight that the file takes away: 1 where gravity does not act on the link."""


NEVER_ZERO = ("velocity", "effort", "acceleration", "deceleration", "jerk")
"""Limits at which, if they are 0, nothing moves: files state them for want of a number, and readers ignore them."""


class ObservedJoint(Struct, frozen=True):
    """A joint as reported by an engine; None if not reported."""

    name: str
    """Empty if the engine keeps no name: MuJoCo's fixed joints."""
    kind: str
    """A :class:`.JointKind` value, or the engine's own word for other types.

    An engine that does not distinguish continuous from revolute reports a revolute joint without limits as
    ``continuous``.
    """
    parent: str
    child: str
    axis: Vector3 | None = None
    """Unit axis in the child's frame; None for joints without one."""
    axis2: Vector3 | None = None
    """Second axis of a universal joint, in the child's frame."""
    anchor: Vector3 = ZERO3
    """Position of the joint [m] in the child's frame: zero in URDF; MJCF and SDFormat allow others."""
    pitch: float | None = None
    """Advance [m/rad] of a screw joint."""
    limit: Limit | None = None
    """Infinite entries if the file sets no limit."""
    limit_fields: tuple[str, ...] = ("lower", "upper", "velocity", "effort")
    """The entries of ``limit`` that the engine reads."""
    dynamics: JointDynamics | None = None
    dynamics_fields: tuple[str, ...] = ("damping", "friction")
    """The entries of ``dynamics`` that the engine reads."""
    mimic: Mimic | None = None
    mimic_read: bool = False
    """Whether the engine reports mimics."""
    steps: "tuple[ObservedJoint, ...]" = ()
    """The component joints, if the file represents this joint by several in one body."""


class Dynamics(Struct, frozen=True, eq=False):
    """The equations of motion at one configuration, for the joints in :attr:`Observation.coordinates`."""

    mass_matrix: NDArray[np.float64] | None = None
    """Shape (n, n) [kg, kg m, kg m^2]; joints only, without the base's six, and without armature."""
    gravity: NDArray[np.float64] | None = None
    """Shape (n,) [N or N m]: the effort that holds the mechanism at rest against :data:`.dynamics.GRAVITY`."""
    inverse: NDArray[np.float64] | None = None
    """Shape (n,) [N or N m]: the effort for the speeds and accelerations of :attr:`Request.rates`."""


class ObservedClosure(Struct, frozen=True, eq=False):
    """A closure as reported by an engine or parser."""

    name: str
    kind: str
    link_a: str
    link_b: str
    X_AF: Pose | None = None
    X_BF: Pose | None = None
    axis: Vector3 | None = None
    points: tuple[Vector3, Vector3] | None = None
    """The point [m] of each link that the closure makes coincide, in the frames of the links."""
    axes: tuple[Vector3, Vector3] | None = None
    """The direction of each link that the closure makes parallel; None if it constrains no direction."""
    residual: float | None = None
    """Largest gap [m] of the closure over the mechanism's range."""
    angle_error: float | None = None
    """Largest deviation [rad or m] of the engine's closed configuration from the reference's, over the range."""
    sensitivity: float = 0.0
    """Largest motion [rad/m], [m/m] of the following joints per gap of the loops, over the range; in the reference."""

    @classmethod
    def of_frames(
        cls, name: str, kind: str, ends: tuple[str, str], frames: tuple[Pose, Pose], axis: Vector3 | None
    ) -> "ObservedClosure":
        """A closure given by a frame on each link.

        Args:
            kind: A :class:`stepbot.robot.model.JointKind` value, or the format's word.
            frames: X_AF and X_BF.
            axis: In the frames; None for types without one.
        """
        points = None if kind == JointKind.PRISMATIC else (frames[0].position, frames[1].position)
        axes = None if axis is None else (vector3(frames[0].turn(axis)), vector3(frames[1].turn(axis)))
        return cls(name, kind, *ends, *frames, axis, points, axes)


class ObservedActuator(Struct, frozen=True):
    """An actuator as an engine or parser reports it; bounds are infinite where there are none, None if not reported."""

    name: str
    """Empty if the format has no names for actuators."""
    joint: str
    kind: str
    """An :class:`stepbot.robot.model.ActuatorKind` value, or the engine's word for other kinds."""
    kp: float | None = 0.0
    kv: float | None = 0.0
    """Gains; None if the file gives none."""
    gear: float | None = 1.0
    """None if the format has no gears: gains and bounds are those at the joint."""
    control: tuple[float, float] | None = None
    """Lowest and highest input, at the actuator."""
    force: tuple[float, float] | None = None
    """Lowest and highest force [N m or N], at the actuator."""


class ObservedSensor(Struct, frozen=True):
    """A sensor as reported by an engine or parser; None if not reported, or not applicable to the kind."""

    name: str
    """Empty if the format has no names for such sensors."""
    kind: str
    """A :class:`stepbot.robot.sensors.SensorKind` value, or the engine's word for other kinds."""
    link: str | None = None
    joint: str | None = None
    X_LS: Pose | None = None
    rate: float | None = None
    """[Hz]; 0 for a measurement in every step."""
    fov: float | None = None
    """Horizontal field of view [rad]."""
    columns: int | None = None
    rows: int | None = None
    nearest: float | None = None
    """[m]."""
    farthest: float | None = None
    """[m]."""


class Observation(Struct, frozen=True, eq=False):
    """Everything that one engine reports about one file."""

    engine: str
    version: str
    format: str
    """Name of a :class:`stepbot.formats.format.Format`."""
    name: str | None = None
    base: str | None = None
    """``fixed`` or ``floating``; None if neither the file nor the engine determines it."""
    links: tuple[ObservedLink, ...] = ()
    joints: tuple[ObservedJoint, ...] = ()
    gravity: tuple[float, ...] | None = None
    """Acceleration of gravity [m/s^2] in the world; empty where the file leaves it to the simulator."""
    coordinates: tuple[str, ...] = ()
    """Names of the coordinates, in the order of the rows of every mass matrix: joints of one degree of freedom, or the
    coordinates of a multi-dof joint (:mod:`stepbot.robot.multi_dof`)."""
    poses: tuple[Mapping[str, Pose], ...] = ()
    """For each configuration, the pose of every link relative to the root link."""
    dynamics: tuple[Dynamics, ...] = ()
    """For each configuration, the equations of motion."""
    closures: tuple[ObservedClosure, ...] | None = None
    frames: Mapping[str, tuple[str, Pose]] | None = None
    """Frame name to link and pose in the link."""
    actuators: tuple[ObservedActuator, ...] | None = None
    sensors: tuple[ObservedSensor, ...] | None = None
    initial: Mapping[str, float] | None = None
    """The initial pose [rad], [m] in the file."""
    excluded_pairs: tuple[tuple[str, str], ...] | None = None
    """Pairs of links with collision geometry whose contacts are excluded; sorted."""
    settings: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Numbers that two files of the format are compared in, and no other quantity has, by the words for their place."""
    compiled: str = ""
    """A hash of all that the engine has made of an MJCF, file names apart: if equal, it cannot tell two files apart."""
    stated_defaults: tuple[str, ...] = ()
    """Places in an MJCF of attributes that state what the engine takes without them, of those that no model has."""
    missing_meshes: tuple[str, ...] = ()
    simulation_finite: bool | None = None
    """Whether one second of passive simulation from the initial pose stayed finite."""
    initial_penetrations: tuple[tuple[str, str], ...] = ()
    """Of one that diverged, pairs of links that overlap in the initial pose, without whose contacts it does not."""
    warnings: tuple[str, ...] = ()
    """The engine's warnings, verbatim."""
    not_run: Mapping[Quantity, str] = field(default_factory=dict)
    """Quantities that this engine does not report for this format, and why."""
    distribution: str = ""
    """Installed distribution or program that the engine comes from, if it is not the engine's name."""
    notes: tuple[str, ...] = ()
    """Changes made so that the engine can read the file: joints left out, flags."""

    def without(self, links: Set[str], base: str) -> "Observation":
        """What is reported about the other links, whose first one has this base; settings stay."""
        kept = tuple(link for link in self.links if link.name not in links)
        joints = tuple(joint for joint in self.joints if joint.child not in links)
        gone = {joint.name for joint in self.joints} - {joint.name for joint in joints}
        root = kept[0].name
        return replace(
            self,
            base=base,
            links=kept,
            joints=joints,
            poses=tuple(
                {name: X[root].inverse() @ pose for name, pose in X.items() if name not in links} for X in self.poses
            ),
            closures=self.closures
            and tuple(closure for closure in self.closures if not links & {closure.link_a, closure.link_b}),
            frames=self.frames and {name: at for name, at in self.frames.items() if at[0] not in links},
            actuators=self.actuators and tuple(actuator for actuator in self.actuators if actuator.joint not in gone),
            sensors=self.sensors
            and tuple(sensor for sensor in self.sensors if sensor.link not in links and sensor.joint not in gone),
            initial=self.initial and {name: q for name, q in self.initial.items() if name not in gone},
            excluded_pairs=self.excluded_pairs and tuple(pair for pair in self.excluded_pairs if not links & {*pair}),
        )


def sorted_pairs(pairs: Iterable[Collection[str]]) -> tuple[tuple[str, str], ...]:
    """Pairs of links as :attr:`Observation.excluded_pairs` has them."""
    return tuple(sorted((min(pair), max(pair)) for pair in pairs))


class Request(Struct, frozen=True):
    """What to observe."""

    file: str
    """Absolute path."""
    format: str
    configurations: tuple[Mapping[str, float], ...] = ()
    """Joint positions [rad] or [m]; other joints are at 0. Mimicking joints are included."""
    initial: Mapping[str, float] = field(default_factory=dict)
    """Initial pose of the passive simulation; other joints are at 0."""
    simulate: float = 1.0
    """Duration [s] of the passive simulation; 0 for none."""
    timestep: float = 1.0
    """Longest time step [s] where the file states none."""
    floating: bool = False
    """Whether the base floats in the passive simulation, if the file does not determine it."""
    closures: tuple[LoopClosure, ...] = ()
    """The loops, with their frames: expected in the file, or added by stepbot as constraints of an engine."""
    ways: tuple[tuple[Mapping[str, float], ...], ...] = ()
    """Closed configurations, solved by the reference, as paths that start at the initial pose and cover the range that
    the loops allow. The engine closes the loops itself from the driven joints and reports the deviation."""
    regular: tuple[int, ...] = ()
    """For each way, the number of configurations before the loops come near a singularity."""
    held_by_a_point: tuple[str, ...] = ()
    """Revolute closures that stepbot adds at a point alone: pins that are not exactly parallel would jam."""
    driven: tuple[str, ...] = ()
    """Joints locked to the path while an engine closes the loops; the others follow."""
    mimics: Mapping[str, Mimic] = field(default_factory=dict)
    """Mimicking joints, which stepbot adds to an engine that does not read them."""
    balls: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    """For each ball joint, including those of floating joints, its coordinates: yaw, pitch, roll."""
    universals: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """For each universal joint, its coordinates: about the first axis, about the second."""
    rates: tuple[Rates, ...] = ()
    """For each configuration, the velocities and accelerations for inverse dynamics."""
    compiled: bool = False
    """Whether to hash what the engine makes of the file, to compare it with another file of its format."""

    @property
    def closed(self) -> tuple[Mapping[str, float], ...]:
        """The configurations of all :attr:`ways`."""
        return tuple(q for way in self.ways for q in way)

    @property
    def moments(self) -> tuple[tuple[Mapping[str, float], Rates], ...]:
        """Every configuration with its rates; at rest if there are none."""
        rest: Rates = ({}, {})
        return tuple(zip(self.configurations, chain(self.rates, repeat(rest)), strict=False))


class EngineRefused(Exception):
    """The engine rejects the file; the message is the engine's own, then, after ``HELP``, what helps, if known."""

    HELP = "\nhelp: "


class EngineCannotRead(Exception):
    """The engine is known not to support such a file; this is not a fault of the file."""


def turned_as_expected(
    name: str,
    kind: str,
    ends: tuple[str, str],
    frames: tuple[Pose, Pose],
    axis: Vector3 | None,
    loops: Sequence[LoopClosure],
) -> ObservedClosure:
    """A closure with both frames turned alike, so that the first is parallel to that of the expected closure.

    A closure remains the same if both frames are turned alike and its axis is expressed in them. The frame in the
    second link, both positions and the axis show whether it is the expected one.

    Args:
        kind: A :class:`stepbot.robot.model.JointKind` value.
        frames: Its frame in both links.
        axis: In these frames; None for types without one.
        loops: The expected closures.
    """
    expected = next((loop for loop in loops if loop.name == name), None)
    if expected is None:
        return ObservedClosure.of_frames(name, kind, ends, frames, axis)
    X_expected = expected.X_AF if expected.link_a == ends[0] else expected.X_BF
    R_FE = Pose.of(frames[0].R.T @ X_expected.R)
    turned = None if axis is None else vector3(R_FE.inverse().turn(axis))
    return ObservedClosure.of_frames(name, kind, ends, (frames[0] @ R_FE, frames[1] @ R_FE), turned)
