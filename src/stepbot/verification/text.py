"""Compares the texts of two files of one format: what no engine reports is not taken as equal.

Two numbers may mean the same in other words: directions, rotations, ends of a segment. No tolerance of an engine takes
part: what is not the same but for rounding of the last digits differs.
"""

import re
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from math import radians

import numpy as np

from stepbot.engines.description.statements import Statement
from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Quantity
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

from .compare import QuantityComparison
from .deviation import Deviations

_EQUAL = Tolerance(absolute=1e-13, relative=1e-9)
_SETTINGS = ("@angle", "@eulerseq", "@autolimits", "@inertiafromgeom", "@balanceinertia", "@settotalmass")
"""Settings of an MJCF by which other numbers change their meaning."""
_IN_OTHER_WORDS = (
    "xyz rpy pos quat axisangle xyaxes zaxis euler fromto pose axis qpos size scale radius length "
    "fullinertia diaginertia ixx ixy ixz iyy iyz izz area centroid gyration_radius"
)
"""Numbers that may differ between files of one robot: engines report the poses, shapes and inertias that they make,
to a tolerance. One such number that differs alone makes no equal robot, and is compared as it stands."""
_NAMES = (
    "name model link joint parent child body1 body2 site site1 site2 joint1 joint2 reference class childclass type "
    "filename file mesh meshdir assetdir uri material topic gz_frame_id frame collision joint_name canonical_link "
    "hardwareInterface version relative_to expressed_in attached_to"
)
"""Words by which one robot may be described in several ways, and whose effect engines report."""
_DEFAULTS = {"mujoco/option@timestep": "0.002", "mujoco/option@integrator": "Euler", "/static": "false"}
"""What files mean that leave out what is read, but what no engine reports, by the end of the place."""
_MODEL = re.compile(r"^sdf(/world[^/]*)?/model[^/]*/pose$")
"""The place of a model in its world."""
_UNREPORTED = re.compile(
    rf"^robot/(transmission|ros2_control|gazebo)\b|^robot/link[^/]*/contact/|{_MODEL.pattern}|/surface/.*/|/plugin\b"
)
"""Places of what is read and reported by no engine, or by one that may not be installed, but actuators and sensors."""
_LEFT_OUT = {
    **dict.fromkeys(("mu", "mu1", "mu2", "allow_auto_disable", "cast_shadows"), 1.0),
    **dict.fromkeys(("restitution_coefficient", "pose", "self_collide", "kinematic", "enable_wind"), 0.0),
    **dict.fromkeys(("must_be_base_link", "laser_retro", "transparency", "fdir1", "slip1", "slip2", "visualize"), 0.0),
    **dict.fromkeys(("spinning_friction", "rolling_friction", "restitution"), 0.0),
    "lateral_friction": 0.5,
}
"""Numbers that are meant where these elements of SDFormat, and of URDF's extensions, are left out; 1 is true. The
last two rows are what PyBullet gives a link without `<contact>` (`getDynamicsInfo`)."""
_NUMBER = re.compile(r" \d+(?=[/@]|$)")
"""The number of one of several elements with the same tag and name."""
_SAME_WORDS = {"1": "true", "0": "false"}


def compare_text(
    ours: Sequence[Statement],
    theirs: Sequence[Statement],
    *,
    equal: bool,
    whole: bool,
    compiled: bool = False,
    defaults: Container[str] = (),
) -> QuantityComparison | None:
    """What differs between the texts of two files; None if nothing does.

    Args:
        equal: Whether engines see the same robot in both; otherwise only what they cannot see is compared.
        whole: Whether what is not read differs, too, where it is words, or where one file has it alone.
        compiled: Whether an engine makes the same of both in all that it has: what one file has alone is a default.
        defaults: Places that state what an engine takes where a file has nothing.
    """
    deviations = Deviations(_EQUAL)
    placing = _placing((*ours, *theirs))
    a, b = (_by_place(side, (*ours, *theirs), placing) for side in (ours, theirs))
    settings = [place for place in {*a, *b} if place.endswith(_SETTINGS)]
    equal = equal and all(place in a and place in b and a[place].value == b[place].value for place in settings)
    differ = [one for place, one in a.items() if place in b and b[place].value != one.value]
    differ = [one for one in differ if not means_the_same(one.place, one.value, b[one.place].value, a)]
    others = [one for one in differ if _may_make_up_for_another(one) and one.place not in placing]
    alone = set(a) == set(b) and (len(others) == 1 or all(last_of(one.place) in OF_MESHES for one in others))
    for one in differ:
        other, in_other_words = b[one.place], _is_in_other_words(one) and not alone
        if one.read and (not equal or in_other_words) and one.place not in placing:
            continue
        words = one.place in placing or (last_of(one.place) not in _NAMES.split() if one.read else whole)
        _compare(deviations, one, other, words=words)
    for place in (*a, *b) if whole and not compiled else ():
        one = a.get(place) or b[place]
        if not (one.read or (place in a and place in b) or place in defaults or _is_default(one)):
            deviations.equal(False, f"{place} is {'missing' if place in a else 'not in the robot'}")
    plain = [{_NUMBER.sub("", one.place) for one in side} for side in (ours, theirs)]
    for one in (*ours, *theirs) if whole and equal else ():
        missing = [_NUMBER.sub("", one.place) not in side for side in plain]
        if one.read and any(missing) and _UNREPORTED.search(one.place) and not _is_default(one):
            deviations.equal(False, f"{one.place} is {'missing' if missing[1] else 'not in the robot'}")
    return QuantityComparison(Quantity.TEXT, deviations) if deviations.failures else None


def compare_settings(ours: Mapping[str, Sequence[float]], theirs: Mapping[str, Sequence[float]]) -> Deviations:
    """The numbers at the places that two files have, however they are stated: defaults and classes are resolved."""
    deviations = Deviations(_EQUAL)
    for place in (one for one in ours if one in theirs and len(ours[one]) == len(theirs[one])):
        _compare(
            deviations, *(Statement(place, " ".join(map(repr, side[place])), read=True) for side in (ours, theirs))
        )
    return deviations


def _is_in_other_words(statement: Statement) -> bool:
    """Whether a number may be another one in a file of the same robot; the place of a model is its own."""
    return last_of(statement.place) in _IN_OTHER_WORDS.split() and _MODEL.match(statement.place) is None


def _may_make_up_for_another(statement: Statement) -> bool:
    """Whether another number, or word, may be the same robot together with others: a mesh and its scale, two poses."""
    return _is_in_other_words(statement) or (statement.read and numbers(statement.value) is None)


def _is_default(statement: Statement) -> bool:
    """Whether a number is what a file means that leaves it out."""
    default = _LEFT_OUT.get(last_of(statement.place.removesuffix("@value")))
    values = numbers({"true": "1", "false": "0"}.get(statement.value, statement.value))
    return default is not None and values is not None and set(values) == {default}


def _placing(both: Iterable[Statement]) -> dict[str, str]:
    """Places that state how a robot is held in its world, and what they mean if left out: no engine reports them."""
    joints = [statement.place.removesuffix("/parent@link") for statement in both if statement.value == "world"]
    poses = {f"{joint}/origin@{name}": "0 0 0" for joint in joints for name in ("xyz", "rpy")}
    return poses | {f"{joint}@type": "" for joint in joints}


def _by_place(
    given: Iterable[Statement], both: Iterable[Statement], defaults: Mapping[str, str]
) -> Mapping[str, Statement]:
    """The statements of a file by place, with defaults of those that one of ``both`` files makes."""
    places = {statement.place for statement in both}
    meant = {place: text for place in places for end, text in _DEFAULTS.items() if place.endswith(end)}
    meant |= {place: text for place, text in defaults.items() if text and place in places}
    return {place: Statement(place, text, read=True) for place, text in meant.items()} | {
        statement.place: statement for statement in given
    }


def _compare(deviations: Deviations, a: Statement, b: Statement, *, words: bool = True) -> None:
    ours, theirs = (numbers(one.value) for one in (a, b))
    if ours is None or theirs is None or len(ours) != len(theirs):
        both = ours is not None and theirs is not None
        if (words and _SAME_WORDS.get(a.value, a.value) != _SAME_WORDS.get(b.value, b.value)) or both:
            deviations.equal(False, f"{a.place}: '{b.value[:80]}'", expected=f"'{a.value[:80]}'")
        return
    for number, (expected, observed) in enumerate(zip(ours, theirs, strict=True), start=1):
        which = f"{a.place}, number {number}" if len(ours) > 1 else a.place
        deviations.near(observed, expected, which, "SI")


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
        R = _fixed_axes(place, [radians(value) if degrees else value for value in values[3:]], statements)
    return None if R is None else np.concatenate([values[:3], R.ravel()])


def _euler(_place: str, values: Sequence[float], statements: Statements) -> Array | None:
    sequence = _setting(statements, "@eulerseq", "xyz")
    known = len(values) == len(sequence) == 3 and set(sequence.lower()) <= set("xyz")
    return _turned([_angle(value, statements) for value in values], sequence) if known else None


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
