"""Webots, which reads a robot as a PROTO in VRML."""

import re

from ..format import Format


def proto_name(robot: str) -> str:
    """The robot's name as an identifier: letters, digits, `_` and `-`, no digit or `-` first."""
    name = re.sub(r"[^A-Za-z0-9_-]", "_", robot)
    return name if re.match("[A-Za-z_]", name) else f"_{name}"


FORMAT = Format(
    __name__,
    "webots",
    "Webots",
    suffix=".proto",
    root="",
    order=50,
    scene=".wbt",
    default=False,
    signatures=(b"#VRML_SIM ",),
    stem=proto_name,
)
