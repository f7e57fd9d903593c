"""What is mounted on links and joints: frames, drives and sensors."""

from stepbot.robot.model import ActuatorKind
from stepbot.robot.sensors import SensorKind

from .motion import LimitsSection
from .origins import Origin
from .quantities import (
    Count,
    DistanceRange,
    FieldOfView,
    Frequency,
    JointDamping,
    JointStiffness,
    JointValue,
    Number,
    Resolution,
)
from .section import Name, Section


class FrameSection(Section):
    """A named frame on a link."""

    link: Name
    """The link that it is fixed to."""
    origin: Origin
    """Where it is; `auto` cannot be, since there is no second link."""


class ActuatorSection(Section):
    """A drive on a joint."""

    joint: Name
    """The joint that it drives."""
    kind: ActuatorKind = ActuatorKind.MOTOR
    """What its input is: a position, a velocity, or (motor) an effort."""
    kp: JointStiffness = JointValue(0.0)
    """Position gain [N m/rad or N/m]."""
    kv: JointDamping = JointValue(0.0)
    """Velocity gain [N m s/rad or N s/m]."""
    gear: Number = 1.0
    """How many times the joint's position the drive's is; `kp`, `kv` and the input count at the drive."""
    limits: LimitsSection = LimitsSection()
    """Bounds of its own, at the joint, beside those of the joint."""


class SensorSection(Section):
    """A sensor on a link or a joint."""

    type: SensorKind
    """What it measures."""
    link: Name | None = None
    """The link that it is mounted on."""
    joint: Name | None = None
    """The joint that it measures."""
    origin: Origin | None = None
    """Where it is, x ahead and z up; the link's or joint's frame when left out."""
    rate: Frequency = 0.0
    """Measurements per second [Hz]; one in every step of a simulation when left out."""
    fov: FieldOfView | None = None
    """Horizontal field of view [rad]: of a camera, 60 deg when left out; of a lidar, 360 deg."""
    resolution: Resolution | None = None
    """Pixels of a camera, [width, height]; [640, 480] when left out."""
    samples: Count | None = None
    """Rays of a lidar, spread evenly over its field of view, edges included; 360 when left out."""
    range: DistanceRange | None = None
    """Shortest and longest distance [m] that a camera or a lidar sees; no bounds when left out."""
