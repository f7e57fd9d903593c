"""Parts and their mirror images: which have a twin on the other side of a plane, and whether twins weigh the same."""

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array, join_bounds

from .bounding_boxes import mesh_bounds, primitive_bounds
from .kinematics import initial_configuration, link_poses
from .model import MeshRef, Robot

AXES = "xyz"
_NEAR = 0.01
"""Share of the robot's size within which the boxes of twins coincide."""


class Part(Struct, frozen=True):
    """A part in the drawn pose, in the frame of the root link."""

    name: str
    """Path of its component, or name of its link for a robot without components."""
    link: str
    mass: float
    """[kg]."""
    low: Array
    """Lowest corner (3,) [m] of its box."""
    high: Array
    """Highest corner (3,) [m]."""

    @property
    def center(self) -> Array:
        """Middle (3,) [m] of its box."""
        return 0.5 * (self.low + self.high)


class Twins(Struct, frozen=True):
    """Two parts on both sides of a plane."""

    a: Part
    b: Part

    @property
    def difference(self) -> float:
        """Difference of the masses as a share of the larger one."""
        larger = max(self.a.mass, self.b.mass)
        return abs(self.a.mass - self.b.mass) / larger if larger else 0.0


class Symmetry(Struct, frozen=True):
    """A robot against its mirror image."""

    twins: tuple[Twins, ...]
    alone: tuple[Part, ...]
    """Parts beside the plane without a twin, those that move the centre of mass most first."""
    size: float
    """Diagonal [m] of the box around all parts."""
    offset: float
    """How far [m] the robot's centre of mass is from the plane, with its sign."""


def mirrored(robot: Robot, axis: str) -> Symmetry:
    """The parts of a robot in its drawn pose that have a twin beyond the plane through the root's origin, or none.

    Args:
        axis: Normal of the plane in the frame of the root link: x, y or z.
    """
    k, pieces = AXES.index(axis), tuple(parts(robot))
    if not pieces:
        return Symmetry((), (), 0.0, _offset(robot, k))
    size = float(np.linalg.norm(np.max([one.high for one in pieces], 0) - np.min([one.low for one in pieces], 0)))
    near, left, twins, alone = _NEAR * size, list(pieces), list[Twins](), list[Part]()
    while left:
        one = left.pop(0)
        low, high = one.low.copy(), one.high.copy()
        low[k], high[k] = -one.high[k], -one.low[k]
        if abs(low[k] - one.low[k]) <= near and abs(high[k] - one.high[k]) <= near:
            continue  # it lies across the plane
        apart = [max(np.abs(low - other.low).max(), np.abs(high - other.high).max()) for other in left]
        if apart and min(apart) <= near:
            other = left.pop(int(np.argmin(apart)))
            first, second = sorted((one, other), key=lambda part: part.name)
            twins.append(Twins(first, second))
        else:
            alone.append(one)
    alone.sort(key=lambda part: (-part.mass * abs(float(part.center[k])), part.name))
    return Symmetry(tuple(twins), tuple(alone), size, _offset(robot, k))


def _offset(robot: Robot, k: int) -> float:
    mass, com = whole(robot)
    return float(com[k]) if mass else 0.0


def whole(robot: Robot) -> tuple[float, Array]:
    """Mass [kg] and centre of mass (3,) [m] of a robot in its drawn pose, in the frame of the root link."""
    X = link_poses(robot, initial_configuration(robot))
    masses = np.array([link.mass_properties.mass for link in robot.links])
    coms = np.array([X[link.name].apply(np.array([link.mass_properties.com]))[0] for link in robot.links])
    total = float(masses.sum())
    return total, (masses @ coms) / total if total else np.zeros(3)


def parts(robot: Robot) -> Iterator[Part]:
    """The parts that are drawn, each with the box of its visuals; links as wholes where components are unknown."""
    X = link_poses(robot, initial_configuration(robot))
    for link in robot.links:
        weights = {one.component: one.mass or 0.0 for one in link.masses if one.component}
        boxes: dict[str, list[tuple[Sequence[float], Sequence[float]]]] = {}
        for visual in link.visuals:
            X_RG, shape = X[link.name] @ visual.X_LG, visual.geometry
            is_mesh = isinstance(shape, MeshRef)
            box = mesh_bounds(robot.mesh_by_name[shape.name].mesh.vertices, X_RG) if is_mesh else None  # type: ignore[union-attr]
            boxes.setdefault(visual.component if weights else link.name, []).append(
                box or primitive_bounds(shape, X_RG)  # type: ignore[arg-type]
            )
        for name, of_part in boxes.items():
            low, high = join_bounds(of_part)  # type: ignore[arg-type]
            mass = weights.get(name, 0.0) if weights else link.mass_properties.mass
            yield Part(name, link.name, mass, np.array(low), np.array(high))
