"""What packages state about the robot's description: maintainer, licence, version."""

import re
from typing import Annotated, Any

from pydantic import Field, PlainValidator, WithJsonSchema

from stepbot.robot.metadata import MAINTAINER, is_maintainer

from .quantities import described, fault
from .section import Section

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


Maintainer = Annotated[
    str,
    PlainValidator(_maintainer),
    WithJsonSchema({"type": "string", "pattern": MAINTAINER, "examples": ["Ada Lovelace <ada@example.com>"]}),
]
Version = Annotated[
    str, PlainValidator(_version), WithJsonSchema({"type": "string", "pattern": _VERSION, "examples": ["1.0.0"]})
]
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
