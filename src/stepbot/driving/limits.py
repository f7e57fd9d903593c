"""Units and limits of the numbers of drive tests, each with its reason.

A limit may be tightened or, with a reason, loosened for one robot: ``drive.limits`` in a file of limits, such as the
``expected.json`` of a robot of the library.
"""

from collections.abc import Mapping
from typing import Any

from msgspec import Struct

from stepbot.diagnostics import did_you_mean
from stepbot.engines.simulation import SHAPES, Cube

UNITS: Mapping[str, str] = {
    "angle error": "rad",
    "angle error with other gains": "rad",
    "travel error": "mm",
    "angle drift": "rad",
    "travel drift": "mm",
    "poses": "",
    "speed error": "%",
    "overshoot": "%",
    "overshoot with other gains": "%",
    "lag": "%",
    "lag with other gains": "%",
    "lag with limited effort": "%",
    "loop opening": "mm",
    "covered range": "%",
    "angle beyond limit": "rad",
    "travel beyond limit": "mm",
    "speed of limit": "%",
    "speed of limit with other gains": "%",
    "pushed speed of limit": "%",
    "energy gain": "%",
    "penetration": "mm",
    "height drift": "mm",
    "slip": "mm",
    "distance error": "%",
    "sideways": "mm",
    "heading": "deg",
    "return error": "mm",
    "turn error": "%",
    "displacement": "mm",
    "tilt": "deg",
    "tilt at rest": "deg",
    "tilt after push": "deg",
    "sinking": "mm",
    "height loss": "%",
    "drift": "mm",
    "push": "m/s",
}
"""Unit of every quantity."""


class Bound(Struct, frozen=True):
    """The largest value of a quantity that passes."""

    value: float
    why: str


_ERROR = Bound(0.05, "3 degrees, a tenth of the 0.5 rad step: beyond it a position motor does not do its work")
_TRAVEL = Bound(2.0, "2 mm: a twentieth of the stroke of a gripper")
_SPEED = Bound(105.0, "a motor does not drive its joint faster than it can turn itself")
_OPEN = Bound(0.5, "the clearance of a worn pin: beyond it, the mechanism is another one")
_REST = Bound(1.0, "a solid deeper than 1 mm in another is seen, and sensors measure it")
_ANY = {"loop opening": _OPEN}

LIMITS: Mapping[str, Mapping[str, Bound]] = {
    "hold": {
        **_ANY,
        "angle error": Bound(0.01, "half a degree: 1 cm at the end of an arm of 1 m"),
        "angle error with other gains": _ERROR,
        "travel error": _TRAVEL,
        "angle drift": Bound(1e-3, "at rest: less than the backlash of a gear in a quarter of a second"),
        "travel drift": Bound(0.1, "at rest: less than the play of a guide in a quarter of a second"),
    },
    "step": {
        **_ANY,
        "overshoot": Bound(5.0, "a second-order system with damping ratio 0.7 overshoots by 4.6 %"),
        "overshoot with other gains": Bound(10.0, "a second-order system with damping ratio 0.6 overshoots by 9.5 %"),
        "speed of limit": _SPEED,
        "angle error": _ERROR,
        "travel error": _TRAVEL,
        "speed error": Bound(5.0, "a speed controller without integrator against damping and gravity"),
    },
    "track": {**_ANY, "lag": Bound(5.0, "a sine of 0.5 Hz is followed 16 ms behind at most")},
    "sweep": {**_ANY, "angle error": _ERROR, "travel error": _TRAVEL},
    "torque": {**_ANY},
    "drop": {
        **_ANY,
        "energy gain": Bound(2.0, "nothing adds energy to a falling robot but its motors at home and rounding"),
        "penetration": _REST,
        "height drift": Bound(1.0, "at rest on the floor"),
    },
    "grip": {
        **_ANY,
        "slip": Bound(2.0, "an object that slips by 2 mm in 5 s is lost in a minute"),
        "penetration": _REST,
    },
    "roll": {
        **_ANY,
        "distance error": Bound(1.0, "wheels that roll without slip cover speed x time, but for starting and stopping"),
        "heading": Bound(2.0, "35 mm aside per metre"),
        "sideways": Bound(70.0, "with the heading above, on the way of 2 m"),
        "return error": Bound(40.0, "1 % of the way there and back"),
        "tilt": Bound(3.0, "all wheels stay on the floor"),
    },
    "turn": {
        **_ANY,
        "turn error": Bound(2.0, "7 degrees in a turn: the error of odometry from wheels that do not slip"),
        "displacement": Bound(20.0, "the middle of the wheels stays where it is"),
        "tilt": Bound(3.0, "all wheels stay on the floor"),
    },
    "strafe": {
        **_ANY,
        "distance error": Bound(
            3.0, "speed x time at the mean tilt of the rollers on the floor; each wheel changes from roller to roller"
        ),
        "heading": Bound(3.0, "50 mm aside per metre"),
        "sideways": Bound(30.0, "with the heading above, on the way of 0.6 m"),
        "return error": Bound(60.0, "10 % of the way of 0.6 m"),
        "tilt": Bound(3.0, "all wheels stay on the floor"),
    },
    "stand": {
        **_ANY,
        "tilt at rest": Bound(5.0, "the trunk stays level on equal legs"),
        "sinking": Bound(20.0, "legs that carry the weight with the stiffness of their motors"),
        "tilt after push": Bound(5.0, "stands as before the push"),
        "height loss": Bound(15.0, "has not collapsed"),
        "drift": Bound(2.0, "at rest after the push"),
        "penetration": _REST,
    },
}
"""For each test the limit of each quantity that has one."""
CUBE_MASS = 0.2
"""[kg]: of the cube to grip, where the robot does not state another."""


class InvalidLimits(ValueError):
    """A file of limits does not have the form of one."""


class Demands(Struct, frozen=True):
    """What one robot is to pass."""

    limits: Mapping[str, Mapping[str, Bound]]
    tests: tuple[str, ...] = ()
    """The tests that must apply; empty for those that the model decides."""
    mass: float = CUBE_MASS
    """Mass [kg] of the cube to grip."""
    objects: tuple[Cube, ...] = ()
    """What fingers grip in place of the cube, with its mass."""
    stated: tuple[tuple[str, str], ...] = ()
    """Tests and quantities with limits of the robot's own."""


def demands(content: Mapping[str, Any] | None) -> Demands:
    """The limits with those of a robot.

    Args:
        content: The object ``drive`` of a file of limits: ``tests``, ``cube`` [kg], ``objects`` [m], and under
            ``limits`` for each test and quantity ``[value, reason]``. None for the default limits.

    Raises:
        InvalidLimits: A test or quantity is unknown, or a limit is not a number with a reason.
    """
    if content is None:
        return Demands(LIMITS)
    if not isinstance(content, Mapping):
        raise InvalidLimits("'drive' is not an object")
    unknown = sorted(set(content) - {"tests", "limits", "cube", "objects"})
    if unknown:
        raise InvalidLimits(f"unknown key '{unknown[0]}'; expected tests, limits, cube or objects")
    tests, mass = content.get("tests", []), content.get("cube", CUBE_MASS)
    if not isinstance(tests, list) or not set(map(str, tests)) <= set(LIMITS):
        raise InvalidLimits(f"'tests' is not a list of {', '.join(LIMITS)}")
    if not _is_number(mass) or mass <= 0.0:
        raise InvalidLimits("'cube' is not a mass in kg")
    limits = {test: dict(bounds) for test, bounds in LIMITS.items()}
    given = content.get("limits", {})
    if not isinstance(given, Mapping):
        raise InvalidLimits("'limits' is not an object")
    for test, bounds in given.items():
        if test not in limits or not isinstance(bounds, Mapping):
            raise InvalidLimits(f"limits: no test '{test}'; there are {', '.join(LIMITS)}")
        for quantity, bound in bounds.items():
            if quantity not in UNITS:
                nearest = " ".join(did_you_mean(quantity, UNITS)) or f"there are {', '.join(UNITS)}"
                raise InvalidLimits(f"limits: {test}: no quantity '{quantity}'; {nearest}")
            if not (isinstance(bound, list) and len(bound) == 2 and _is_number(bound[0]) and str(bound[1]).strip()):
                raise InvalidLimits(f'limits: {test}: {quantity}: expected [number, "reason"]')
            limits[test][quantity] = Bound(float(bound[0]), str(bound[1]))
    stated = tuple((test, quantity) for test, bounds in given.items() for quantity in bounds)
    objects = _objects(content.get("objects", []), float(mass))
    return Demands(limits, tuple(map(str, tests)), float(mass), objects, stated)


def _objects(given: object, mass: float) -> tuple[Cube, ...]:
    """Objects to grip, each ``[shape, size]``."""
    cubes = []
    for pair in given if isinstance(given, list) else [given]:
        if not (isinstance(pair, list) and len(pair) == 2 and pair[0] in SHAPES and _is_number(pair[1]) and pair[1]):
            raise InvalidLimits(f"'objects' is not a list of [shape, size in m], with a shape of {', '.join(SHAPES)}")
        cubes.append(Cube(float(pair[1]), mass, pair[0]))
    return tuple(cubes)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value < 1e300
