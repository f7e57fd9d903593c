"""Every robot in every format, each written to its own folder."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.robot.model import Robot
from tests.robots import ROBOTS

Write = Callable[[str, str], tuple[Robot, Path]]


@pytest.fixture(scope="session")
def write(tmp_path_factory: pytest.TempPathFactory) -> Write:
    """A function that writes a robot by name in a format; returns the lowered robot and the main file."""

    def write_robot(name: str, format_: str) -> tuple[Robot, Path]:
        robot = ROBOTS[name]()
        folder = tmp_path_factory.mktemp(name)
        for path, content in render(robot, format_, Diagnostics()).items():
            (folder / path).parent.mkdir(exist_ok=True)
            (folder / path).write_bytes(content)
        return lower(robot, FORMATS[format_], Diagnostics()), folder / f"{robot.name}{FORMATS[format_].suffix}"

    return write_robot
