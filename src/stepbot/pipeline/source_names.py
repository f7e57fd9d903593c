"""Which files are robot descriptions, by their names; imports nothing heavy."""

from pathlib import Path

_SUFFIXES = (".urdf", ".xacro", ".sdf", ".xml", ".mjcf", ".world", ".usd", ".usda", ".usdc", ".proto")
"""The content decides between the formats; OpenUSD, PROTOs and macros are not converted, which readers report."""


def is_description(path: Path) -> bool:
    """Whether a file is taken as a robot description, not as a sidecar."""
    return path.suffix.lower() in _SUFFIXES
