"""Limits and dynamics of a joint, including the defaults from ``joint_defaults``.

A default applies to the joints whose names match its pattern (``*`` any characters, ``?`` one, ``[ab]`` one of these;
case-sensitive). For each field the joint's own value takes precedence, then the first pattern in file order that sets
it. A default only sets fields of the joint's type: ``"*": {limits: {lower: ..., upper: ...}}`` does not affect fixed
and continuous joints.
"""

from collections.abc import Mapping
from fnmatch import fnmatchcase

from msgspec import Struct

from stepbot.robot.joint_types import kinds_with
from stepbot.robot.model import JointDynamics, JointKind, Limit

from . import units
from .document import Document, JointDefaults, JointSection
from .motion import DynamicsSection, LimitsSection
from .quantities import JointValue
from .tree import Keys

ONE_FREEDOM = kinds_with(coordinates=1)
"""Types with a single coordinate, which can mimic, be mimicked, be driven, and have a `zero`."""

_DIMENSIONS = {
    "lower": (units.ANGLE, units.LENGTH),
    "upper": (units.ANGLE, units.LENGTH),
    "velocity": (units.ANGULAR_SPEED, units.SPEED),
    "acceleration": (units.ANGULAR_ACCELERATION, units.ACCELERATION),
    "deceleration": (units.ANGULAR_ACCELERATION, units.ACCELERATION),
    "jerk": (units.ANGULAR_JERK, units.JERK),
    "effort": (units.TORQUE, units.FORCE),
    "damping": (units.ANGULAR_DAMPING, units.LINEAR_DAMPING),
    "friction": (units.TORQUE, units.FORCE),
    "stiffness": (units.ANGULAR_STIFFNESS, units.LINEAR_STIFFNESS),
    "spring_reference": (units.ANGLE, units.LENGTH),
    "armature": (units.INERTIA, units.MASS),
}
"""Of each field, for a joint that turns and one that slides."""
_TURNING, _SLIDING = ({field: pair[side] for field, pair in _DIMENSIONS.items()} for side in (0, 1))
_SHARED = {
    field: dimension
    for field, dimension in _TURNING.items()
    if dimension not in (units.ANGLE, units.ANGULAR_ACCELERATION, units.ANGULAR_JERK)
}
_SETTINGS_OF: dict[JointKind, Mapping[str, units.Dimension]] = {
    JointKind.REVOLUTE: _TURNING,
    JointKind.SCREW: _TURNING,
    JointKind.CONTINUOUS: {field: d for field, d in _TURNING.items() if field not in ("lower", "upper")},
    JointKind.PRISMATIC: _SLIDING,
    # Several rotations: the fields that they share, without positions, which are not single numbers.
    JointKind.BALL: _SHARED,
    JointKind.UNIVERSAL: _SHARED,
}


class Setting(Struct, frozen=True):
    """One number of a joint, and its place in the sidecar."""

    value: float
    """[SI]."""
    dimension: units.Dimension | None
    """The dimension of the given unit; None for a plain number."""
    keys: Keys
    """Its keys in the sidecar: ``("joints", name, "limits", "lower")`` or below ``joint_defaults``."""


def settings_of(kind: JointKind) -> Mapping[str, units.Dimension]:
    """The fields of ``limits`` and ``dynamics`` that joints of this kind have, with their dimensions."""
    return _SETTINGS_OF.get(kind, {})


def position_dimension(kind: JointKind) -> units.Dimension | None:
    """The dimension of the joint's position; None if it is not a single number."""
    return settings_of(kind).get("spring_reference")


def joint_settings(document: Document, name: str) -> dict[str, Setting]:
    """Every field of limits and dynamics that is set for a joint, by itself or by a default.

    The joint's own values are included even if its type does not support the field: the check reports it.

    Raises:
        KeyError: There is no such joint.
    """
    joint = document.joints[name]
    settings: dict[str, Setting] = {}
    _take(settings, joint, ("joints", name), None)
    for pattern, defaults in document.joint_defaults.items():
        if fnmatchcase(name, pattern):
            _take(settings, defaults, ("joint_defaults", pattern), settings_of(joint.type))
    return settings


def joint_limits(document: Document, name: str) -> Limit:
    """The limits of a joint in SI, defaults applied; infinite if not set."""
    return Limit(**_numbers(document, name, LimitsSection))


def joint_dynamics(document: Document, name: str) -> JointDynamics:
    """The passive forces of a joint in SI, defaults applied; zero if not set."""
    return JointDynamics(**_numbers(document, name, DynamicsSection))


def _numbers(document: Document, name: str, section: type[LimitsSection | DynamicsSection]) -> dict[str, float]:
    settings = joint_settings(document, name)
    return {field: settings[field].value for field in section.model_fields if field in settings}


def _take(
    settings: dict[str, Setting],
    source: JointSection | JointDefaults,
    keys: Keys,
    known: Mapping[str, units.Dimension] | None,
) -> None:
    """Add values of ``source`` that ``settings`` lacks; only fields in ``known``, if given."""
    for key, section in (("limits", source.limits), ("dynamics", source.dynamics)):
        if section == "todo":
            continue
        for field in type(section).model_fields:
            value: JointValue | None = getattr(section, field)
            if value is not None and field not in settings and (known is None or field in known):
                settings[field] = Setting(value.value, value.dimension, (*keys, key, field))
