"""Compares the text of two files of one format, so that what no engine reports is never taken as equal."""

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite

from stepbot.engines.description.statements import Statement
from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Quantity

from .compare import Compared
from .deviation import Deviations

_EQUAL = Tolerance(absolute=1e-13, relative=1e-9)
_SETTINGS = ("@angle", "@eulerseq", "@autolimits", "@inertiafromgeom", "@balanceinertia", "@settotalmass")
"""Settings of an MJCF by which other numbers change their meaning."""
_POSES = ("xyz", "rpy", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto", "pose", "axis")
_SIZES = ("size", "scale", "radius", "length")
_INERTIAS = ("fullinertia", "diaginertia", "ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SAID_OTHERWISE = frozenset((*_POSES, *_SIZES, *_INERTIAS, "qpos"))
"""Numbers that may differ between files of one robot: engines report the poses, shapes and inertias that they make,
to a tolerance. One such number that differs alone makes no equal robot, and is compared as it stands."""


def compare_text(
    ours: Sequence[Statement], theirs: Sequence[Statement], *, equal: bool, whole: bool
) -> Compared | None:
    """What differs between the texts of two files; None if nothing does.

    Args:
        ours: Statements of the first file.
        theirs: Those of the other file.
        equal: Whether engines see the same robot in both; otherwise only what they cannot see is compared.
        whole: Whether what one file has alone differs, too, and words as numbers do.
    """
    deviations = Deviations(_EQUAL)
    a, b = _by_place(ours), _by_place(theirs)
    settings = [place for place in {*a, *b} if place.endswith(_SETTINGS)]
    equal = equal and all(place in a and place in b and a[place].value == b[place].value for place in settings)
    differ = [one for place, one in a.items() if place in b and b[place].value != one.value]
    alone = whole and len(differ) == 1 and set(a) == set(b)
    for one in differ:
        if one.read and (not equal or (_may_be_said_otherwise(one.place) and not alone)):
            continue
        _compare(deviations, one, b[one.place], words=whole and not one.read)
    for place in (*a, *b) if whole else ():
        one = a.get(place) or b[place]
        if not one.read and not (place in a and place in b):
            deviations.equal(False, f"{place} is {'missing' if place in a else 'not in the robot'}")
    return Compared(Quantity.TEXT, deviations) if deviations.failures else None


def _may_be_said_otherwise(place: str) -> bool:
    return place.rpartition("@")[2].rpartition("/")[2].partition(" ")[0] in _SAID_OTHERWISE


def _by_place(given: Iterable[Statement]) -> Mapping[str, Statement]:
    return {one.place: one for one in given}


def _compare(deviations: Deviations, a: Statement, b: Statement, *, words: bool) -> None:
    ours, theirs = (_numbers(one.value) for one in (a, b))
    if ours is None or theirs is None or len(ours) != len(theirs):
        both = ours is not None and theirs is not None
        if words or both:
            deviations.equal(False, f"{a.place}: '{b.value[:80]}', '{a.value[:80]}' expected")
        return
    for number, (expected, found) in enumerate(zip(ours, theirs, strict=True), start=1):
        which = f"{a.place}, number {number}" if len(ours) > 1 else a.place
        deviations.near(found, expected, which, "SI", abs(expected) if isfinite(expected) else 0.0)


def _numbers(text: str) -> list[float] | None:
    """The numbers of a text; None if it has anything else."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return None
