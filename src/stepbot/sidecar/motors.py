"""Looks up motors by name, and scales their figures to a supply and a gear.

The catalogue is JSON, which is YAML, in the form of a user's own file: :mod:`.motor_sections`.
"""

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from stepbot.robot.model import ActuatorKind, JointKind
from stepbot.robot.motors import Motor, MotorFigure

from .motor_sections import Figure, MotorKind, MotorSection

_CATALOGUE = Path(__file__).with_name("motors.json")
_SEPARATORS = re.compile(r"[\s_\-]+")
_NEAREST, _SIMILAR = 3, 0.6
"""Maximum number of similar names in a remedy, and how similar they are, from 0 to 1."""
_EFFORTS = ("stall_torque", "peak_torque", "holding_torque", "rated_torque")
"""Figures that limit the effort, the first that is known."""
_SPEEDS = ("no_load_speed", "rated_speed")
_VOLTAGE_DRIVEN = (MotorKind.SERVO, MotorKind.DC_MOTOR)
"""Types whose drive sets the voltage: their torque falls with speed at any input."""
_SCALED_BY_VOLTAGE = {
    "stall_torque": (MotorKind.SERVO, MotorKind.DC_MOTOR, MotorKind.BRUSHLESS),
    "no_load_speed": tuple(kind for kind in MotorKind if kind is not MotorKind.STEPPER),
    "position_gain": tuple(MotorKind),
    "no_load_linear_speed": tuple(MotorKind),
}
"""Figures that are proportional to the supply, and the types of motors of which this holds."""
_EXACT = 1e-9
_REACHED = 0.95
"""Share of its velocity limit that a motor without a load should reach."""


class UnknownMotor(ValueError):
    """No motor has this name; ``nearest`` are similar ones."""

    def __init__(self, name: str, nearest: tuple[str, ...]) -> None:
        self.nearest = nearest
        super().__init__(f"unknown motor '{name}'")


class AmbiguousMotor(ValueError):
    """Several motors, the ``members``, share this name."""

    def __init__(self, name: str, members: tuple[str, ...]) -> None:
        self.members = members
        super().__init__(f"'{name}' names a family of motors")


class UnscalableMotor(ValueError):
    """A motor has no figures for a type of joint."""


class UnknownSupply(UnscalableMotor):
    """A motor has no figures for a supply."""


class NamedMotor(NamedTuple):
    """A motor of the catalogue."""

    name: str
    motor: MotorSection


@cache
def _catalogue() -> dict[str, dict[str, Any]]:
    content: dict[str, dict[str, dict[str, Any]]] = json.loads(_CATALOGUE.read_text(encoding="utf-8"))
    return content["motors"]


@cache
def catalogue_motor(name: str) -> MotorSection:
    """A motor of the catalogue by its own name.

    Raises:
        KeyError: There is none.
    """
    return MotorSection.model_validate(_catalogue()[name])


def at_other_supplies(one: NamedMotor) -> Iterator[str]:
    """The motors of the catalogue that share a name with one and have another supply, with it."""
    own = one.motor.figures().get("voltage")
    for name in catalogue_names():
        motor = catalogue_motor(name)
        supply = motor.figures().get("voltage")
        if set(motor.family) & set(one.motor.family) and own and supply and supply.value != own.value:
            yield f"{name} at {supply.value:g} V"


def catalogue_names() -> tuple[str, ...]:
    """The names of all motors, in the order of the catalogue."""
    return tuple(_catalogue())


def bare(name: str) -> str:
    """A name for comparison: without case, and with one kind of separator."""
    return _SEPARATORS.sub("-", name.strip().casefold())


def find_motor(name: str, own: Mapping[str, MotorSection] = {}) -> NamedMotor:
    """A motor by any of its names, in any case, with any separators or none; a user's own motors first.

    Raises:
        AmbiguousMotor: It is the name of a family.
        UnknownMotor: No motor has it.
    """
    wanted = bare(name)
    of_own = _by_name((name, one.names, one.family) for name, one in own.items())
    known: dict[str, tuple[str, ...]] = {}
    for names, families in (of_own, _names_of_catalogue()):
        if wanted not in names and wanted not in families:
            joined = {word.replace("-", ""): word for word in (*families, *names)}
            wanted = joined.get(wanted.replace("-", ""), wanted)
        if wanted in names:
            name = names[wanted]
            return NamedMotor(name, own[name] if names is of_own[0] else catalogue_motor(name))
        if wanted in families:
            raise AmbiguousMotor(name, families[wanted])
        known |= {word: (one,) for word, one in names.items()} | families
    near = get_close_matches(wanted, known, n=_NEAREST, cutoff=_SIMILAR)
    raise UnknownMotor(
        name, tuple(dict.fromkeys((*motors_named_in(name), *(one for word in near for one in known[word]))))
    )


_Names = tuple[dict[str, str], dict[str, tuple[str, ...]]]
"""The motor of each name, and the motors of each family, by :func:`bare` names."""


@cache
def _names_of_catalogue() -> _Names:
    return _by_name((name, one.get("names", ()), one.get("family", ())) for name, one in _catalogue().items())


def _by_name(motors: Iterable[tuple[str, Iterable[str], Iterable[str]]]) -> _Names:
    names: dict[str, str] = {}
    families: dict[str, tuple[str, ...]] = {}
    for name, others, family in motors:
        for one in (name, *others):
            names.setdefault(bare(one), name)
        for one in dict.fromkeys(map(bare, family)):
            families[one] = (*families.get(one, ()), name)
    return names, families


def motors_named_in(text: str) -> tuple[str, ...]:
    """Motors that a name of a CAD part indicates: one by its own name, or all of a family; empty without any.

    Names are found as whole words: ``Dynamixel_XL430-W250-T v3`` is an XL430-W250, ``XL4301`` is none.
    """
    names, families = _names_of_catalogue()
    padded = f"-{re.sub(r'[^0-9a-z+.]+', '-', text.casefold())}-"
    matches: list[tuple[int, tuple[str, ...]]] = []
    matches += [(len(word), (name,)) for word, name in names.items() if f"-{word}-" in padded]
    matches += [(len(word), members) for word, members in families.items() if f"-{word}-" in padded]
    return max(matches, key=lambda one: one[0], default=(0, ()))[1]


_SUPPLIES = (0.4, 1.6)
"""Supply, relative to the least and the largest one with figures, at which torque and speed are in proportion."""


def default_kind(motor: MotorSection, joint: JointKind) -> ActuatorKind:
    """How a motor is driven if the sidecar does not say so: a speed on an endless joint, else a position."""
    turns = joint is JointKind.CONTINUOUS
    return ActuatorKind.VELOCITY if turns and motor.kind is not MotorKind.STEPPER else ActuatorKind.POSITION


def fitted(named: NamedMotor, joint: JointKind, voltage: float | None, gear: float, part: str = "") -> Motor:
    """What a motor gives an actuator.

    Args:
        voltage: The supply [V]; None for that of the catalogue.
        gear: Position of the motor's output / position of the joint; [rad/m] of a motor that turns, on a joint that
            slides.

    Raises:
        UnscalableMotor: It has no figures for this supply, or does not move such a joint.
    """
    name, motor = named
    linear, slides = motor.kind is MotorKind.LINEAR, joint is JointKind.PRISMATIC
    if linear and not slides:
        raise UnscalableMotor(f"'{name}' is a linear drive, and the joint turns")
    given = _at(name, motor, voltage)
    ratio = abs(gear)
    units = ("N", "m/s", "kg", "N*s/m") if slides else ("N*m", "rad/s", "kg*m^2", "N*m*s/rad")
    effort_unit, speed_unit, inertia_unit, damping_unit = units
    figures: list[MotorFigure] = []

    def add(quantity: str, figure: Figure | None, scale: float, unit: str) -> None:
        if figure is not None:
            source = figure.source if scale == 1.0 else f"{figure.source}; x {scale:.6g} for the gear"
            figures.append(MotorFigure(quantity, float(f"{figure.value * scale:.12g}"), unit, source))

    efforts, speeds = (("max_force",), ("no_load_linear_speed",)) if linear else (_EFFORTS, _SPEEDS)
    effort = next((given[one] for one in efforts if one in given), None)
    speed = next((given[one] for one in speeds if one in given), None)
    add("effort", effort, ratio, effort_unit)
    add("velocity", speed, 1.0 / ratio, speed_unit)
    add("armature", _armature(given), ratio**2, inertia_unit)
    add("friction", given.get("coulomb_friction"), ratio, effort_unit)
    add("damping", _damping(motor, given), ratio**2, damping_unit)
    add("kp", given.get("position_gain"), 1.0, "N*m/rad")
    add("mass", given.get("mass"), 1.0, "kg")
    add("backlash", given.get("backlash"), 1.0 / ratio, "m" if slides else "rad")
    known = {one.quantity for one in figures}
    unknown = tuple(q for q in ("effort", "velocity", "armature", "friction", "damping") if q not in known)
    doubts = [f"{key.replace('_', ' ')}: {text}" for key, text in motor.doubts.items()]
    if (slow := _unreached_speed(figures)) is not None:
        doubts.append(slow)
    return Motor(name, tuple(figures), tuple(doubts), unknown, body_size(motor), part)


def _unreached_speed(figures: Sequence[MotorFigure]) -> str | None:
    """A doubt if damping and friction use up the effort at less than the velocity limit.

    The speed is (effort - friction) / damping, at which nothing is left for a load.
    """
    given = {figure.quantity: figure for figure in figures}
    if not {"effort", "velocity", "damping"} <= given.keys() or given["damping"].value <= 0.0:
        return None
    effort, speed, damping = given["effort"], given["velocity"], given["damping"]
    friction = given["friction"].value if "friction" in given else 0.0
    reached = max(0.0, effort.value - friction) / damping.value
    if reached >= _REACHED * speed.value:
        return None
    taken = f"damping of {damping.value:.4g} {damping.unit}"
    taken += f" and friction of {friction:.4g} {effort.unit} take" if friction else " takes"
    return (
        f"reachable speed: {taken} the whole effort of {effort.value:.4g} {effort.unit} at {reached:.4g} {speed.unit}, "
        f"{100.0 * reached / speed.value:.0f} % of the velocity limit of {speed.value:.4g} {speed.unit}"
    )


def body_size(motor: MotorSection) -> tuple[float, ...]:
    """Edges [m] of a motor's box, the shortest first; empty if they are unknown."""
    if motor.size is not None:
        return tuple(sorted(motor.size.value))
    if motor.diameter is not None and motor.length is not None:
        return tuple(sorted((motor.diameter.value, motor.diameter.value, motor.length.value)))
    return ()


def _armature(given: Mapping[str, Figure]) -> Figure | None:
    if "armature" in given or "rotor_inertia" not in given or "gear_ratio" not in given:
        return given.get("armature")
    rotor, ratio = given["rotor_inertia"], given["gear_ratio"]
    return Figure(rotor.value * ratio.value**2, f"derived: rotor_inertia x gear_ratio^2; {rotor.source}")


def _damping(motor: MotorSection, given: Mapping[str, Figure]) -> Figure | None:
    """Viscous damping with that of the back-EMF, once; of a drive that sets the voltage, else the slope of its line."""
    viscous, back_emf = given.get("viscous_damping"), given.get("back_emf_damping")
    if motor.control == "voltage" and back_emf is not None:
        if viscous is None:
            return back_emf
        source = f"derived: viscous_damping + back_emf_damping; {viscous.source}"
        return Figure(viscous.value + back_emf.value, source)
    stall, idle = given.get("stall_torque"), given.get("no_load_speed")
    if motor.control != "current" and motor.kind in _VOLTAGE_DRIVEN and stall is not None and idle is not None:
        return Figure(stall.value / idle.value, f"derived: stall_torque / no_load_speed; {stall.source}")
    return viscous


def _at(name: str, motor: MotorSection, voltage: float | None) -> dict[str, Figure]:
    """The figures at a supply: published ones, between two published ones a line, else in proportion."""
    given = motor.figures()
    own = given["voltage"].value if "voltage" in given else None
    if voltage is None or (own is not None and abs(voltage - own) <= _EXACT * own):
        return {key: _at_supply(figure, own) if key == "position_gain" else figure for key, figure in given.items()}
    if own is None:
        raise UnknownSupply(f"no source gives the supply of '{name}', so that its figures cannot be scaled")
    known = [own, *(other.voltage for other in motor.at_other_voltages)]
    if not _SUPPLIES[0] * min(known) <= voltage <= _SUPPLIES[1] * max(known):
        of = f"{min(known):g} to {max(known):g} V" if len(known) > 1 else f"{own:g} V"
        raise UnknownSupply(f"a supply of {voltage:g} V is too far from that of '{name}', {of}, to scale its figures")
    for key, kinds in _SCALED_BY_VOLTAGE.items():
        if key in given and motor.kind in kinds:
            figure = given[key]
            points = {figure.voltage or own: figure}
            for other in motor.at_other_voltages:
                at = getattr(other, key, None)
                if at is not None:
                    points[other.voltage] = Figure(at.value, at.source or other.source or motor.source or "")
            given[key] = _interpolated(points, voltage)
    return given


def _at_supply(figure: Figure, own: float | None) -> Figure:
    """A figure that holds at another supply than the motor's, in proportion."""
    if figure.voltage is None or own is None or figure.voltage == own:
        return figure
    return _interpolated({figure.voltage: figure}, own)


def _interpolated(points: Mapping[float, Figure], voltage: float) -> Figure:
    near = next((at for at in points if abs(at - voltage) <= _EXACT * voltage), None)
    if near is not None:
        return points[near]
    below = max((at for at in points if at < voltage), default=None)
    above = min((at for at in points if at > voltage), default=None)
    if below is not None and above is not None:
        share = (voltage - below) / (above - below)
        value = points[below].value + share * (points[above].value - points[below].value)
        source = f"derived: between {below:g} V and {above:g} V; {points[below].source}"
        return Figure(value, source)
    nearest = below if below is not None else above
    assert nearest is not None  # points are never empty
    source = f"derived: {nearest:g} V x {voltage / nearest:.4g}; {points[nearest].source}"
    return Figure(points[nearest].value * voltage / nearest, source)
