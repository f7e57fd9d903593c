"""Devices mounted on links and joints: frames, actuators and sensors."""

import re
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Tag, WithJsonSchema

from stepbot.robot.model import ActuatorKind
from stepbot.robot.sensors import SensorKind
from stepbot.robot.tuning import BANDWIDTH, DAMPING_RATIO

from .motion import LimitsSection
from .motor_sections import MotorName, SupplyVoltage
from .origins import Origin
from .quantities import (
    Bandwidth,
    DampingRatio,
    DistanceRange,
    FieldOfView,
    Frequency,
    Gear,
    JointDamping,
    JointStiffness,
    JointValue,
    described,
    fault,
    two,
)
from .section import WORD_OR_MAPPING, ComponentPath, Reference, Section


def _count(value: Any) -> int:
    """A whole number of at least one."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise fault("SB122", f"expected an integer, not {described(value)}")
    if value < 1:
        raise fault("SB125", f"{value} is out of range: must be at least 1")
    return value


_BYTES = re.compile(r"([0-9]+(\.[0-9]+)?) ?([kKMG]?)B?")
_POWERS = {"": 1, "k": 10**3, "K": 10**3, "M": 10**6, "G": 10**9}


def _bytes(value: Any) -> int:
    """A number of bytes: `10M`, `1.5 GB`, `500000`."""
    given = _BYTES.fullmatch(value) if isinstance(value, str) else None
    if given is None:
        if isinstance(value, str):
            raise fault("SB122", f"expected a number of bytes such as 10M, not {described(value)}")
        return _count(value)
    return _count(int(Fraction(given[1]) * _POWERS[given[3]]))


Bytes = Annotated[
    int,
    BeforeValidator(_bytes),
    WithJsonSchema(
        {
            "anyOf": [{"type": "integer", "minimum": 1}, {"type": "string", "pattern": f"^{_BYTES.pattern}$"}],
            "description": "A number of bytes, with `k`, `M` or `G` for powers of 1000.",
            "examples": ["10M"],
        }
    ),
]
Count = Annotated[int, BeforeValidator(_count), WithJsonSchema({"type": "integer", "minimum": 1})]
Resolution = Annotated[tuple[Count, Count], BeforeValidator(two)]


class FrameSection(Section):
    """A named frame on a link."""

    link: Reference
    """The link that it is fixed to."""
    origin: Origin
    """Its pose; not `auto`, since there is no second link."""


class GainsSection(Section):
    """How to compute the gains of an actuator from the inertia that it moves in the drawn pose."""

    bandwidth: Bandwidth = BANDWIDTH
    """Natural frequency [Hz] of the joint with the actuator; of a velocity actuator, its corner frequency."""
    damping_ratio: DampingRatio = DAMPING_RATIO
    """Damping ratio of a position actuator; 1, the default, is the fastest response that does not overshoot."""


Gains = Annotated[
    Annotated[Literal["auto"], Tag("<word>")] | Annotated[GainsSection, Tag("<mapping>")], WORD_OR_MAPPING
]
"""`auto`, or the bandwidth and the damping ratio of computed gains."""


class ActuatorSection(Section):
    """An actuator on a joint."""

    joint: Reference = ""
    """The joint that it drives; by default the one of its own name."""
    kind: ActuatorKind = ActuatorKind.MOTOR
    """The type of its input: a position, a velocity, or (motor) an effort; with `motor`, a position by default."""
    motor: MotorName | None = None
    """Its motor: a name of the catalogue (`stepbot motors`) or of `motors`. It gives what no other key does."""
    voltage: SupplyVoltage | None = None
    """The supply [V] of `motor`; by default that of the catalogue."""
    part: ComponentPath | None = None
    """The component of `motor`, which gets its mass if nothing else gives it one."""
    kp: JointStiffness = JointValue(0.0)
    """Position gain [N m/rad or N/m]."""
    kv: JointDamping = JointValue(0.0)
    """Velocity gain [N m s/rad or N s/m]."""
    gains: Gains | None = None
    """Computes `kp` and `kv` from the inertia that the actuator moves in the drawn pose, and from its effort limit."""
    gear: Gear = JointValue(1.0)
    """Motor position / joint position; [rad/m] where the joint slides. `kp`, `kv` and the input are on the motor's
    side."""
    limits: LimitsSection = LimitsSection()
    """Its own limits, at the joint, in addition to those of the joint."""


class SensorSection(Section):
    """A sensor on a link or a joint."""

    type: SensorKind
    """The type of sensor."""
    link: Reference | None = None
    """The link that it is mounted on."""
    joint: Reference | None = None
    """The joint that it measures."""
    origin: Origin | None = None
    """Its pose, x forward and z up; by default the link's or joint's frame."""
    rate: Frequency = 0.0
    """Measurements per second [Hz]; by default one per simulation step."""
    fov: FieldOfView | None = None
    """Horizontal field of view [rad]; by default 60 deg for a camera and 360 deg for a lidar."""
    resolution: Resolution | None = None
    """Resolution of a camera in pixels, [width, height]; by default [640, 480]."""
    samples: Count | None = None
    """Number of rays of a lidar, evenly spaced over its field of view, edges included; by default 360."""
    range: DistanceRange | None = None
    """Minimum and maximum distance [m] that a camera or a lidar measures; unlimited by default."""
