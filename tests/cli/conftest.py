"""Fixtures: a folder with a robot that converts, and a function that runs a command there."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec import Struct

from stepbot_cli import main


class Run(Struct, frozen=True):
    """Exit code, standard output and standard error of a command."""

    code: int
    out: str
    err: str


Stepbot = Callable[..., Run]


@pytest.fixture
def stepbot(capsys: pytest.CaptureFixture[str]) -> Stepbot:
    """A function that runs ``stepbot`` with the given arguments."""

    def run(*arguments: str) -> Run:
        code = main(arguments)
        captured = capsys.readouterr()
        return Run(code, captured.out, captured.err)

    return run


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_library: Path) -> Path:
    """The current folder, with ``arm2.robot.yaml`` and ``arm2.step`` from the robot library."""
    for file in ("arm2.robot.yaml", "arm2.step"):
        shutil.copy(robot_library / "stepbot_arm2" / file, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path
