"""Faces of a body, as needed to find contacts: planes with their outline, surfaces of revolution, spheres.

Independent of the geometry kernel. Lengths are in metres, in the frame of the definition.
"""

from enum import StrEnum

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Vector3, vector3


class FaceKind(StrEnum):
    """The surface type of a face, recognized even if the file has it as a B-spline."""

    PLANE = "plane"
    CYLINDER = "cylinder"
    CONE = "cone"
    SPHERE = "sphere"
    TORUS = "torus"
    OTHER = "other"


class Face(Struct, frozen=True, eq=False):
    """One face of a body."""

    kind: FaceKind
    point: Vector3
    """For a plane, on it; otherwise on the axis, in the middle of the face; the centre of a sphere or a torus."""
    direction: Vector3
    """Unit vector: outward normal of a plane, axis of the others; z if there is none."""
    box: tuple[Vector3, Vector3]
    """Lowest and highest corner."""
    radius: float = 0.0
    """For a cone the larger one, for a torus that of its centre line."""
    length: float = 0.0
    """Extent along the axis, half of it on either side of ``point``."""
    bore: bool = False
    """Whether material is outside of a cylinder, a cone or a sphere."""
    span: float = 0.0
    """Angle about the axis that it covers [rad]."""
    rings: tuple[Array, ...] = ()
    """Outline of a plane as closed rings of points (n, 3), the outer one first."""

    def scaled(self, factors: Array, scale: float) -> "Face":
        """This face in a mirrored or scaled occurrence; ``factors`` (3,) are the scale with signs."""
        corners = np.sort(np.array(self.box) * factors, axis=0)
        return replace(
            self,
            point=vector3(np.array(self.point) * factors),
            direction=vector3(np.array(self.direction) * factors / scale),
            box=(vector3(corners[0]), vector3(corners[1])),
            radius=self.radius * scale,
            length=self.length * scale,
            rings=tuple(ring * factors for ring in self.rings),
        )
