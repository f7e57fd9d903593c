"""Check units: those that do not match the type of a joint, and values that suggest a wrong or missing one."""

import re
from collections.abc import Iterator, Sequence
from math import inf, isfinite, tau
from typing import NamedTuple

from stepbot.diagnostics import Diagnostics
from stepbot.robot.inertial_doubts import DENSEST
from stepbot.robot.model import JointKind

from .joint_settings import joint_settings, position_dimension, settings_of
from .located import Sidecar
from .tree import Keys, scalars, subject
from .units import ANGLE, DENSITY, FORCE, LENGTH, PITCH, RATIO, TORQUE, TURNS, Dimension, UnitError, read_quantity

_SUSPICIOUS = 3
"""Number of values of one joint that suggest that its type is wrong, if no unit of a value matches it."""


_RATIOS: dict[tuple[Dimension | None, Dimension | None], Dimension] = {(LENGTH, ANGLE): PITCH, (ANGLE, LENGTH): TURNS}
"""Dimension of a multiplier by those of the following and the leading joint, where they differ."""


class _Unit(NamedTuple):
    """The unit of one value of a joint."""

    joint: str
    kind: JointKind
    keys: Keys
    """Of the joint or of one of its defaults."""
    written: Dimension
    needed: Dimension

    @property
    def is_wrong(self) -> bool:
        return self.written != self.needed


def check_joint_units(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB138: one for a joint of a wrong type, one for a default of several joints, else one for each value."""
    shared: dict[Keys, list[_Unit]] = {}
    for name in sidecar.document.joints:
        units = list(_units(sidecar, name))
        own = [unit for unit in units if unit.keys[0] == "joints"]
        wrong = [unit for unit in own if unit.is_wrong]
        if len(wrong) == len(own) >= _SUSPICIOUS:
            _report_type(sidecar, wrong, diagnostics)
        else:
            for unit in wrong:
                check_unit(sidecar, f"joint '{name}'", unit.kind, unit.written, unit.needed, unit.keys, diagnostics)
        for unit in units:
            if unit.is_wrong and unit.keys[0] != "joints":
                shared.setdefault(unit.keys, []).append(unit)
    for several in shared.values():
        _report_default(sidecar, several, diagnostics)


def _units(sidecar: Sidecar, name: str) -> Iterator[_Unit]:
    """The values of a joint, its defaults included, that have a unit."""
    joint = sidecar.document.joints[name]
    known, position = settings_of(joint.type), position_dimension(joint.type)
    for field, setting in joint_settings(sidecar.document, name).items():
        if field in known and setting.dimension is not None:
            yield _Unit(name, joint.type, setting.keys, setting.dimension, known[field])
    if position is None:
        return
    if joint.zero.dimension is not None:
        yield _Unit(name, joint.type, ("joints", name, "zero"), joint.zero.dimension, position)
    if joint.mimic is not None and joint.mimic.offset.dimension is not None:
        yield _Unit(name, joint.type, ("joints", name, "mimic", "offset"), joint.mimic.offset.dimension, position)
    leader = joint.mimic and sidecar.document.joints.get(joint.mimic.joint)
    if joint.mimic is not None and joint.mimic.multiplier.dimension is not None and leader:
        needed = _RATIOS.get((position, position_dimension(leader.type)), RATIO)
        yield _Unit(name, joint.type, ("joints", name, "mimic", "multiplier"), joint.mimic.multiplier.dimension, needed)


def _report_type(sidecar: Sidecar, wrong: Sequence[_Unit], diagnostics: Diagnostics) -> None:
    name, kind = wrong[0].joint, wrong[0].kind
    message = f"joint '{name}': the units of {len(wrong)} values do not match its type {kind}"
    notes = [
        f"line {sidecar.span(*unit.keys).line}: {unit.keys[-1]}: '{sidecar.written(*unit.keys)}' is not "
        f"{_a(unit.needed)} [{unit.needed.unit}]"
        for unit in wrong
    ]
    types = [
        other
        for other in (JointKind.REVOLUTE, JointKind.PRISMATIC)
        if all(unit.written in (*settings_of(other).values(), position_dimension(other)) for unit in wrong)
    ]
    help = [f"change the type to {' or '.join(types)}, or correct the values"] if types else ["correct the values"]
    diagnostics.add("SB138", message, sidecar.span("joints", name, "type"), help=help, notes=notes)


def _report_default(sidecar: Sidecar, several: Sequence[_Unit], diagnostics: Diagnostics) -> None:
    first = several[0]
    if len(several) == 1:
        who = f"joint '{first.joint}'"
        check_unit(sidecar, who, first.kind, first.written, first.needed, first.keys, diagnostics)
        return
    kinds = " and ".join(dict.fromkeys(unit.kind for unit in several))
    needed = " or ".join(dict.fromkeys(f"{_a(unit.needed)} [{unit.needed.unit}]" for unit in several))
    key = first.keys[-1]
    message = f"{subject(first.keys[:2])}: {key}: '{sidecar.written(*first.keys)}' is not {needed}, required for "
    names = ", ".join(f"'{unit.joint}'" for unit in several)
    message += f"{len(several)} {kinds} joints"
    help = [f"set `{key}` on these joints themselves, or in a default of their own above this one"]
    diagnostics.add("SB138", message, sidecar.span(*first.keys), help=help, notes=[f"joints: {names}"])


def check_unit(
    sidecar: Sidecar,
    who: str,
    kind: JointKind,
    written: Dimension | None,
    needed: Dimension,
    keys: Keys,
    diagnostics: Diagnostics,
) -> None:
    """Report SB138 if the unit of a value does not match the joint type."""
    if written is None or written == needed:
        return
    key = keys[-1] if keys[0] != "joint_defaults" else f"{keys[-1]} of {subject(keys[:2])}"
    written_as = sidecar.written(*keys)
    message = f"{who}: {key}: '{written_as}' is not {_a(needed)} [{needed.unit}], required for a {kind} joint"
    help = [f"example: {needed.example}"]
    if keys[0] == "joint_defaults":
        help.append(f"or set `{keys[-1]}` on {who} itself")
    diagnostics.add("SB138", message, sidecar.span(*keys), help=help)


def _a(dimension: Dimension) -> str:
    return f"{'an' if dimension.name[0] in 'aeiou' else 'a'} {dimension.name}"


_MOST_RADIANS = 20.0
"""Three turns: beyond the limits of joints other than winches."""
_MOST_ROTATION = 6.5
"""One turn: roll, pitch and yaw are never larger."""
_MOST_METRES = 10.0
_FASTEST = {True: 10.0, False: 30.0}
"""[m/s] of joints that slide, [rad/s] of others: faster than the joints of robots other than wheels and propellers."""
_STRONGEST = {True: 20_000.0, False: 3_000.0}
"""[N] of joints that slide, [N m] of others: above those of large industrial arms."""
_COARSEST = 0.2
"""Share of a solid's diagonal, at which a mesh resembles it no longer."""
_LIGHTEST = 25.0
"""[kg/m^3]: lighter than most foams, and above the densest metal in g/cm^3."""
_SPARSEST = 5.0
"""[kg/m^3]: foams have 10 or more."""
_LEADING_NUMBER = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_EFFORTS = ("effort", "friction")
_LONGEST = {
    **dict.fromkeys(("xyz", "near", "com", "size", "radius", "length"), _MOST_METRES),
    "range": 1000.0,
    **dict.fromkeys(("torsional", "rolling"), 0.1),
}
"""[m] by key: places and shapes of robots, sight of sensors, levers of friction."""
_STEEPEST = 0.1
"""[m/rad], 628 mm per turn: steeper than screws that are sold."""


def check_magnitudes(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB139 for numbers without a unit that are implausible for robots."""
    for name, joint in sidecar.document.joints.items():
        for field, setting in joint_settings(sidecar.document, name).items():
            if field in ("lower", "upper", "spring_reference") and field in settings_of(joint.type):
                _check_position(sidecar, joint.type, setting.keys, diagnostics)
            elif field in ("velocity", "effort") and field in settings_of(joint.type):
                _check_rate(sidecar, joint.type, setting.keys, diagnostics)
        _check_position(sidecar, joint.type, ("joints", name, "zero"), diagnostics, _MOST_ROTATION)
        _check_position(sidecar, joint.type, ("joints", name, "mimic", "offset"), diagnostics, _MOST_ROTATION)
    for name, actuator in sidecar.document.actuators.items():
        driven = sidecar.document.joints.get(actuator.joint)
        if driven is not None:
            _check_rate(sidecar, driven.type, ("actuators", name, "limits", "velocity"), diagnostics)
            _check_rate(sidecar, driven.type, ("actuators", name, "limits", "effort"), diagnostics)
    for keys, scalar in scalars(sidecar.root):
        number = scalar.value
        if isinstance(number, bool) or not isinstance(number, int | float) or not isfinite(number):
            continue
        named = [key for key in keys if isinstance(key, str)]
        if named[-1] == "rpy" and abs(number) > _MOST_ROTATION:
            _report(sidecar, keys, f"{number:g} rad is {_turns(number)}", "deg", "rad", diagnostics)
        elif named[-1] == "pitch" and abs(number) > _STEEPEST:
            _report(sidecar, keys, f"{number:g} m/rad is {number * tau:.3g} m per turn", "mm/rev", "m/rad", diagnostics)
        elif abs(number) > _LONGEST.get(named[-1], inf):
            _report(sidecar, keys, f"{number:g} m is implausibly large", "mm", "m", diagnostics)
        elif named[-1] == "tolerance" and number > _COARSEST:
            _report(sidecar, keys, f"{number:g} is {number:.0%} of each solid's diagonal", "mm", "m", diagnostics)
        elif named[-1] == "density" and 0.0 < number < _LIGHTEST:
            _report(
                sidecar, keys, f"{number:g} kg/m^3 is less than the density of foam", "g/cm^3", "kg/m^3", diagnostics
            )


def check_weights_as_forces(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB140 for torques with a unit of mass, as in data sheets of servos: ``20 kg.cm``."""
    for keys, scalar in scalars(sidecar.root):
        text = scalar.value
        if not isinstance(text, str) or keys[-1] not in _EFFORTS:
            continue
        try:
            quantity = read_quantity(text, TORQUE, FORCE)
        except UnitError:  # reported where the value was read
            continue
        if quantity.taken_as:
            message = f"{subject(keys)}: '{text}' is interpreted as {quantity.taken_as} = {quantity.value:.6g} N*m"
            help = [f"write `{quantity.taken_as}` to suppress this note"]
            diagnostics.add("SB140", message, sidecar.span(*keys), help=help)


def check_densities(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB521 for densities outside the range of all materials, such as 2700 g/cm^3."""
    for keys, scalar in scalars(sidecar.root):
        if keys[-1] != "density" or isinstance(scalar.value, bool) or scalar.value is None:
            continue
        try:
            density = read_quantity(scalar.text, DENSITY).value
        except UnitError:  # reported where the value was read
            continue
        if density > DENSEST:
            help = _other_unit(scalar.text, "kg/m^3", 1.0) or "for comparison, gold has 19300 kg/m^3 = 19.3 g/cm^3"
            message = f"{subject(keys)}: {density:g} kg/m^3 exceeds the density of any material"
            diagnostics.add("SB521", message, sidecar.span(*keys), help=[help])
        elif 0.0 < density < _SPARSEST and sidecar.plain_number(*keys) is None:  # else SB139
            help = _other_unit(scalar.text, "g/cm^3", 1000.0) or "for comparison, polystyrene foam has 15 kg/m^3"
            message = f"{subject(keys)}: {density:g} kg/m^3 is below the density of any solid or foam"
            diagnostics.add("SB521", message, sidecar.span(*keys), help=[help])


def _other_unit(written: str, unit: str, scale: float) -> str:
    """The same number in the unit that was probably meant; empty if it is out of range there, too."""
    number = _LEADING_NUMBER.match(written)
    plausible = number is not None and _SPARSEST <= float(number[0]) * scale <= DENSEST
    return f"if the unit is {unit}, write `{number[0]} {unit}`" if number and plausible else ""


def _check_position(
    sidecar: Sidecar, kind: JointKind, keys: Keys, diagnostics: Diagnostics, most: float = _MOST_RADIANS
) -> None:
    number = sidecar.plain_number(*keys)
    if number is None or not isfinite(number):
        return
    if kind is JointKind.PRISMATIC and abs(number) > _MOST_METRES:
        _report(sidecar, keys, f"{number:g} m is implausibly large", "mm", "m", diagnostics)
    elif kind is not JointKind.PRISMATIC and abs(number) > most:
        _report(sidecar, keys, f"{number:g} rad is {_turns(number)}", "deg", "rad", diagnostics)


def _check_rate(sidecar: Sidecar, kind: JointKind, keys: Keys, diagnostics: Diagnostics) -> None:
    """Report a velocity or an effort that no joint of a robot has."""
    number, slides = sidecar.plain_number(*keys), kind is JointKind.PRISMATIC
    if number is None or not isfinite(number):
        return
    if keys[-1] == "effort" and number > _STRONGEST[slides]:
        own, other = ("N", "mN") if slides else ("N*m", "N*mm")
        _report(sidecar, keys, f"{number:g} {own} is implausibly strong", other, own, diagnostics)
    elif keys[-1] == "velocity" and number > _FASTEST[slides]:
        own, other = ("m/s", "mm/s") if slides else ("rad/s", "deg/s")
        speed = f"{number:g} {own}" + ("" if slides else f" = {number * 60.0 / tau:.0f} rpm")
        _report(sidecar, keys, f"{speed} is implausibly fast", other, own, diagnostics)


def _report(sidecar: Sidecar, keys: Keys, message: str, other: str, own: str, diagnostics: Diagnostics) -> None:
    span, written = sidecar.span(*keys), sidecar.written(*keys)
    behind = sidecar.text.split("\n")[span.line - 1][span.end_column - 1 :]
    if isinstance(keys[-1], str) and behind[:1] == "," and behind[1:2].isdigit():
        return  # half of a number with a decimal comma, which is an error of its own
    help = [f"write `{written} {other}` if the unit is {other}, or `{written} {own}` to confirm {own}"]
    diagnostics.add("SB139", f"{subject(keys)}: {message}", span, help=help)


def _turns(radians: float) -> str:
    return f"{abs(radians) / tau:.1f} turns"
