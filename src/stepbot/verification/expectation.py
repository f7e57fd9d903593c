"""The expected observation of a file, and the requests to the engines.

A format represents the robot as lowered by :func:`.lowering.lower`, so its file is compared with that. Loops are
included in the requests for every format, even if the file has only the tree: constraints can be added in the engine.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from stepbot.engines.observation import Request
from stepbot.robot.closures import driven_joints, held_by_a_point, loop_ways
from stepbot.robot.kinematics import configurations, initial_configuration, rates
from stepbot.robot.model import Base, Robot
from stepbot.robot.multi_dof import ball_coordinates, universal_coordinates

CONFIGURATIONS = 32
"""Number of random configurations at which poses and dynamics are compared."""
CLOSED_CONFIGURATIONS = 24
"""Number of closed configurations over the range of a mechanism with loops."""
SEED = 20240229
"""Seed of all random configurations; arbitrary but constant."""
SECONDS = 1.0
"""Duration [s] of the passive simulation."""


def mechanism(robot: Robot, lowered: Robot) -> Robot:
    """The lowered robot with the loops and actuators that its format lacks, under the lowered joint names."""
    closures = lowered.closures or robot.closures
    renamed = {joint.child: joint.name for joint in lowered.joints}
    name_of = {joint.name: renamed[joint.child] for joint in robot.joints if joint.child in renamed}
    actuators = lowered.actuators or tuple(
        replace(actuator, joint=name_of[actuator.joint]) for actuator in robot.actuators if actuator.joint in name_of
    )
    return replace(lowered, closures=closures, actuators=actuators)


@dataclass(frozen=True, eq=False)
class _Solved:
    """The loops of a robot, solved."""

    robot: Robot
    driven: tuple[str, ...]
    held_by_a_point: tuple[str, ...]
    ways: tuple[tuple[Mapping[str, float], ...], ...]


def requests(robot: Robot, lowered: Mapping[str, Robot], files: Mapping[str, Path]) -> dict[str, Request]:
    """The request to the engines, for each format.

    Args:
        robot: The robot.
        lowered: The robot as each format expresses it.
        files: Path of each format's file.

    Raises:
        DoesNotClose: The loops do not close in the drawn pose.
    """
    solved: list[_Solved] = []
    asked = {}
    for name, file in files.items():
        moved = mechanism(robot, lowered[name])
        # Most formats have the same joints and loops: their range is computed once.
        known = [one for one in solved if one.robot.joints == moved.joints and one.robot.closures == moved.closures]
        if not known:
            ways = loop_ways(moved, CLOSED_CONFIGURATIONS, SEED)
            solved.append(_Solved(moved, driven_joints(moved), held_by_a_point(moved), ways))
        loops = (known or solved[-1:])[0]
        asked[name] = Request(
            file=str(file.resolve()),
            format=name,
            configurations=configurations(moved, CONFIGURATIONS, SEED),
            rates=rates(moved, CONFIGURATIONS, SEED),
            initial=initial_configuration(moved),
            simulate=SECONDS,
            floating=moved.base is Base.FLOATING,
            closures=moved.closures,
            ways=loops.ways,
            held_by_a_point=loops.held_by_a_point,
            driven=loops.driven,
            balls=ball_coordinates(moved),
            universals=universal_coordinates(moved),
            mimics={joint.name: joint.mimic for joint in moved.joints if joint.mimic is not None},
        )
    return asked
