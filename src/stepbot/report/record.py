"""Everything that a report holds: verification results, the robot, measured bodies."""

from dataclasses import dataclass

from stepbot.geometry.inertia import MassProperties
from stepbot.robot.model import Robot

from .results import Check, Content, LinkCollision, Results, Row, SimplifiedVisuals, Status, WrittenFile

__all__ = [
    "Check",
    "Content",
    "LinkCollision",
    "MeasuredBody",
    "Report",
    "Results",
    "Row",
    "SimplifiedVisuals",
    "Status",
    "WrittenFile",
]


@dataclass(frozen=True)
class MeasuredBody:
    """One definition of the assembly, measured twice, at a density of 1 kg/m^3."""

    name: str
    occurrences: int
    mesh: MassProperties | None
    """By trimesh, on the written mesh."""
    exact: MassProperties | None
    """By integration over the exact solid."""
    deviation: float | None
    """The largest relative difference between the two, of volume, centre and inertia."""
    error: float | None
    """Estimated relative error of ``exact``; None without an exact solid or an estimate."""
    used: MassProperties | None
    """The one that masses are computed from; None if neither is known."""
    written: str
    """Which of the two is used in the files, and why; why the body has no mass if neither is."""


@dataclass(frozen=True)
class Report(Results):
    """The results, with the robot and its bodies."""

    robot: Robot | None = None
    bodies: tuple[MeasuredBody, ...] = ()
