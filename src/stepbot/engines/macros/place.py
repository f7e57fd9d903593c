"""What an expansion returns."""

from pathlib import Path
from typing import NamedTuple


class Place(NamedTuple):
    """Where something is stated."""

    file: str
    line: int


class Expanded(NamedTuple):
    """What a xacro expands to, or why it does not."""

    text: bytes
    """The URDF, one element a line, meshes with absolute paths; empty after an error."""
    places: tuple[Place, ...]
    """For each line of the URDF, where its element is stated; the first line has number 1, and is at index 1."""
    files: tuple[Path, ...]
    """The other files that were read."""
    arguments: tuple[str, ...]
    """Names of the arguments that the xacro declares."""
    error: str = ""
    """Why it cannot be expanded."""
    at: Place = Place("", 0)
    """Where the error is."""
    calls: tuple[Place, ...] = ()
    """The macro calls around the error, the innermost first."""
