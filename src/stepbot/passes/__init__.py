"""Robot to robot: what is the same for every format is done here, once, before the writers see the robot.

A pass is a function ``(Robot, Diagnostics) -> Robot`` in a file of its own, and an entry of :data:`PASSES`.
"""

from collections.abc import Callable

from ..diagnostics import Diagnostics
from ..model import Robot
from .share_meshes import share_meshes

PASSES: tuple[Callable[[Robot, Diagnostics], Robot], ...] = (share_meshes,)
"""In the order in which they run."""


def run_passes(robot: Robot, found: Diagnostics) -> Robot:
    """The robot after every pass."""
    for run in PASSES:
        robot = run(robot, found)
    return robot


__all__ = ["PASSES", "run_passes"]
