"""The vertical axis of an assembly, inferred from the flat face it stands on.

A file does not say which way is up. Most robots stand on a flat face of their base. If there is none towards -z, but a
large one towards another side, the CAD was probably drawn with another axis up.
"""

from collections.abc import Collection, Sequence

import numpy as np
from msgspec import Struct

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.inertia import DIRECTIONS, Direction, vector
from stepbot.geometry.mesh import triangle_areas
from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import Array, Vector3

from ..assembly import Assembly

_FLAT = 1e-4
"""Thickness of the ground plane, as a fraction of the assembly's diagonal."""
_LARGE = 0.08
"""Fraction of the assembly's footprint from which a flat face is one to stand on; robots have 0.1 to 1."""
_OTHER = 0.25
"""Fraction of that face's size from which one above or below is a rival."""
_OF_BASE = 0.9
"""Fraction of the ground's area that belongs to the base."""
_TALL = 2.0 / 3.0
"""Minimum height of the assembly as a fraction of its extent along z: what hangs on a wall is lower."""
_PLATE, _FLAT_TALL = 0.3, 0.4
"""Share of the footprint from which the flat face is a base plate, and the minimum height on one."""
_PARALLEL = 1e-2
"""Maximum angle [rad] between a joint's axis and the vertical."""


class Standing(Struct, frozen=True):
    """Evidence that an axis other than z is up."""

    up: Direction
    share: float
    """Area of the flat face below, as a fraction of the assembly's footprint."""

    def __str__(self) -> str:
        opposite = self.up.removeprefix("-") if self.up.startswith("-") else f"-{self.up}"
        size = f"{100 * self.share:.0f} % of the footprint"
        axis = self.up.removeprefix("-")
        return f"its base has a flat face of {size} towards {opposite}, and a joint on it is along {axis}"


def standing(assembly: Assembly, base: Collection[int], axes: Sequence[Vector3]) -> Standing | None:
    """The vertical axis, if it is probably not z; None if it may be z, or is unclear.

    Args:
        base: Indices of the components of the root link.
        axes: Unit axes of the joints on it, in the assembly's frame.
    """
    if not any(_is_along(up, axes) for up in DIRECTIONS if up[-1] != "z"):
        return None
    sides = _Sides(assembly, frozenset(base))
    if sides.is_empty:
        return None
    shares = {up: sides.ground(up) for up in DIRECTIONS}
    candidates = [up for up in DIRECTIONS if up[-1] != "z" and shares[up][0] >= _LARGE and shares[up][1] >= _OF_BASE]
    if not candidates:
        return None
    up = max(candidates, key=lambda one: shares[one][0])
    share = shares[up][0]
    rivals = [other for other in DIRECTIONS if other != up and shares[other][0] >= _OTHER * share]
    height, across = sides.size["xyz".index(up[-1])], sides.size[2]
    least = _FLAT_TALL if share >= _PLATE else _TALL
    return None if rivals or height < least * across or not _is_along(up, axes) else Standing(up, share)


def grounds(assembly: Assembly) -> dict[Direction, dict[int, float]]:
    """For each direction that may be up, what lies flat below: by component, its share of the assembly's footprint."""
    sides = _Sides(assembly, frozenset())
    return {} if sides.is_empty else {up: sides.shares(up) for up in DIRECTIONS}


def _is_along(up: Direction, axes: Sequence[Vector3]) -> bool:
    return any(abs(float(vector(up) @ np.array(axis))) > np.cos(_PARALLEL) for axis in axes)


class _Sides:
    """The meshes of an assembly, and what lies in the planes around it."""

    def __init__(self, assembly: Assembly, base: frozenset[int]) -> None:
        self._assembly, self._base = assembly, base
        parts = {body: of for body, of in assembly.occurrences.items() if len(assembly.bodies[body].mesh.faces)}
        self.is_empty = not parts
        if not self.is_empty:
            poses = {body: Poses.of(assembly.components[i].X_WC for i in of) for body, of in parts.items()}
            boxes = [bounds_at(assembly.bodies[body].mesh.vertices, placed) for body, placed in poses.items()]
            self._parts = [index for indices in parts.values() for index in indices]
            self._lowest, self._highest = (np.concatenate(corners) for corners in zip(*boxes, strict=True))
            self._low, self._high = self._lowest.min(axis=0), self._highest.max(axis=0)
            self.size: Array = self._high - self._low

    def ground(self, up: Direction) -> tuple[float, float]:
        """Area of the flat faces at the bottom as a fraction of the footprint, and the base's fraction of it."""
        shares = self.shares(up)
        total, of_base = (
            exact_sum(shares.values()),
            exact_sum(share for index, share in shares.items() if index in self._base),
        )
        return (total, of_base / total) if total > 0.0 else (0.0, 0.0)

    def shares(self, up: Direction) -> dict[int, float]:
        """Area of each component's flat faces at the bottom, as a fraction of the footprint."""
        along = "xyz".index(up[-1])
        level = self._high[along] if up.startswith("-") else self._low[along]
        nearest = self._highest[:, along] if up.startswith("-") else self._lowest[:, along]
        near = _FLAT * float(np.linalg.norm(self.size))
        footprint = float(np.prod(np.delete(self.size, along)))
        shares: dict[int, float] = {}
        for index in sorted(self._parts[i] for i in np.flatnonzero(np.abs(nearest - level) < near).tolist()):
            component = self._assembly.components[index]
            mesh = self._assembly.bodies[component.body].mesh
            points, faces = component.X_WC.apply(mesh.vertices), mesh.faces
            is_on = np.abs(points[:, along] - level) < near
            if footprint > 0.0:
                shares[index] = float(triangle_areas(points[faces[is_on[faces].all(axis=1)]]).sum()) / footprint
        return shares
