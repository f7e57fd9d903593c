"""Additional files of a format beside its main one."""

from dataclasses import dataclass

from stepbot.robot.model import Robot


@dataclass(frozen=True, eq=False)
class Companion:
    """A file beside the main one, for a reader that cannot use the main file."""

    path: str
    """Relative to the output folder."""
    format: str
    """The name of its format, for the engines that read it; empty if none does."""
    robot: Robot
    """Its content."""
    content: bytes
