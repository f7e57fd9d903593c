"""Directions along the axes of a frame by name: ``y`` and ``-y``."""

from typing import Literal, get_args

import numpy as np

from .spatial import Array

Direction = Literal["z", "-z", "y", "-y", "x", "-x"]
"""An axis of a frame, or its opposite."""
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)


def vector(direction: Direction) -> Array:
    """Unit vector of a direction, shape (3,)."""
    unit = np.zeros(3)
    unit["xyz".index(direction[-1])] = -1.0 if direction.startswith("-") else 1.0
    return unit


def rotation_of(up: Direction, forward: Direction) -> Array:
    """Rotation R_WL (3, 3) of a frame L whose z points up in W and whose x points forward."""
    z, x = vector(up), vector(forward)
    return np.column_stack([x, np.cross(z, x), z]) + 0.0
