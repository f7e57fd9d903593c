"""Mass matrix, gravity forces and inverse dynamics of a robot, from the Jacobians of its links: the reference.

The base is fixed, loops are open, and a mimicking joint is a coordinate like any other: as in the engines. The inertia
of actuators (armature) is left out, because URDF and SDFormat cannot express it; it is compared separately. The
formulas are the plain sums over links (Murray, Li, Sastry 1994, eq. 4.19 and 4.24) and not a recursion, so that they
share no step with the algorithms of the engines that they verify.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Vector3, cross, matrix_product, rotated, turn_inertia

from .kinematics import Configuration, Tree, complete
from .mesh_names import free_name
from .model import Base, Joint, JointKind, Link, Robot
from .multi_dof import split, unfolded

_SINGULAR = 1e-12
"""Share of its own inertia below which what a joint moves beyond the other joints is rounding."""
_MOST_ENTRIES = 200_000
"""Columns of Jacobians that are computed at once: links times joints times configurations."""
GRAVITY: Vector3 = (0.0, 0.0, -9.81)
"""Acceleration of gravity [m/s^2] for computing and observing gravity forces."""

Rates = tuple[Mapping[str, float], Mapping[str, float]]
"""Velocities and accelerations by name; missing ones are 0."""


class Equations(Struct, frozen=True, eq=False):
    """The equations of motion at one configuration, in the order of :func:`kinematics.moving_joints`."""

    mass_matrix: Array
    """M(q), shape (n, n) [kg, kg m, kg m^2]."""
    gravity: Array
    """Efforts (n,) [N m] or [N] that hold the robot at rest."""
    inverse: Array
    """Efforts (n,) [N m] or [N] for the given motion: M(q) a + C(q, v) v + g(q)."""


def equations_of_motion(
    robot: Robot, q: Configuration, rates: Rates = ({}, {}), *, gravity: Vector3 = GRAVITY, tree: Tree | None = None
) -> Equations:
    """Mass matrix, gravity forces and inverse dynamics at one configuration; see :func:`equations_at`."""
    return equations_at(robot, [(q, rates)], gravity=gravity, tree=tree)[0]


def equations_at(
    robot: Robot,
    moments: Sequence[tuple[Configuration, Rates]],
    *,
    gravity: Vector3 = GRAVITY,
    tree: Tree | None = None,
) -> list[Equations]:
    """Mass matrix, gravity forces and inverse dynamics at several configurations, each bit for bit as alone.

    Args:
        moments: Positions [rad] or [m], completed first, with velocities [rad/s], [m/s] and accelerations [rad/s^2],
            [m/s^2].
        gravity: Acceleration of gravity [m/s^2].
        tree: The robot's tree, if already computed.

    Raises:
        KeyError: A configuration contains a name that is not a moving joint.
    """
    tree = tree or Tree(robot)
    at_once = max(1, _MOST_ENTRIES // max(1, len(robot.links) * len(tree.joints)))
    return [
        equation
        for start in range(0, len(moments), at_once)
        for equation in _equations(robot, moments[start : start + at_once], gravity, tree)
    ]


def _equations(
    robot: Robot, moments: Sequence[tuple[Configuration, Rates]], gravity: Vector3, tree: Tree
) -> Iterator[Equations]:
    positions = [complete(robot, q) for q, _ in moments]
    X = tree.frames(np.array([[q[name] for name in tree.joints] for q in positions]))
    v, a = (
        np.array([[float(rates[which].get(name, 0.0)) for name in tree.joints] for _, rates in moments])
        for which in (0, 1)
    )
    links = [tree.link_index[link.name] for link in robot.links]
    bodies = [link.mass_properties for link in robot.links]
    X_WL = X[:, links]
    R_WL, p_WL = X_WL[..., :3, :3], X_WL[..., :3, 3]
    p_WLcm = p_WL + rotated(R_WL, np.array([body.com for body in bodies]))
    I_W = turn_inertia(R_WL, np.array([body.inertia for body in bodies]))
    mass = np.array([body.mass for body in bodies])[:, None]
    J = tree.jacobian(X, links, p_WLcm)
    momenta = np.concatenate([matrix_product(I_W, J[..., :3, :]), mass[:, None] * J[..., 3:, :]], axis=-2)
    M = np.zeros((len(moments), len(tree.joints), len(tree.joints)))
    for i, link in enumerate(links):
        on = tree.above(link)
        M[:, on[:, None], on] += matrix_product(J[:, i][..., on].swapaxes(-1, -2), momenta[:, i][..., on])
    M = 0.5 * (M + M.swapaxes(-1, -2))
    g = -_efforts(J[..., 3:, :], mass * np.array(gravity))
    c = np.zeros_like(g)
    if v.any():
        turning, moving = tree.bias(X, v, links, p_WLcm)
        w_WL = (J[..., :3, :] * v[:, None, None]).sum(axis=-1)
        torques = rotated(I_W, turning) + cross(w_WL, rotated(I_W, w_WL))
        c = _efforts(J, np.concatenate([torques, mass * moving], axis=-1))
    return map(Equations, M, g, (M * a[:, None]).sum(axis=-1) + c + g)


def mobilities(robot: Robot) -> dict[str, float]:
    """Acceleration [rad/s^2] or [m/s^2] that an effort of 1 gives each moving joint at q = 0, if all others are free.

    Raises:
        numpy.linalg.LinAlgError: A joint moves no mass.
    """
    names, M = free_mass_matrix(robot)
    return dict(zip(names, _inverse_diagonal(M).tolist(), strict=True))


def free_mass_matrix(robot: Robot) -> tuple[tuple[str, ...], Array]:
    """The joints and their mass matrix (n, n) at q = 0 if nothing couples them.

    The base moves if it floats, followers follow nothing, the two joints of a screw are two, and armatures count.
    """
    free = unfolded(split(robot, JointKind.SCREW))
    free = replace(free, joints=tuple(replace(joint, mimic=None) for joint in free.joints))
    if robot.base is Base.FLOATING:
        world = Link(free_name("world", "_link", set(robot.link_by_name)))
        name = free_name("base", "_joint", set(free.joint_by_name))
        base = Joint(name, JointKind.FLOATING, world.name, robot.root.name)
        free = replace(free, links=(world, *free.links), joints=(base, *free.joints))
    tree = Tree(free)
    M = equations_of_motion(free, {}, tree=tree).mass_matrix
    armature = {joint.name: joint.dynamics.armature for joint in free.joints}
    return tuple(tree.joints), M + np.diag([armature.get(name, 0.0) for name in tree.joints])


def _inverse_diagonal(M: Array) -> Array:
    """Diagonal (n,) of the inverse of a positive definite matrix (n, n), by elimination without BLAS: it is written.

    Rows and columns are scaled first, so that light joints on heavy links keep their digits.
    """
    if not (M.diagonal() > 0.0).all():
        raise np.linalg.LinAlgError("a joint moves no mass")
    scale = 1.0 / np.sqrt(M.diagonal())
    left, inverse = M * scale[:, None] * scale, np.eye(len(M))
    for k in range(len(M)):
        pivot = left[k, k]
        if not pivot > _SINGULAR:
            raise np.linalg.LinAlgError("joints move no mass")
        row, own = left[k] / pivot, inverse[k] / pivot
        column = left[:, k].copy()
        left -= column[:, None] * row
        inverse -= column[:, None] * own
        left[k], inverse[k] = row, own
    return np.asarray(inverse.diagonal() * scale**2)


def _efforts(J: Array, forces: Array) -> Array:
    """Efforts (..., n) of joints for forces and torques (..., m, k) on links with the Jacobians J (..., m, k, n)."""
    return np.asarray((J * forces[..., None]).sum(axis=(-3, -2)))
