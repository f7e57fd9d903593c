"""The ROS package that a URDF is installed in: its name, and mesh paths by it."""

import re
from collections.abc import Collection

from . import FORMAT

_NAME = re.compile(r"[a-z][a-z0-9_]+")
"""https://ros.org/reps/rep-0144.html."""
_ENDING = "_description"
_RELATIVE = b'filename="meshes/'
"""As the writer writes it; in the text of any attribute the quote would be escaped."""


def package_named(name: str) -> str:
    """The name, unless it is not one of a ROS package.

    Raises:
        ValueError: It is not.
    """
    if not _NAME.fullmatch(name):
        needed = "two or more lower-case letters, digits and _, a letter first"
        raise ValueError(f"'{name}' is not the name of a ROS package: {needed}")
    return name


def package_of(package: str, ros2: str, formats: Collection[str], prefix: str = "") -> str:
    """The ROS package of the output folder; empty for none.

    Args:
        package: Name of the package of the URDF's meshes; empty for none.
        ros2: Name of the ROS 2 package, with or without ``_description`` at its end; empty for none.
        prefix: Written before ``package`` and ``ros2`` in messages.

    Raises:
        ValueError: Both are given, one is not a valid package name, or URDF is not written.
    """
    if package and ros2:
        raise ValueError(f"{prefix}package and {prefix}ros2 cannot be combined")
    if not (package or ros2):
        return ""
    if FORMAT.name not in formats:
        raise ValueError(f"{prefix}{'package' if package else 'ros2'} needs the format urdf")
    return f"{package_named(ros2.removesuffix(_ENDING))}{_ENDING}" if ros2 else package_named(package)


def with_package(urdf: bytes, package: str) -> bytes:
    """A written URDF with ``package://<package>/meshes/`` in place of relative paths.

    https://wiki.ros.org/urdf/XML/link
    """
    return urdf.replace(_RELATIVE, f'filename="package://{package}/meshes/'.encode())
