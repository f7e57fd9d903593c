"""Robots composed of modules that are written into a folder of the test."""

from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import dedent

import pytest

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.pipeline.composing import compose
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.sidecars import load
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache

Compose = Callable[..., Robot]


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Cache:
    """One cache for all tests: each STEP is read once."""
    return Cache(tmp_path_factory.mktemp("cache"))


@pytest.fixture
def write(tmp_path: Path, robot_library: Path) -> Callable[[Mapping[str, str]], None]:
    """Writes sidecars into the folder of the test; ``LIBRARY`` in them is the folder of the robot library."""

    def written(files: Mapping[str, str]) -> None:
        for name, text in files.items():
            (tmp_path / name).write_text(dedent(text).replace("LIBRARY", robot_library.as_posix()), encoding="utf-8")

    return written


@pytest.fixture
def composed(tmp_path: Path, cache: Cache, write: Callable[[Mapping[str, str]], None]) -> Compose:
    """Composes the robot of the first of some files; diagnostics go to ``found``."""

    def robot(files: Mapping[str, str], diagnostics: Diagnostics) -> Robot:
        write(files)
        options = Options(tmp_path / "out", cache=cache)
        return compose(load(tmp_path / next(iter(files)), options, diagnostics), options, diagnostics).robot

    return robot


@pytest.fixture
def errors(composed: Compose) -> Callable[[Mapping[str, str], Diagnostics], list[str]]:
    """The errors of a composition that cannot be made, as one line each, with line and column."""

    def of(files: Mapping[str, str], diagnostics: Diagnostics) -> list[str]:
        with pytest.raises(StepbotError):
            composed(files, diagnostics)
        faults = [one for one in diagnostics if one.severity == "error"]
        return [f"{one.code} {one.span.line}:{one.span.column} {one.message}" for one in faults]

    return of
