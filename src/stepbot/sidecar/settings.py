"""Settings of the written files, of simulations, and of the search for links that can overlap."""

import re
from enum import StrEnum
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, WithJsonSchema

from stepbot.robot.metadata import MAINTAINER, is_maintainer
from stepbot.robot.self_collision import DEFAULT_SAMPLES, MOST_SAMPLES
from stepbot.robot.tuning import Integrator

from .devices import Count
from .quantities import StepShare, Timestep, described, fault, two
from .section import Reference, Section

_VERSION = r"^[0-9]+\.[0-9]+\.[0-9]+$"


def _maintainer(value: Any) -> str:
    if not isinstance(value, str) or not is_maintainer(value):
        raise fault(
            "SB123", f"expected a name and an address, not {described(value)}", "Ada Lovelace <ada@example.com>"
        )
    return value


def _version(value: Any) -> str:
    if not isinstance(value, str) or not re.match(_VERSION, value):
        raise fault("SB123", f"expected three numbers, not {described(value)}", "quoted, as ROS requires: '1.0.0'")
    return value


def _version_of(title: str, versions: tuple[float, ...]) -> tuple[PlainValidator, WithJsonSchema]:
    """What pydantic needs for one of the versions, as a number or as text."""

    def read(value: Any) -> float:
        for version in versions:
            if not isinstance(value, bool) and value in (version, f"{version:g}", f"{version:.1f}"):
                return version
        known = ", ".join(f"{version:.1f}" for version in versions)
        raise fault("SB123", f"no such version of {title}: {described(value)}", f"versions: {known}")

    return PlainValidator(read), WithJsonSchema({"enum": list(versions), "type": "number"})


Maintainer = Annotated[
    str,
    PlainValidator(_maintainer),
    WithJsonSchema({"type": "string", "pattern": MAINTAINER, "examples": ["Ada Lovelace <ada@example.com>"]}),
]
Version = Annotated[
    str, PlainValidator(_version), WithJsonSchema({"type": "string", "pattern": _VERSION, "examples": ["1.0.0"]})
]
UrdfVersion = Annotated[float, *_version_of("URDF", (1.0, 1.1, 1.2))]
MjcfVersion = Annotated[float, *_version_of("MuJoCo", (3.3, 3.7))]
Line = Annotated[str, Field(min_length=1, max_length=1000)]


class MetadataSection(Section):
    """What packages for ROS, Gazebo and Webots state about the robot's description."""

    maintainer: Maintainer | None = None
    """Name and address of the maintainer: `Ada Lovelace <ada@example.com>`."""
    license: Line | None = None
    """Licence, by its SPDX identifier where it has one: `Apache-2.0`."""
    version: Version | None = None
    """Version of the description, three numbers: `1.0.0`."""
    description: Line | None = None
    """One sentence about the robot."""


class UrdfSection(Section):
    """Settings of the written URDF."""

    version: UrdfVersion = 1.0
    """Version of the format: 1.0 (the default), which all programs read, 1.1 with quaternions and capsules, or 1.2 with
    limits of acceleration, deceleration and jerk, too."""


class MjcfSection(Section):
    """Settings of the written MJCF."""

    version: MjcfVersion = 3.7
    """The oldest MuJoCo that must read it: 3.7 (the default), or 3.3, without contact sensors and rates of sensors,
    and with the damping of actuators within their force range."""


def _sample_count(value: int) -> int:
    if value > MOST_SAMPLES:
        raise fault("SB125", f"{value} is out of range: must be at most {MOST_SAMPLES}")
    return value


SampleCount = Annotated[
    Count, AfterValidator(_sample_count), WithJsonSchema({"type": "integer", "minimum": 1, "maximum": MOST_SAMPLES})
]


LinkPair = Annotated[tuple[Reference, Reference], BeforeValidator(two)]
"""Two links."""


class ExcludedPairs(StrEnum):
    """Pairs of links by how often they overlap in sampled poses."""

    ALWAYS = "always"
    NEVER = "never"


class SelfCollisionSection(Section):
    """A search for the links that can overlap, in random poses within the limits."""

    samples: SampleCount = DEFAULT_SAMPLES
    """Number of poses, the drawn one included."""
    exclude: tuple[ExcludedPairs, ...] = (ExcludedPairs.ALWAYS,)
    """Pairs whose contacts MJCF excludes, in addition to adjacent links."""


class SimulationSection(Section):
    """Settings for simulating the robot, for formats and engines that have them."""

    timestep: Timestep | None = None
    """Time step [s]; by default 1 ms for a robot with closures or mimics, or with stiff wheel motors, else 2 ms."""
    integrator: Integrator | None = None
    """The method of integration, in MuJoCo's terms: implicitfast, the default, implicit, euler or rk4."""
    closure_stiffness: StepShare | None = None
    """Share of a gap of a closure or mimic that is closed within one time step, above 0 and at most 1, the default."""
