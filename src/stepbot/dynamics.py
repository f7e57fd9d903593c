"""Mass matrix and gravity forces of a robot, from the Jacobians of its links: the reference for every engine.

The base stands still, loops are open, and a mimicking joint is a coordinate like any other: that is what engines
compute too. The inertia of drives (armature) is left out, because URDF and SDFormat cannot say it; it is compared as a
number of its own. The formulas are the plain sums over links (Murray, Li, Sastry 1994, eq. 4.19 and 4.24) and not a
recursion, so that they share no step with the algorithms of the engines that they judge.
"""

import numpy as np

from .kinematics import Configuration, Tree, complete
from .model import Robot
from .spatial import Array, Vector3, turn_inertia

GRAVITY: Vector3 = (0.0, 0.0, -9.81)
"""Acceleration of gravity [m/s^2] that gravity forces are computed and observed with."""


def mass_matrix(robot: Robot, q: Configuration) -> Array:
    """Joint-space inertia M(q), shape (n, n) [kg, kg m, kg m^2], in the order of :func:`kinematics.moving_joints`."""
    return equations_of_motion(robot, q)[0]


def gravity_forces(robot: Robot, q: Configuration, gravity: Vector3 = GRAVITY) -> Array:
    """Efforts (n,) [N m] or [N] that hold the robot still at q against ``gravity`` [m/s^2]."""
    return equations_of_motion(robot, q, gravity)[1]


def equations_of_motion(
    robot: Robot, q: Configuration, gravity: Vector3 = GRAVITY, tree: Tree | None = None
) -> tuple[Array, Array]:
    """Mass matrix (n, n) and gravity forces (n,) at one configuration.

    Args:
        robot: The robot.
        q: Positions [rad] or [m]; completed first.
        gravity: Acceleration of gravity [m/s^2].
        tree: The robot's tree, where the caller has it already.
    """
    tree = tree or Tree(robot)
    full = complete(robot, q)
    X = tree.frames(np.array([full[name] for name in tree.joints]))
    M = np.zeros((len(tree.joints),) * 2)
    g = np.zeros(len(tree.joints))
    for link in robot.links:
        i, body = tree.link_index[link.name], link.mass_properties
        R_WL, p_WL = X[i, :3, :3], X[i, :3, 3]
        J = tree.jacobian(X, i, p_WL + R_WL @ np.array(body.com))
        M += J[:3].T @ turn_inertia(R_WL, body.inertia) @ J[:3] + body.mass * J[3:].T @ J[3:]
        g -= body.mass * J[3:].T @ np.array(gravity)
    return 0.5 * (M + M.T), g
