"""Which files are robot descriptions that can be converted, by their names; imports nothing heavy."""

from pathlib import Path

_SUFFIXES = (".urdf", ".sdf", ".xml", ".mjcf", ".world")
"""Suffixes of URDF, SDFormat and MJCF; the root element decides between the formats."""


def is_description(path: Path) -> bool:
    """Whether a file is taken as a URDF, SDFormat or MJCF, not as a sidecar."""
    return path.suffix.lower() in _SUFFIXES
