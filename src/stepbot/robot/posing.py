"""A robot at given joint positions: mimics follow, and loops are closed on the way from the drawn pose."""

from collections.abc import Mapping, Sequence

from .closures import Loops, close_loops, independent_columns, walk
from .kinematics import Configuration, complete, initial_configuration, mimic_relation, moving_joints
from .model import Joint, Robot


class NotReached(ValueError):
    """The loops cannot be closed at the given positions.

    Attributes:
        reached: Positions of the given joints where the path from the drawn pose ends.
    """

    def __init__(self, reached: Mapping[str, float]) -> None:
        self.reached = dict(reached)


def coordinates(robot: Robot) -> dict[str, Joint]:
    """The joints of one degree of freedom that a pose may name, and the coordinates of multi-dof joints."""
    return {joint.name: joint for joint in moving_joints(robot)}


def leader_of(robot: Robot, name: str) -> str:
    """The joint that a coordinate follows; itself if it follows none."""
    return mimic_relation(robot, name)[0]


def posed(robot: Robot, configuration: Configuration) -> dict[str, float]:
    """Positions of all moving joints with some at given positions and the others as drawn, or as loops require.

    The given joints move on a straight path from the drawn pose, so that the mechanism stays on its branch; other
    joints that can be driven keep their positions if the loops allow.

    Args:
        configuration: Positions [rad] or [m] by coordinate; not of mimics.

    Raises:
        KeyError: A name is not that of a moving joint.
        NotReached: The loops do not close there.
    """
    drawn = initial_configuration(robot)
    if not robot.closures:
        return complete(robot, {**drawn, **configuration})
    complete(robot, configuration)  # for its KeyError
    loops = Loops(robot)
    free = _followers(loops, drawn, list(configuration))
    held = [name for i, name in enumerate(loops.tree.independent) if i not in free]
    start = loops.tree.vector(close_loops(robot, drawn, held))
    way = walk(loops, start, free, configuration) if configuration else []
    reached = loops.tree.named(way[-1] if way else start)
    if any(abs(reached[name] - value) > 1e-9 for name, value in configuration.items()):
        raise NotReached({name: reached[name] for name in configuration})
    return reached


def _followers(loops: Loops, configuration: Configuration, given: Sequence[str]) -> list[int]:
    """Indices of the independent joints that follow from the others: joints that are not given, the last ones first."""
    names = loops.tree.independent
    _, J = loops.constraints(loops.tree.vector(configuration))
    return independent_columns(J, (i for i in reversed(range(len(names))) if names[i] not in given))
