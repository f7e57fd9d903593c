"""Three joints; the third follows the second, which follows the first."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.robot.model import Mimic
from tests import robots


def find(found: Diagnostics) -> None:
    """Ask the library."""
    robot = robots.pendulum()
    first = robot.joints[0]
    links = tuple(replace(robot.links[1], name=name, visuals=(), collisions=()) for name in ("second_bob", "third_bob"))
    second = replace(first, name="second", parent=first.child, child="second_bob", mimic=Mimic(first.name, 2.0))
    third = replace(first, name="third", parent="second_bob", child="third_bob", mimic=Mimic("second", 3.0))
    lower(replace(robot, links=(*robot.links, *links), joints=(first, second, third)), FORMATS["sdf"], found)
