"""How far joints of closed loops move by the gaps that an engine leaves in the loops."""

from collections.abc import Sequence
from math import inf

import numpy as np

from .closures import Loops, following
from .kinematics import Configuration
from .model import Robot


def loop_sensitivity(robot: Robot, configurations: Sequence[Configuration], driven: Sequence[str]) -> float:
    """Largest motion [rad/m], [m/m] of the following joints per gap of the loops.

    It is the inverse of the least singular value of the Jacobian of the closures: next to a dead centre, a small gap
    leaves room for a large motion.

    Args:
        robot: The robot.
        configurations: Closed configurations.
        driven: The joints that do not move with the gaps.
    """
    if not (configurations and robot.closures):
        return 0.0
    loops = Loops(robot)
    free = following(loops.tree, driven)
    if not free:
        return 0.0
    _, J = loops.constraints(np.array([loops.tree.vector(q) for q in configurations]))
    sizes = np.linalg.svd(J[..., free], compute_uv=False)
    least = float(sizes[:, -1].min()) if sizes.shape[-1] == len(free) else 0.0
    return loops.per_length / least if least > 0.0 else inf
