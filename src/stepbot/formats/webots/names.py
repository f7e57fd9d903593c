"""Names of PROTOs, which are identifiers of VRML, and those of their files."""

import re


def proto_name(robot: str) -> str:
    """The robot's name as an identifier: letters, digits, `_` and `-`, no digit or `-` first."""
    name = re.sub(r"[^A-Za-z0-9_-]", "_", robot)
    return name if re.match("[A-Za-z_]", name) else f"_{name}"
