"""What an engine sees in a file, in one form for all engines, so that one comparison serves them all.

Quantities are SI. Com and inertia are in the link's frame, as the file gives it, joint axes in the child's frame, poses
of links with respect to the root link. Whatever an engine cannot tell is ``None``, with the reason in ``not_run``.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import chain, repeat

import numpy as np
from numpy.typing import NDArray

from stepbot.geometry.spatial import ZERO3, Matrix3, Pose, Vector3, vector3
from stepbot.robot.dynamics import Rates
from stepbot.robot.model import JointDynamics, JointKind, Limit, LoopClosure, Mimic


class Quantity(StrEnum):
    """What is compared; the order is that of the report."""

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
    SELF_COLLISION = "self-collision"
    SIMULATION = "simulation"
    WARNINGS = "warnings"


@dataclass(frozen=True)
class ObservedShape:
    """One thing that is seen or touched of a link; None where the engine does not tell."""

    name: str | None = None
    """Empty where the file gives none."""
    rgba: tuple[float, ...] | None = None
    """Red, green, blue, opacity, in [0, 1]; empty where the file gives none."""
    ambient: tuple[float, ...] | None = None
    """The colour in the shade, likewise; SDFormat alone has one."""
    bounds: tuple[Vector3, Vector3] | None = None
    """Lowest and highest corner [m] in the link's frame."""
    group: int | None = None
    """Which shapes viewers show and hide together: by custom, 2 is what is seen and 3 is what is touched."""


@dataclass(frozen=True)
class ObservedLink:
    """A link as an engine sees it; None where the engine does not tell."""

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
    """Whether there is anything to see of the link."""
    has_collisions: bool | None = None
    """Whether there is anything to touch of the link."""
    visuals: tuple[ObservedShape, ...] | None = None
    """What is seen of the link, one by one, in the order of the file."""
    collisions: tuple[ObservedShape, ...] | None = None
    """What is touched of the link, one by one, in the order of the file."""


@dataclass(frozen=True)
class ObservedJoint:
    """A joint as an engine sees it; None where the engine does not tell."""

    name: str
    """Empty where the engine knows no name: MuJoCo's fixed joints."""
    kind: str
    """A :class:`.JointKind` value, or the engine's own word for anything else. An engine that cannot tell
    continuous from revolute reports a revolute joint without limits as ``continuous``."""
    parent: str
    child: str
    axis: Vector3 | None = None
    """Unit axis in the child's frame; None for joints without one."""
    axis2: Vector3 | None = None
    """Second axis of a universal joint, in the child's frame."""
    anchor: Vector3 = ZERO3
    """Where the joint is [m] in the child's frame: at its origin, but for MJCF, which may put it elsewhere."""
    pitch: float | None = None
    """Advance [m/rad] of a screw joint."""
    limit: Limit | None = None
    """Infinite entries where the file sets no limit."""
    limit_fields: tuple[str, ...] = ("lower", "upper", "velocity", "effort")
    """Which entries of ``limit`` the engine reads."""
    dynamics: JointDynamics | None = None
    dynamics_fields: tuple[str, ...] = ("damping", "friction")
    """Which entries of ``dynamics`` the engine reads."""
    mimic: Mimic | None = None
    mimic_read: bool = False
    """Whether the engine tells about mimics at all."""
    steps: "tuple[ObservedJoint, ...]" = ()
    """The joints by which the file says this one, where it says it by several in one body."""


@dataclass(frozen=True, eq=False)
class Dynamics:
    """The equations of motion at one configuration, for the joints named in :attr:`Observation.coordinates`."""

    mass_matrix: NDArray[np.float64] | None = None
    """Shape (n, n) [kg, kg m, kg m^2]; joints only, without the base's six, and without armature."""
    gravity: NDArray[np.float64] | None = None
    """Shape (n,) [N or N m]: the effort that holds the mechanism still against :data:`.dynamics.GRAVITY`."""
    inverse: NDArray[np.float64] | None = None
    """Shape (n,) [N or N m]: the effort that moves it with the speeds and accelerations of :attr:`Request.rates`."""


@dataclass(frozen=True, eq=False)
class ObservedClosure:
    """A closure as an engine or parser sees it."""

    name: str
    kind: str
    link_a: str
    link_b: str
    X_AF: Pose | None = None
    X_BF: Pose | None = None
    axis: Vector3 | None = None
    points: tuple[Vector3, Vector3] | None = None
    """The point [m] of either link that is held on that of the other, in the frames of the links."""
    axes: tuple[Vector3, Vector3] | None = None
    """The direction of either link that is held along that of the other; None where none is held."""
    residual: float | None = None
    """Worst distance [m] over the mechanism's range between what the closure holds together."""
    angle_error: float | None = None
    """Worst deviation [rad or m] over the range of the engine's closed configuration from the reference's."""

    @classmethod
    def of_frames(
        cls, name: str, kind: str, ends: tuple[str, str], frames: tuple[Pose, Pose], axis: Vector3 | None
    ) -> "ObservedClosure":
        """A closure that is given by a frame on either link.

        Args:
            name: Its name.
            kind: A :class:`stepbot.robot.model.JointKind` value, or the format's word.
            ends: The links.
            frames: X_AF and X_BF.
            axis: In the frames; None for kinds that hold none.
        """
        points = None if kind == JointKind.PRISMATIC else (frames[0].position, frames[1].position)
        axes = None if axis is None else (vector3(frames[0].turn(axis)), vector3(frames[1].turn(axis)))
        return cls(name, kind, *ends, *frames, axis, points, axes)


@dataclass(frozen=True)
class ObservedActuator:
    """An actuator as an engine or parser reports it; bounds are infinite where there are none, None if not reported."""

    name: str
    """Empty where the format has no names for actuators."""
    joint: str
    kind: str
    """An :class:`stepbot.robot.model.ActuatorKind` value, or other words for anything else."""
    kp: float = 0.0
    kv: float = 0.0
    gear: float | None = 1.0
    """None where the format has no gears: gains and bounds are those at the joint."""
    control: tuple[float, float] | None = None
    """Lowest and highest input, at the actuator."""
    force: tuple[float, float] | None = None
    """Lowest and highest force [N m or N], at the actuator."""


@dataclass(frozen=True)
class ObservedSensor:
    """A sensor as an engine or parser reports it; None if not reported, or if the kind of sensor has none."""

    name: str
    """Empty where the format has no names for such sensors."""
    kind: str
    """A :class:`stepbot.robot.sensors.SensorKind` value, or the engine's own words for anything else."""
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


@dataclass(frozen=True, eq=False)
class Observation:
    """All that one engine sees in one file."""

    engine: str
    version: str
    format: str
    """``urdf``, ``sdf`` or ``mjcf``."""
    name: str | None = None
    """What the robot is called."""
    base: str | None = None
    """``fixed`` or ``floating``; None where neither the file nor the engine says."""
    links: tuple[ObservedLink, ...] = ()
    joints: tuple[ObservedJoint, ...] = ()
    coordinates: tuple[str, ...] = ()
    """Names of the coordinates, in the order of the rows of every mass matrix: joints of one freedom, or those that
    stand for a joint of several (:mod:`stepbot.robot.multi_dof`)."""
    poses: tuple[Mapping[str, Pose], ...] = ()
    """For each configuration the pose of every link with respect to the root link."""
    dynamics: tuple[Dynamics, ...] = ()
    """For each configuration the equations of motion."""
    closures: tuple[ObservedClosure, ...] | None = None
    frames: Mapping[str, tuple[str, Pose]] | None = None
    """Frame name to link and pose in the link."""
    actuators: tuple[ObservedActuator, ...] | None = None
    sensors: tuple[ObservedSensor, ...] | None = None
    initial: Mapping[str, float] | None = None
    """The pose [rad], [m] in which the file says that the robot starts."""
    excluded_pairs: tuple[tuple[str, str], ...] | None = None
    """Pairs of links that have something to touch with, and never touch each other; sorted."""
    missing_meshes: tuple[str, ...] = ()
    simulation_finite: bool | None = None
    """Whether one second of passive simulation from the initial pose stayed finite."""
    warnings: tuple[str, ...] = ()
    """What the engine complained about, word for word."""
    not_run: Mapping[Quantity, str] = field(default_factory=dict)
    """Quantities that this engine does not tell of in this format, and why."""
    notes: tuple[str, ...] = ()
    """What was changed for the engine to read the file: joints left out, flags."""


@dataclass(frozen=True)
class Request:
    """What to observe."""

    file: str
    """Absolute path."""
    format: str
    configurations: tuple[Mapping[str, float], ...] = ()
    """Joint positions [rad] or [m]; joints that are not named are at 0. Mimicking joints are named too."""
    initial: Mapping[str, float] = field(default_factory=dict)
    """Where the passive simulation starts; joints that are not named are at 0."""
    simulate: float = 1.0
    """Seconds of passive simulation; 0 for none."""
    floating: bool = False
    """Whether the passive simulation lets the base go, where the file does not say."""
    closures: tuple[LoopClosure, ...] = ()
    """The loops, with their frames: what a file must hold, or what an engine needs to stand in for it."""
    ways: tuple[tuple[Mapping[str, float], ...], ...] = ()
    """Closed configurations, solved by the reference, in ways that each start at the initial pose and lead through the
    range that the loops leave. The engine closes the loops itself from the driven joints and says how far it is off."""
    held_by_a_point: tuple[str, ...] = ()
    """Revolute closures of which an engine that stands in need hold no more than a point: more would jam a mechanism
    whose pins are not exactly parallel."""
    driven: tuple[str, ...] = ()
    """Joints that are held where a way has them while an engine closes the loops; the others follow."""
    mimics: Mapping[str, Mimic] = field(default_factory=dict)
    """Mimicking joints, for an engine that does not read them and has to stand in for them."""
    balls: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    """For each ball joint, those that are part of floating joints too, its coordinates: yaw, pitch, roll."""
    universals: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """For each universal joint its coordinates: about the first axis, about the second."""
    rates: tuple[Rates, ...] = ()
    """For each configuration the velocities and accelerations that inverse dynamics is asked for."""

    @property
    def moments(self) -> tuple[tuple[Mapping[str, float], Rates], ...]:
        """Every configuration with its rates; at rest where none are given."""
        rest: Rates = ({}, {})
        return tuple(zip(self.configurations, chain(self.rates, repeat(rest)), strict=False))


class EngineRefused(Exception):
    """An engine says that it cannot use the file; the message is the engine's own."""


class EngineCannotRead(Exception):
    """The file is none of the kind that this engine is known to read; nothing is said against the file."""
