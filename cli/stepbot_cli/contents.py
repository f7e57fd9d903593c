"""Totals of each component of an assembly, including its subtree."""

from dataclasses import dataclass

from stepbot.geometry.spatial import Vector3, bounds, join_bounds
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
        boxes = [box for box in (self.box, other.box) if box is not None]
        self.box = join_bounds(boxes) if boxes else None


def contents(assembly: Assembly, measures: tuple[VolumeProperties | None, ...]) -> list[Contents]:
    """Totals of each component.

    Args:
        assembly: The assembly.
        measures: Mass properties of the mesh of each body.
    """
    found = []
    for component in assembly.components:
        own = Contents()
        if component.body >= 0:
            body = assembly.bodies[component.body]
            own.volume = volume(body, measures[component.body])
            own.solids = int(body.kind is BodyKind.SOLID or (body.kind is BodyKind.TESSELLATED and own.volume > 0.0))
            own.surfaces = int(not own.solids and body.kind is not BodyKind.WIRE)
            if len(body.mesh.vertices):
                own.box = bounds(component.X_WC.apply(body.mesh.vertices))
        found.append(own)
    for component in reversed(assembly.components[1:]):
        found[component.parent].add(found[component.index])
    return found


def volume(body: Body, measured: VolumeProperties | None) -> float:
    """Volume [m^3] of a body: the exact one, else that of a closed mesh, else 0."""
    if body.exact is not None:
        return body.exact.volume
    return measured.volume if measured is not None else 0.0
