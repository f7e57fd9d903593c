"""Totals of each component of an assembly, including its subtree."""

from dataclasses import dataclass

from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import Array, Vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import Assembly, Body, BodyKind

Box = tuple[Vector3, Vector3]


@dataclass
class Contents:
    """Totals of a component and its subtree."""

    solids: int = 0
    surfaces: int = 0
    """Number of bodies with a surface that encloses no volume."""
    volume: float = 0.0
    """[m^3]."""
    box: Box | None = None
    """Lowest and highest corner [m], along the axes of the assembly; None without geometry."""

    @property
    def center(self) -> Vector3 | None:
        """Centre of the bounding box [m], as in an origin ``{center: PATH}``."""
        if self.box is None:
            return None
        (a, b, c), (x, y, z) = self.box
        return ((a + x) / 2, (b + y) / 2, (c + z) / 2)

    @property
    def size(self) -> Vector3 | None:
        """Extent of the bounding box [m] along the axes of the assembly."""
        if self.box is None:
            return None
        (a, b, c), (x, y, z) = self.box
        return (x - a, y - b, z - c)

    def add(self, other: "Contents") -> None:
        """Add the totals of a child."""
        self.solids += other.solids
        self.surfaces += other.surfaces
        self.volume += other.volume
        self.box = _joined(self.box, other.box) if self.box and other.box else self.box or other.box


def contents(assembly: Assembly, measures: tuple[VolumeProperties | None, ...]) -> list[Contents]:
    """Totals of each component.

    Args:
        assembly: The assembly.
        measures: Mass properties of the mesh of each body.
    """
    found = [Contents() for _ in assembly.components]
    for number, indices in assembly.occurrences.items():
        body = assembly.bodies[number]
        own = volume(body, measures[number])
        is_solid = body.kind is BodyKind.SOLID or (body.kind is BodyKind.TESSELLATED and own > 0.0)
        is_surface = not is_solid and body.kind is not BodyKind.WIRE
        boxes: list[Box | None] = [None] * len(indices)
        if len(body.mesh.vertices):
            corners = bounds_at(body.mesh.vertices, Poses.of(assembly.components[index].X_WC for index in indices))
            boxes = list(zip(*(_vectors(corner) for corner in corners), strict=True))
        for index, box in zip(indices, boxes, strict=True):
            found[index] = Contents(int(is_solid), int(is_surface), own, box)
    for component in reversed(assembly.components[1:]):
        found[component.parent].add(found[component.index])
    return found


def _vectors(rows: Array) -> list[Vector3]:
    """The rows of an array (n, 3)."""
    return [(x, y, z) for x, y, z in rows.tolist()]


def _joined(a: Box, b: Box) -> Box:
    """The box around two boxes, without arrays: there may be 10,000 components."""
    x, y, z = map(min, a[0], b[0])
    u, v, w = map(max, a[1], b[1])
    return (x, y, z), (u, v, w)


def volume(body: Body, measured: VolumeProperties | None) -> float:
    """Volume [m^3] of a body: the exact one, else that of a closed mesh, else 0."""
    if body.exact is not None:
        return body.exact.volume
    return measured.volume if measured is not None else 0.0
