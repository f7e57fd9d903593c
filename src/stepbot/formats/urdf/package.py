"""Mesh paths of a URDF by the ROS package that it is installed in: https://wiki.ros.org/urdf/XML/link."""

_RELATIVE = b'filename="meshes/'
"""As the writer writes it; in the text of any attribute the quote would be escaped."""


def with_package(urdf: bytes, package: str) -> bytes:
    """A written URDF with ``package://<package>/meshes/`` in place of relative paths."""
    return urdf.replace(_RELATIVE, f'filename="package://{package}/meshes/'.encode())
