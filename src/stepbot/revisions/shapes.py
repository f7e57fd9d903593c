"""Compares two shapes independent of their poses, and computes the motion of a component.

Volume and second moments distinguish solids to a millionth, or to the error of the integrals. They do not distinguish a
part from its mirror image: their bounding boxes do, once both are at one place.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import radians

import numpy as np

from stepbot.geometry.spatial import Array, Pose, turn_inertia

from .snapshot import AREA, EXACT, FREE_FORM, NOTHING, Part, Shape

SAME = 1e-6
"""Relative difference of exact integrals up to which shapes are equal."""
_SAME_FACES = 1e-5
"""The same for shapes with as many faces of each kind: another export of the same solid writes spline edges slightly
differently, by 2.6e-6 for a servo's horn."""
_FREE_FORM = 1e-4
"""The same where faces are splines, too: 3e-5 of a servo's cover."""
PLACE = 1e-6
"""Distance [m] up to which places are equal."""
ANGLE = radians(1e-4)
"""Angle [rad] up to which directions are equal: STEP files may give them with seven digits."""
_COARSE = 5e-3
_OF_MOMENTS = 5.0
"""Factor between the errors of second moments and of volumes: moments grow with the fifth power of a length."""
_BOX = 5e-3
"""Tolerance of a bounding box, as a share of its diagonal: it is that of a mesh."""


def same_shape(a: Shape, b: Shape) -> bool:
    """Whether two fingerprints are of one shape, or of mirror images."""
    if NOTHING in (a.basis, b.basis) or (a.basis == AREA) != (b.basis == AREA):
        return False
    exact = a.basis == b.basis == EXACT
    if not exact and a.faces != b.faces:  # exact numbers are stronger evidence: programs split faces differently
        return False
    tolerance = max(_tolerance(a, b) if exact else _COARSE, a.error + b.error)
    if abs(a.measure - b.measure) > tolerance * max(a.measure, b.measure):
        return False
    ours, theirs = _principal_moments(a), _principal_moments(b)
    return bool(np.abs(ours - theirs).max() <= _OF_MOMENTS * tolerance * max(ours[-1], theirs[-1]))


def same_frame(a: Shape, b: Shape) -> bool:
    """Whether two shapes have the same pose in their definitions, so that the component poses can be compared."""
    tolerance = max(_tolerance(a, b), a.error + b.error) * _OF_MOMENTS
    size = max(_gyration(a), _gyration(b))
    if float(np.linalg.norm(np.subtract(a.com, b.com))) > max(PLACE, tolerance * size):
        return False
    largest = max(float(np.abs(a.tensor).max()), float(np.abs(b.tensor).max()))
    return bool(np.abs(a.tensor - b.tensor).max() <= tolerance * largest)


@lru_cache(maxsize=4096)
def _principal_moments(shape: Shape) -> Array:
    """Shape (3,), smallest first."""
    return np.asarray(np.linalg.eigvalsh(shape.tensor), dtype=np.float64)


@dataclass(frozen=True)
class Motion:
    """The motion of a component."""

    distance: float
    """Of its centroid [m]; for a changed shape, of its frame."""
    angle: float | None
    """[rad]; None if the frames cannot be compared, and the shape has another orientation."""
    X_WW: Pose | None = None
    """The motion in the assembly's frame; None if the frames cannot be compared."""

    @property
    def is_none(self) -> bool:
        """Whether it has not moved."""
        return self.distance <= PLACE and self.angle is not None and self.angle <= ANGLE


def motion(old: Part, old_shape: Shape, new: Part, new_shape: Shape) -> Motion:
    """The motion of a component between two revisions."""
    is_same = same_shape(old_shape, new_shape)
    if not is_same or same_frame(old_shape, new_shape):
        X_WW = new.X_WC @ old.X_WC.inverse()
        angle = old.X_WC.distance_to(new.X_WC)[1]
        start = centroid(old, old_shape) if is_same else np.array(old.position)
        return Motion(float(np.linalg.norm(X_WW.apply(start) - start)), angle, X_WW)
    distance = float(np.linalg.norm(centroid(old, old_shape) - centroid(new, new_shape)))
    ours, theirs = _placed_tensor(old, old_shape), _placed_tensor(new, new_shape)
    tolerance = _OF_MOMENTS * max(_tolerance(old_shape, new_shape), old_shape.error + new_shape.error)
    turned = np.abs(ours - theirs).max() > tolerance * np.abs(ours).max() or not same_box(old, new)
    return Motion(distance, None if turned else 0.0)


def at_same_place(old: Part, old_shape: Shape, new: Part, new_shape: Shape) -> bool:
    """Whether two components of the same shape fill the same space."""
    return motion(old, old_shape, new, new_shape).is_none and same_box(old, new)


def centroid(part: Part, shape: Shape) -> Array:
    """Centroid (3,) [m] in the assembly's frame."""
    return part.X_WC.apply(shape.com)


def same_box(a: Part, b: Part) -> bool:
    """Whether the bounding boxes of two parts are equal, within the accuracy of their meshes."""
    allowed = max(PLACE, _BOX * max(a.diagonal, b.diagonal))
    return bool(np.abs(np.subtract(a.box, b.box)).max() <= allowed)


def _tolerance(a: Shape, b: Shape) -> float:
    """Relative difference of exact integrals up to which two shapes are equal."""
    if a.faces != b.faces:
        return SAME
    return _FREE_FORM if FREE_FORM in dict(a.faces) else _SAME_FACES


def _placed_tensor(part: Part, shape: Shape) -> Array:
    return turn_inertia(part.X_WC.R, shape.tensor)


def _gyration(shape: Shape) -> float:
    return float(np.sqrt(np.trace(shape.tensor) / (2.0 * shape.measure))) if shape.measure else 0.0
