"""A robot that another program made: the sidecar's own checks find this before."""

from stepbot.diagnostics import Diagnostics
from stepbot.robot.validity import check_robot
from tests.unit.robot.test_validity import BROKEN


def find(found: Diagnostics) -> None:
    """Ask the library."""
    check_robot(BROKEN["infinite mass"][1], found)
