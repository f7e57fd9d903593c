"""Whether two numbers of a description mean the same in other words: directions, rotations, ends of a segment.

No tolerance of an engine takes part: what is not the same but for rounding of the last digits differs.
"""

from collections.abc import Callable, Mapping, Sequence
from math import radians

import numpy as np

from stepbot.engines.description.statements import Statement
from stepbot.geometry.spatial import (
    Array,
    cross,
    dot,
    length,
    matrix_product,
    rotation_about,
    rotation_from_quaternion,
    unit,
)

Statements = Mapping[str, Statement]

_TURNED = 1e-14
"""Rounding of a rotation matrix, of angles of a few turns."""
OF_MESHES = ("area", "centroid", "gyration_radius")
"""What is stated of the surface in a mesh file."""
_RESHAPED = 1e-6
"""Rounding of the vertices of a surface, relative to its size: that of single precision, and of six digits."""
_DIRECTIONS = ("axis@xyz", "axis/xyz", "axis2/xyz", "@axis", "@zaxis", "@dir")
_FIXED_AXES = "XYZ"
"""Roll, pitch and yaw, as a sequence of MJCF: capitals turn about fixed axes."""


def means_the_same(place: str, ours: str, theirs: str, statements: Statements) -> bool:
    """Whether two texts at one place have the same meaning.

    Args:
        ours: The text of one file.
        theirs: That of the other file.
        statements: What the file states elsewhere: units and sequences of angles.
    """
    a, b = (numbers(text) or [] for text in (ours, theirs))
    meaning = _direction if place.endswith(_DIRECTIONS) else _MEANINGS.get(last_of(place))
    if meaning is None or len(a) != len(b) or not np.isfinite([*a, *b]).all():
        return False
    one, other = (meaning(place, values, statements) for values in (a, b))
    rounding = _RESHAPED if last_of(place) in OF_MESHES else _TURNED
    return one is not None and other is not None and bool(np.abs(one - other).max(initial=0.0) <= rounding)


def last_of(place: str) -> str:
    """The attribute, or the tag."""
    return place.rpartition("@")[2].rpartition("/")[2].partition(" ")[0]


def numbers(text: str) -> list[float] | None:
    """The numbers of a text; None if it has anything else."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return None


def _direction(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    return unit(values) if len(values) == 3 and any(values) else None


def _fixed_axes(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    return _turned(values, _FIXED_AXES) if len(values) == 3 else None


def _wxyz(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    return rotation_from_quaternion(unit(values).tolist()) if len(values) == 4 and any(values) else None


def _xyzw(place: str, values: Sequence[float], statements: Statements) -> Array | None:
    return _wxyz(place, (*values[3:], *values[:3]), statements)


def _pose(place: str, values: Sequence[float], statements: Statements) -> Array | None:
    """Position and rotation of SDFormat's ``<pose>``."""
    if len(values) == 7:
        R = _xyzw(place, values[3:], statements)
    else:
        stated = statements.get(f"{place}@degrees")
        degrees = stated is not None and stated.value in ("true", "1")
        R = _fixed_axes(place, [radians(one) if degrees else one for one in values[3:]], statements)
    return None if R is None else np.concatenate([values[:3], R.ravel()])


def _euler(_place: str, values: Sequence[float], statements: Statements) -> Array | None:
    sequence = _setting(statements, "@eulerseq", "xyz")
    known = len(values) == len(sequence) == 3 and set(sequence.lower()) <= set("xyz")
    return _turned([_angle(one, statements) for one in values], sequence) if known else None


def _axisangle(_place: str, values: Sequence[float], statements: Statements) -> Array | None:
    known = len(values) == 4 and any(values[:3])
    return rotation_about(unit(values[:3]), _angle(values[3], statements)) if known else None


def _xyaxes(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    if len(values) != 6 or not length(cross(np.array(values[:3]), np.array(values[3:]))):
        return None
    x, y = unit(values[:3]), np.array(values[3:])
    return np.concatenate([x, unit(y - dot(x, y) * x)])


def _segment(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    """Both ends of a geom that is the same from either end; engines compare what is not."""
    return np.array(sorted((list(values[:3]), list(values[3:])))) if len(values) == 6 else None


def _turned(angles: Sequence[float], sequence: str) -> Array:
    """The rotation of angles about axes that turn along (small letters) or are fixed (capitals)."""
    R = np.eye(3)
    for letter, angle in zip(sequence, angles, strict=True):
        step = rotation_about(np.eye(3)["xyz".index(letter.lower())], angle)
        R = matrix_product(R, step) if letter.islower() else matrix_product(step, R)
    return R


def _angle(value: float, statements: Statements) -> float:
    """An angle of an MJCF [rad]."""
    return value if _setting(statements, "@angle", "degree") == "radian" else radians(value)


def _setting(statements: Statements, attribute: str, default: str) -> str:
    """A setting of an MJCF's compiler, of which the last one counts."""
    stated = [
        one.value
        for place, one in statements.items()
        if place.startswith("mujoco/compiler") and place.endswith(attribute)
    ]
    return stated[-1] if stated else default


def _area(_place: str, values: Sequence[float], _statements: Statements) -> Array | None:
    return np.log(values) if len(values) == 1 and values[0] > 0.0 else None


def _of_surface(place: str, values: Sequence[float], statements: Statements) -> Array | None:
    area = statements.get(f"{place.rpartition('@')[0]}@area")
    return None if area is None else np.array(values) / float(area.value) ** 0.5


_MEANINGS: Mapping[str, Callable[[str, Sequence[float], Statements], Array | None]] = {
    "rpy": _fixed_axes,
    "quat": _wxyz,
    "quat_xyzw": _xyzw,
    "pose": _pose,
    "euler": _euler,
    "axisangle": _axisangle,
    "xyaxes": _xyaxes,
    "fromto": _segment,
    "area": _area,
    "centroid": _of_surface,
    "gyration_radius": _of_surface,
}
