"""Everything that a conversion writes for robots in memory, plainly and with every option, and what it reports."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from random import Random

import numpy as np
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.formats import FORMATS
from stepbot.formats.learning import FOLDERS, PROGRAMS
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Array, Pose, matrix3, vector3
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.writing import all_files, proven, rendered
from stepbot.robot.datasheet import data_sheet
from stepbot.robot.model import Robot
from tests.random_robots import drawn_robot, widened
from tests.robots import ROBOTS

_DRAWN, _IN_FULL = 40, 12
"""Robots that are drawn, and those of them that are written with every option."""
_ROUND = (19, 27, 33, 34)
"""Those with round bodies: rounding decides about their principal axes, which OpenUSD has."""
_PLAIN = Options(Path("out"), verify=False)
_ALL = _PLAIN._replace(ros2=True, package="pack", gazebo="gazed", maintainer="A B <a@b.c>", license="MIT")
_PROGRAMS = {name: program.format for name, program in PROGRAMS.items()} | FOLDERS


def _drawn(seed: int) -> Robot:
    random = Random(seed)
    robot = drawn_robot(random)
    return widened(random, robot) if seed % 2 else robot


def disturbed(robot: Robot, noise: float) -> Robot:
    """A robot whose joints and bodies are elsewhere by so much [m], and whose inertias are others by that share."""
    if not noise:
        return robot
    random = Random(2)

    def off(count: int = 3) -> Array:
        return np.array([random.gauss(0.0, noise) for _ in range(count)])

    def body(one: MassProperties) -> MassProperties:
        share = 1.0 + off(9).reshape(3, 3)
        return replace(
            one, com=vector3(np.array(one.com) + off()), inertia=matrix3(one.inertia * (share + share.T) / 2)
        )

    joints = (replace(one, X_PC=Pose(one.X_PC.rotation, vector3(one.X_PC.p + off()))) for one in robot.joints)
    links = (replace(one, mass_properties=body(one.mass_properties)) for one in robot.links)
    return replace(robot, joints=tuple(joints), links=tuple(links))


def _written(build: Callable[[], Robot], given: Options, _noise: float) -> dict[str, object]:
    """By format, the files by path, if it can express the robot, and the diagnostics; noise would be written."""
    robot, all_of_them = build(), dict[str, object]()
    for of in FORMATS:
        programs = tuple(name for name, needed in _PROGRAMS.items() if needed == of) if given.ros2 else ()
        options = given._replace(formats=(of,), programs=programs)
        diagnostics, files = Diagnostics(), dict[str, bytes]()
        try:
            written = rendered(robot, (FORMATS[of],), options, diagnostics)
            files = all_files(written, proven(written, None, options, diagnostics), options, diagnostics)
        except StepbotError as error:
            diagnostics.extend(error.diagnostics)
        all_of_them[of] = files, [str(one) for one in diagnostics]
    return all_of_them


def _sheet(build: Callable[[], Robot], noise: float) -> dict[str, object]:
    return {"sheet": data_sheet(disturbed(build(), noise))}


def _results() -> Iterator[tuple[str, Callable[[float], dict[str, object]]]]:
    robots = {name: build for name, build in ROBOTS.items() if name != "stewart"}
    further = {f"drawn {seed}": partial(_drawn, seed) for seed in range(_DRAWN) if seed not in _ROUND}
    for number, (name, build) in enumerate((robots | further).items()):
        yield f"{name}, plain", partial(_written, build, _PLAIN)
        if number < len(robots) + _IN_FULL:
            yield f"{name}, every option", partial(_written, build, _ALL)
        yield f"{name}, data sheet", partial(_sheet, build)


RESULTS = dict(_results())
