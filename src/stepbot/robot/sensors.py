"""Sensors of a robot: IMUs, force-torque sensors, encoders, cameras, lidars, contact sensors.

The frame of a sensor has x forward and z up, as REP 103 defines for bodies: a camera looks along x, a lidar scans
around z with the centre of its range on x. A force-torque sensor measures the wrench that the parent of its joint
exerts on the child, in its own frame and about its own origin: at rest, the supporting force. Images of a camera are in
its optical frame, with z forward and x right, for which formats of ROS have a frame of its own.
"""

from enum import StrEnum
from math import inf

from msgspec import Struct

from stepbot.geometry.spatial import IDENTITY, Pose


class SensorKind(StrEnum):
    """The quantity that a sensor measures."""

    IMU = "imu"
    FORCE_TORQUE = "force_torque"
    JOINT = "joint"
    CAMERA = "camera"
    LIDAR = "lidar"
    CONTACT = "contact"


PLACED = (SensorKind.IMU, SensorKind.FORCE_TORQUE, SensorKind.CAMERA, SensorKind.LIDAR)
"""Kinds of sensors that have a frame of their own; the others measure a whole joint or link."""
SEEING = (SensorKind.CAMERA, SensorKind.LIDAR)
"""Kinds of sensors that have a field of view."""


OPTICAL = Pose.of(((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)))
"""Pose of an optical frame in its camera: z is forward, x right, y down (REP 103)."""


MOST_RAYS = 100_000
"""Largest number of rays of a lidar: MJCF has an element for each."""


class View(Struct, frozen=True):
    """The field of view of a camera or a lidar; the rays of a lidar are evenly spaced, the outermost at the edges."""

    fov: float = 0.0
    """Horizontal field of view [rad]."""
    columns: int = 0
    """Horizontal number of pixels; rays of a lidar."""
    rows: int = 0
    """Vertical number of pixels; 1 for a lidar."""
    nearest: float = 0.0
    """Minimum distance [m]; 0 without a limit."""
    farthest: float = inf
    """Maximum distance [m]; infinite without a limit."""


class Sensor(Struct, frozen=True):
    """A sensor on a link, or on the joint above a link."""

    name: str
    kind: SensorKind
    link: str
    """The link that it is mounted on; for a sensor on a joint, its child."""
    X_LS: Pose = IDENTITY
    """Pose in the link, for the kinds in :data:`PLACED`."""
    joint: str = ""
    """The joint that it measures, for joint and force-torque sensors."""
    rate: float = 0.0
    """Measurements per second [Hz]; 0 for one in every step of a simulation."""
    view: View = View()
    """For the kinds in :data:`SEEING`."""
    frame: str = ""
    """The link or frame by which programs of ROS name the place of its measurements; empty for Gazebo's own name."""
    source: str = ""
    """How its frame was found, for messages; empty if it is the frame of its link or joint."""
