"""Every robot of the library, converted once per session."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.command_line import Conversion, convert_once

LIBRARY = Path(__file__).resolve().parents[2] / "robot_library"
ROBOTS = tuple(sorted(path.name for path in LIBRARY.iterdir() if path.is_dir() and not path.name.startswith("_")))
"""Names of the robots' folders."""

Converted = Callable[[str], Conversion]


def sidecar_of(robot: str) -> Path:
    """The one sidecar in a robot's folder."""
    (sidecar,) = (LIBRARY / robot).glob("*.robot.yaml")
    return sidecar


@pytest.fixture(scope="session")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Converted:
    """Gives the conversion of the robot in a folder of the library; each is converted when it is first asked for."""
    return lambda robot: convert_once(tmp_path_factory, robot, sidecar_of(robot))
