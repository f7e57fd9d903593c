"""A robot built by another program, since the checks of the sidecar report this first."""

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests import robots


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    robot = robots.pendulum()
    root = replace(robot.root, name="world")
    joint = replace(robot.joints[0], parent="world")
    lower(replace(robot, links=(root, robot.links[1]), joints=(joint,)), FORMATS["urdf"], diagnostics)
