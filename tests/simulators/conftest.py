"""Files of the named robots on disk, and observations by engines."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.engines.reference import observe_robot
from stepbot.formats import FORMATS, format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.robot.model import Robot
from stepbot.verification.compare import compare
from stepbot.verification.conversion import Written
from stepbot.verification.expectation import mechanism, requests


class Folder(Struct, frozen=True):
    """A robot written in every format."""

    robot: Robot
    path: Path
    written: Mapping[str, Written]

    def request(self, written_in: str) -> Request:
        """The request to engines that read the file of a format."""
        one = self.written[written_in]
        return requests(self.robot, {written_in: one.robot}, {written_in: one.path})[written_in]

    def expected(self, written_in: str, asked: Request | None = None) -> Observation:
        """The expected observation, for that request or in full."""
        moved = mechanism(self.robot, self.written[written_in].robot)
        moved = replace(moved, actuators=self.written[written_in].robot.actuators)
        return observe_robot(moved, asked or self.request(written_in))


def write(robot: Robot, path: Path) -> Folder:
    """Write a robot in every format."""
    written = {}
    for name in FORMATS:
        files = render(robot, name, Diagnostics())
        for relative, content in files.items():
            target = path / relative
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        lowered = lower(robot, format_named(name), Diagnostics())
        written[name] = Written(path / next(iter(files)), lowered)
        for beside in format_named(name).writer.companions(lowered):
            if beside.format:  # not an SRDF or a file of meshes, which is no robot of its own
                written[beside.format] = Written(path / beside.path, beside.robot)
    return Folder(robot, path, written)


def skip_without(engine: str) -> None:
    """Skip the test if an engine is not installed."""
    reason = engine_of(engine).available()
    if reason is not None:
        pytest.skip(reason)


def look(engine: str, request: Request) -> Observation:
    """An engine's observation; the test is skipped if the engine is not installed.

    The engine runs in this process, which saves a start for each of many files: none of these files crashes an engine.
    """
    skip_without(engine)
    observation: Observation = engine_of(engine).observer.observe(request)
    return observation


def failures(expected: Observation, observed: Observation) -> set[Quantity]:
    """The quantities in which an observation differs from the expected one."""
    return {one.quantity for one in compare(expected, observed) if one.deviations.failures and not one.not_run}
