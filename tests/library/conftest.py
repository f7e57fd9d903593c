"""Every robot of the library, converted once per session."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.command_line import Conversion, convert_once

LIBRARY = Path(__file__).resolve().parents[2] / "robot_library"
ROBOTS = tuple(sorted(path.parent.name for path in LIBRARY.glob("*/build.py")))
"""Names of the folders of the robots that are drawn; those composed of others are tested in tests/composition."""
SHORT = ("stepbot_arm2", "stepbot_four_bar", "universal_robots_ur5e")
"""Robots converted by `make test`: a tree with a mimic, a loop, an industrial arm. `make all` converts all."""

every_robot = pytest.mark.parametrize("robot", ROBOTS)


def converted_robots(but: str = "") -> pytest.MarkDecorator:
    """Run a test with each robot, optionally except one."""
    robots = [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in ROBOTS if robot != but]
    return pytest.mark.parametrize("robot", robots)


every_converted_robot = converted_robots()

Converted = Callable[[str], Conversion]


def name_of(robot: str) -> str:
    """The robot's name: that of its folder without the maker's, which may consist of several words."""
    return sidecar_of(robot).name.removesuffix(".robot.yaml")


def sidecar_of(robot: str) -> Path:
    """The one sidecar in a robot's folder."""
    (sidecar,) = (LIBRARY / robot).glob("*.robot.yaml")
    return sidecar


@pytest.fixture(scope="session")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Converted:
    """Returns the conversion of a library robot; each is converted on first use."""
    return lambda robot: convert_once(tmp_path_factory, robot, sidecar_of(robot))
