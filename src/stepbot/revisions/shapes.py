"""Compares two shapes independent of their poses, computes the motion of a component, and words differences.

Volume and second moments distinguish solids to a millionth, or to the error of the integrals. They do not distinguish a
part from its mirror image: their bounding boxes do, once both are at one place.
"""

from functools import lru_cache
from math import degrees, radians

import numpy as np
from msgspec import Struct

from stepbot.assemble.bound import PlacedJoint
from stepbot.geometry.spatial import Array, Pose, angle_between, turn_inertia

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


class Motion(Struct, frozen=True):
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


def moved_words(motion: Motion) -> str:
    """``moved by 12 mm and turned by 5 deg``."""
    words = []
    if motion.distance > PLACE:
        words.append(f"moved by {length(motion.distance)}")
    if motion.angle is None:
        words.append("turned")
    elif motion.angle > ANGLE:
        words.append(f"turned by {angle(motion.angle)}")
    return " and ".join(words)


def common_words(X_WW: Pose) -> str:
    """The motion of a whole assembly."""
    return moved_words(Motion(X_WW.distance_to(Pose())[0], X_WW.distance_to(Pose())[1])) or "did not move"


def shape_words(old: Shape, new: Shape) -> str:
    """``volume 12.3 -> 12.9 cm^3 (+4.9 %)``; the number of faces if the size is the same."""
    if old.basis != new.basis:
        return f"from {_kind_words(old)} to {_kind_words(new)}"
    noun, unit, scale = ("area", "cm^2", 1e4) if new.basis == AREA else ("volume", "cm^3", 1e6)
    before, after = (sum(count for _, count in shape.faces) for shape in (old, new))
    faces = f", {before} -> {after} faces" if before != after else ""
    if f"{old.measure:.6g}" == f"{new.measure:.6g}":
        return f"{noun} {new.measure * scale:.6g} {unit} as before, but other moments{faces}"
    return f"{noun} {change(old.measure * scale, new.measure * scale, unit)}{faces}"


def mass_words(old: float, new: float) -> str:
    """``mass 33 -> 34.8 g (+5.5 %)``."""
    scale, unit = (1.0, "kg") if max(old, new) >= 1.0 else (1e3, "g")
    return f"mass {change(old * scale, new * scale, unit)}"


def stuff_words(old: Part, new: Part) -> str:
    """``density 2700 -> 7850 kg/m^3 (+191 %)``, ``material 'steel' -> 'brass'``; empty if both are the same."""
    words = []
    if old.material != new.material:
        words.append(f"material '{old.material}' -> '{new.material}'")
    if old.density != new.density:
        words.append(f"density {change(old.density, new.density, 'kg/m^3')}")
    return ", ".join(words)


def change(old: float, new: float, unit: str) -> str:
    """Two different numbers, with as many digits as needed, and their difference."""
    digits = next((n for n in range(4, 12) if f"{old:.{n}g}" != f"{new:.{n}g}"), 12)
    share = f" ({100.0 * (new - old) / old:+.3g} %)" if old else ""
    return f"{old:.{digits}g} -> {new:.{digits}g} {unit}".rstrip() + share


def length(value: float) -> str:
    """A length [m] in millimetres."""
    return f"{value * 1e3:.4g} mm"


def angle(value: float) -> str:
    """An angle [rad] in degrees."""
    return f"{degrees(value):.4g} deg"


def _kind_words(shape: Shape) -> str:
    return "a surface" if shape.basis == AREA else "a solid" if shape.measure else "no geometry"


def axis_words(old: PlacedJoint, new: PlacedJoint, common: Pose) -> str:
    """How a joint has moved, for messages; empty if it has not.

    Args:
        common: The motion of the whole assembly, which is subtracted.
    """
    start, end = common.apply(old.origin), np.array(new.origin)
    shift = end - start
    if old.axis is None or new.axis is None:
        distance = float(np.linalg.norm(shift))
        return f"origin moved by {length(distance)}" if distance > PLACE else ""
    before, after = common.turn(old.axis), np.array(new.axis)
    turned = angle_between(before, after)
    along = float(shift @ after)
    across = float(np.linalg.norm(shift - along * after))
    words = []
    if across > PLACE:
        words.append(f"moved by {length(across)}")
    if turned > ANGLE:
        words.append(f"turned by {angle(turned)}")
    if words:
        return f"axis {' and '.join(words)}"
    return f"origin moved by {length(abs(along))} along its axis" if abs(along) > PLACE else ""
