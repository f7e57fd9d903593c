"""Makes a folder with an SDFormat file and its meshes a model of Gazebo: https://gazebosim.org/api/sim/9/resources.html.

Gazebo finds a model by the name of its folder, in the folders of ``GZ_SIM_RESOURCE_PATH``. ``model.config`` names the
file with the robot; it is ``model.sdf``, as tools and users of Fuel expect, not ``<robot>.sdf``.
"""

from collections.abc import Mapping

from stepbot.robot.model import Robot

from ..xml import document, element, root
from . import FORMAT
from .writer import sdf_version

CONFIG = "model.config"
"""Name of the file by which Gazebo recognizes a model."""
MODEL = "model.sdf"
"""Name of the file with the robot."""
_RELATIVE = b"<uri>meshes/"
"""As the writer writes it; in any other text the bracket would be escaped."""


def gazebo_model(robot: Robot, files: Mapping[str, bytes], name: str) -> dict[str, bytes]:
    """The files of a robot's SDFormat, with meshes as ``model://<name>/meshes/...``, and ``model.config``.

    Args:
        robot: The robot as SDFormat expresses it.
        files: The files of the format by path relative to the model's folder; the first becomes ``model.sdf``.
        name: Name of the folder.
    """
    absolute = f"<uri>model://{name}/meshes/".encode()
    main = next(iter(files))
    changed = {
        MODEL if path == main else path: content.replace(_RELATIVE, absolute)
        if path.endswith(FORMAT.suffix)
        else content
        for path, content in files.items()
    }
    return changed | {CONFIG: _config(robot)}


def _config(robot: Robot) -> bytes:
    top = root("model", robot.source)
    element(top, "name", robot.name)
    element(top, "version", robot.metadata.version or "1.0")
    element(top, "sdf", MODEL, version=sdf_version(robot))
    if robot.metadata.maintainer:
        author = element(top, "author")
        element(author, "name", robot.metadata.maintainer)
        element(author, "email", robot.metadata.email)
    element(top, "description", robot.metadata.description or f"Description of {robot.name}")
    return document(top)
