"""A link whose collision mesh is one triangle."""

from dataclasses import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.geometry.mesh import TriMesh
from stepbot.robot.model import Collision, MeshAsset, MeshRef
from tests import robots


def find(found: Diagnostics) -> None:
    """Ask the library."""
    flat = MeshAsset("flat", TriMesh.of([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], [[0, 1, 2]]))
    robot = robots.one_link()
    link = replace(robot.root, collisions=(Collision("touched", MeshRef("flat")),))
    lower(replace(robot, links=(link,), meshes=(*robot.meshes, flat)), FORMATS["mjcf"], found)
