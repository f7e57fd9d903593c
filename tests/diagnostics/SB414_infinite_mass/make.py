"""A robot built by another program, since the checks of the sidecar report this first."""

from stepbot.diagnostics import Diagnostics
from stepbot.robot.validity import check_robot
from tests.unit.robot.test_validity import BROKEN


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    check_robot(BROKEN["infinite mass"][1], diagnostics)
