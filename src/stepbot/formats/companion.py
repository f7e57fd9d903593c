"""Files that a format has beside its main one."""

from dataclasses import dataclass

from stepbot.robot.model import Robot


@dataclass(frozen=True, eq=False)
class Companion:
    """A file beside the main one, for a reader that cannot do with that."""

    path: str
    """Relative to the output folder."""
    format: str
    """What the engines that read it call its format."""
    robot: Robot
    """What it says."""
    content: bytes
