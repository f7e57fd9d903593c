"""The expected observation of a file, and the requests to the engines.

A format represents the robot as lowered by :func:`.lowering.lower`, so its file is compared with that. Loops are
included in the requests for every format, even if the file has only the tree: constraints can be added in the engine.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.observation import Request
from stepbot.robot.closures import Loops, driven_joints, following, held_by_a_point, loop_ways
from stepbot.robot.kinematics import complete, configurations, independent_joints, initial_configuration, rates
from stepbot.robot.model import Base, Robot
from stepbot.robot.multi_dof import ball_coordinates, universal_coordinates
from stepbot.runtime.file import resolved

CONFIGURATIONS = 32
"""Number of random configurations at which poses and dynamics are compared."""
CLOSED_CONFIGURATIONS = 24
"""Number of closed configurations over the range of a mechanism with loops."""
SEED = 20240229
"""Seed of all random configurations; arbitrary but constant."""
REGULAR = 2e-2
"""Ratio of singular values below which loops are near a singularity: a simulation does not hold followers there."""
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


Ways = tuple[tuple[Mapping[str, float], ...], ...]
"""Paths of closed configurations."""


class _Solved(Struct, frozen=True, eq=False):
    """The loops of a robot, solved."""

    robot: Robot
    driven: tuple[str, ...]
    held_by_a_point: tuple[str, ...]
    ways: Ways
    regular: tuple[int, ...]


def _regular(robot: Robot, driven: Sequence[str], ways: Ways) -> Iterator[int]:
    """For each way, the number of configurations before the first one that is near a singularity of the loops."""
    loops = Loops(robot)
    free = following(loops.tree, driven)
    for way in ways:
        J = loops.constraints(np.array([loops.tree.vector(q) for q in way]))[1]
        sizes = np.linalg.svd(J[..., free], compute_uv=False)
        near = sizes[:, -1] < REGULAR * sizes[:, 0] if free else np.zeros(len(way), dtype=bool)
        yield int(np.argmax(near)) if near.any() else len(way)


def _free_followers(robot: Robot, written: Robot) -> Robot:
    """The mechanism without mimics that stand for its loops, which the closures contain already."""
    plain = {joint.child for joint in robot.joints if joint.mimic is None}
    kinds = {joint.child: joint.kind for joint in robot.joints}
    freed = tuple(
        replace(joint, mimic=None)
        if joint.mimic is not None and joint.child in plain and joint.kind is kinds[joint.child]
        else joint
        for joint in written.joints
    )
    return written if not written.closures or freed == written.joints else replace(written, joints=freed)


def _followed(robot: Robot, ways: Ways) -> Ways:
    """Closed configurations with the followers where the mimics of the file have them."""
    leaders = {joint.name for joint in independent_joints(robot)}
    return tuple(
        tuple(complete(robot, {name: value for name, value in q.items() if name in leaders}) for q in way)
        for way in ways
    )


def requests(robot: Robot, lowered: Mapping[str, Robot], files: Mapping[str, Path]) -> dict[str, Request]:
    """The request to the engines, for each format.

    Args:
        lowered: The robot as each format expresses it.

    Raises:
        DoesNotClose: The loops do not close in the drawn pose.
    """
    solved: list[_Solved] = []
    asked = {}
    for name, file in files.items():
        written = mechanism(robot, lowered[name])
        moved = _free_followers(robot, written)
        # Most formats have the same joints and loops: their range is computed once.
        known = [one for one in solved if one.robot.joints == moved.joints and one.robot.closures == moved.closures]
        if not known:
            ways = loop_ways(moved, CLOSED_CONFIGURATIONS, SEED)
            driven = driven_joints(moved)
            regular = tuple(_regular(moved, driven, ways))
            solved.append(_Solved(moved, driven, held_by_a_point(moved), ways, regular))
        loops = (known or solved[-1:])[0]
        asked[name] = Request(
            file=str(resolved(file)),
            format=name,
            configurations=configurations(written, CONFIGURATIONS, SEED),
            rates=rates(moved, CONFIGURATIONS, SEED),
            initial=initial_configuration(moved),
            simulate=SECONDS,
            timestep=robot.simulation.timestep or 1.0,
            floating=moved.base is Base.FLOATING,
            closures=moved.closures,
            ways=_followed(written, loops.ways) if moved is not written else loops.ways,
            regular=loops.regular,
            held_by_a_point=loops.held_by_a_point,
            driven=loops.driven,
            balls=ball_coordinates(moved),
            universals=universal_coordinates(moved),
            mimics={joint.name: joint.mimic for joint in moved.joints if joint.mimic is not None},
        )
    return asked
