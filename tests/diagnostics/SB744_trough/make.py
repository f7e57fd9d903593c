"""A collision mesh with a trough."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.robot.model import Collision, MeshAsset, MeshRef
from tests.meshes import trough
from tests.robots import one_link


def find(found: Diagnostics) -> None:
    """Ask the library."""
    robot = one_link()
    link = replace(robot.root, collisions=(Collision("touched", MeshRef("trough")),))
    robot = replace(robot, links=(link,), meshes=(*robot.meshes, MeshAsset("trough", trough(20))))
    lower(robot, FORMATS["usd"], found)
