"""What measures on a robot: inertial units, force-torque cells, encoders, cameras, lidars, contact switches.

The frame of a sensor is x ahead and z up, as REP 103 has it for bodies: a camera looks along x, a lidar scans around z
with the middle of its range on x. A force-torque sensor tells the wrench that the parent of its joint exerts on the
child, in its own frame and about its own origin: at rest, what holds the child up.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf

from stepbot.geometry.spatial import IDENTITY, Pose


class SensorKind(StrEnum):
    """What a sensor measures."""

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


@dataclass(frozen=True)
class View:
    """What a camera or a lidar sees; the rays of a lidar are spread evenly, the outermost at the edges."""

    fov: float = 0.0
    """Horizontal field of view [rad]."""
    columns: int = 0
    """Pixels from left to right; rays of a lidar."""
    rows: int = 0
    """Pixels from top to bottom; 1 for a lidar."""
    nearest: float = 0.0
    """Shortest distance [m] that it sees; 0 where nothing is too near."""
    farthest: float = inf
    """Longest distance [m] that it sees; infinite where nothing is too far."""


@dataclass(frozen=True)
class Sensor:
    """A sensor on a link, or on the joint above a link."""

    name: str
    kind: SensorKind
    link: str
    """The link that it is mounted on; the child of ``joint``, where there is one."""
    X_LS: Pose = IDENTITY
    """Pose in the link, for the kinds in :data:`PLACED`."""
    joint: str = ""
    """The joint that it measures: of joint and force-torque sensors."""
    rate: float = 0.0
    """Measurements per second [Hz]; 0 for one in every step of a simulation."""
    view: View = View()
    """Of the kinds in :data:`SEEING`."""
    source: str = ""
    """What gave its frame, for people; empty where it is that of its link or joint."""
