"""Compares what links and joints have: visuals and collisions, excluded contacts, actuators and sensors."""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf, isfinite
from typing import TypeVar

import numpy as np
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedActuator, ObservedLink, ObservedSensor, ObservedShape
from stepbot.formats.lowering.joints import UNLIMITED
from stepbot.robot.model import ActuatorKind
from stepbot.robot.surfaces import SURFACE_FIELDS

from .deviation import COLOR, SURFACE, Deviations


def link_pairs(reference: Observation, observed: Observation) -> list[tuple[ObservedLink, ObservedLink]]:
    """Links of the same name on both sides, in the order of the reference."""
    theirs = {link.name: link for link in observed.links}
    return [(link, theirs[link.name]) for link in reference.links if link.name in theirs]


Named = ObservedLink | ObservedActuator | ObservedSensor


def compare_names(deviations: Deviations, what: str, reference: Sequence[Named], observed: Sequence[Named]) -> None:
    """Every name on one side must exist on the other, equally often."""
    ours, theirs = (Counter(one.name for one in side) for side in (reference, observed))
    for name in ours | theirs:
        wrong = "is missing" if theirs[name] < ours[name] else "is not in the robot"
        deviations.equal(theirs[name] == ours[name], f"{what} '{name}' {wrong}")


_RENAMED = re.compile(r"(_geom)+(_\d+)?$")
"""Suffixes of formats that require different names of visuals and collisions."""


def plain_name(name: str, link: str = "") -> str:
    """The name of a shape, without the format's suffixes, such as its link where names are unique in the file."""
    return _RENAMED.sub("", name).removesuffix(f"_{link}" if link else "")


def compare_meshes(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """All meshes exist, and the bounding boxes of each link's visuals and collisions are equal."""
    for uri in observed.missing_meshes:
        deviations.equal(False, f"mesh '{uri}' is missing")
    for a, b in link_pairs(reference, observed):
        for side in ("visual", "collision"):
            _compare_presence(deviations, a, b, side)
            expected, observed_box = getattr(a, f"{side}_bounds"), getattr(b, f"{side}_bounds")
            if expected is not None and observed_box is not None:
                off = float(np.abs(np.subtract(observed_box, expected)).max())
                diagonal = float(np.linalg.norm(np.subtract(expected[1], expected[0])))
                deviations.off(off, f"{side} box of link '{a.name}'", "m", diagonal)
            elif expected is not None:
                deviations.unreported.append(f"{side} boxes")
            _compare_boxes(deviations, side, a.name, getattr(a, f"{side}s"), getattr(b, f"{side}s"))


def _compare_boxes(
    deviations: Deviations,
    side: str,
    link: str,
    expected: Sequence[ObservedShape] | None,
    observed: Sequence[ObservedShape] | None,
) -> None:
    """The bounding box of each shape, if both sides have as many; the number is compared with their names."""
    if expected is None or observed is None or len(expected) != len(observed):
        return
    for number, (a, b) in enumerate(zip(expected, observed, strict=True), start=1):
        which = f"{side} {_called(a, number)} of link '{link}'"
        for words, ours, theirs in (("box", a.bounds, b.bounds), ("oblique box", a.oblique, b.oblique)):
            if ours is not None and theirs is not None:
                off = float(np.abs(np.subtract(theirs, ours)).max())
                diagonal = float(np.linalg.norm(np.subtract(ours[1], ours[0])))
                deviations.off(off, f"{words} of {which}", "m", diagonal)


def _called(shape: ObservedShape, number: int) -> str:
    return f"'{shape.name}'" if shape.name else str(number)


def _compare_presence(deviations: Deviations, a: ObservedLink, b: ObservedLink, side: str) -> None:
    """Whether there are visuals, or collisions, must agree even if their extent is not reported."""
    expected, has_observed = getattr(a, f"has_{side}s"), getattr(b, f"has_{side}s")
    if expected is not None and has_observed is not None:
        wrong = (
            f"link '{a.name}' has no {side}" if expected else f"link '{a.name}' has a {side} that is not in the robot"
        )
        deviations.equal(expected == has_observed, wrong)


def compare_shapes(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Names and colours of all visuals or collisions, one by one, in the order of the files."""
    for a, b in link_pairs(reference, observed):
        for side in ("visual", "collision"):
            expected, observed_shapes = getattr(a, f"{side}s"), getattr(b, f"{side}s")
            # If has_visuals is not reported, the engine displays something else in place of missing visuals.
            if expected is None or observed_shapes is None or (not expected and getattr(b, f"has_{side}s") is None):
                continue
            _compare_series(deviations, side, a.name, expected, observed_shapes)


def _compare_series(
    deviations: Deviations, side: str, link: str, expected: Sequence[ObservedShape], observed: Sequence[ObservedShape]
) -> None:
    count = f"{side} shapes of link '{link}': {len(observed)}"
    deviations.equal(len(expected) == len(observed), count, expected=str(len(expected)))
    for number, (a, b) in enumerate(zip(expected, observed, strict=False), start=1):
        which = f"{side} {_called(a, number)} of link '{link}'"
        if a.name is not None and b.name is not None:
            deviations.equal(plain_name(a.name, link) == plain_name(b.name, link), f"{which}: named '{b.name}'")
        if a.rgba is not None and b.rgba is not None and (a.rgba or not b.rgba_is_default):
            _compare_colors(deviations, f"colour of {which}", a.rgba, b.rgba)
        if a.ambient is not None and b.ambient is not None:
            _compare_colors(deviations, f"ambient colour of {which}", a.ambient, b.ambient)
        _compare_surfaces(deviations, which, a, b)
        if a.groups is not None and b.groups is not None:
            words = f"{which}: in group, contype and conaffinity {b.groups}"
            deviations.equal(a.groups == b.groups, words, expected=f"{a.groups}")


def _compare_surfaces(deviations: Deviations, which: str, ours: ObservedShape, theirs: ObservedShape) -> None:
    """The contact properties that one side states and the other reports; the engine's own only between its files."""
    a, b, own = ours.surface, theirs.surface, ours.surface_default
    if own is not None and theirs.surface_default is not None:
        a, b, own = a or own, b or theirs.surface_default, None
    for name in SURFACE_FIELDS if a is not None and b is not None else ():
        expected, observed = getattr(a, name), getattr(b, name)
        is_own = own is not None and expected == getattr(own, name)
        if expected is not None and observed is not None and not is_own:
            deviations.off(abs(observed - expected), f"{name} of {which}", "SI", expected, tolerance=SURFACE)


def _compare_colors(deviations: Deviations, where: str, ours: tuple[float, ...], theirs: tuple[float, ...]) -> None:
    if len(ours) != len(theirs):
        deviations.equal(False, f"{where} is " + ("missing" if ours else "not in the robot"))
        return
    off = float(np.abs(np.subtract(theirs, ours)).max(initial=0.0))
    deviations.off(off, where, "of full colour", tolerance=COLOR)


def compare_contacts(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Pairs of links whose contacts are excluded; a link that only one has is a difference of the links alone."""
    if reference.excluded_pairs is None or observed.excluded_pairs is None:
        return
    deviations.equal(True, "")
    common = {link.name for link in reference.links} & {link.name for link in observed.links}
    for a, b in dict.fromkeys([*reference.excluded_pairs, *observed.excluded_pairs]):
        if not {a, b} <= common:
            continue
        wrong = "may touch" if (a, b) in reference.excluded_pairs else "can never collide"
        deviations.equal(
            ((a, b) in reference.excluded_pairs) == ((a, b) in observed.excluded_pairs),
            f"links '{a}' and '{b}' {wrong}",
        )


Device = TypeVar("Device", ObservedActuator, ObservedSensor)

_ROUNDING = 1e-6
"""Relative error of a bound that was divided by the gear and multiplied again, in single precision."""
_UNITS = {"rate": "Hz", "fov": "rad", "columns": "pixels", "rows": "pixels", "nearest": "m", "farthest": "m"}


def compare_actuators(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Joint, kind, gear, gains, and the bounds of input and force."""
    if reference.actuators is not None and observed.actuators is not None:
        _compare_devices(deviations, "actuator", reference.actuators, observed.actuators, _compare_actuator)


def compare_sensors(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Kind, link, joint, pose, rate, and field of view."""
    if reference.sensors is not None and observed.sensors is not None:
        _compare_devices(deviations, "sensor", reference.sensors, observed.sensors, _compare_sensor)


def _compare_devices(
    deviations: Deviations,
    what: str,
    reference: Sequence[Device],
    observed: Sequence[Device],
    compare: Callable[[Deviations, Device, Device], None],
) -> None:
    """Compare pairs; a device on one side only is a failure."""
    ours: list[Device] = _named(reference, observed)
    theirs: list[Device] = _named(observed, reference)
    compare_names(deviations, what, ours, theirs)
    for expected, observed_device in _pairs(ours, theirs):
        compare(deviations, expected, observed_device)


def _pairs(ours: Iterable[Device], theirs: Iterable[Device]) -> Iterator[tuple[Device, Device]]:
    """Devices of one name: those at the same place first, since SDFormat lets each joint have a sensor of that name."""
    free, left = list(ours), list(theirs)
    for key in (lambda one: (one.name, one.joint, getattr(one, "link", None)), lambda one: one.name):
        for device in list(left):
            same = next((n for n, one in enumerate(free) if key(one) == key(device)), None)
            if same is not None:
                left.remove(device)
                yield free.pop(same), device


def _named(devices: Sequence[Device], others: Sequence[Device]) -> list[Device]:
    """The devices by name if the other side has the same name on the same joint, or else by joint."""
    free = [other for other in others if other.name and all(other.name != device.name for device in devices)]
    named = []
    for device in devices:
        if not device.name:
            like = [other for other in free if (other.kind, other.joint) == (device.kind, device.joint)]
            free = [other for other in free if other not in like[:1]]
            device = replace(device, name=like[0].name if like else f"{device.kind} of {device.joint}")
        named.append(device)
    return named


def _compare_actuator(deviations: Deviations, a: ObservedActuator, b: ObservedActuator) -> None:
    who = f"actuator '{a.name}'"
    deviations.equal(a.joint == b.joint, f"{who}: on joint '{b.joint}'", expected=f"'{a.joint}'")
    deviations.equal(a.kind == b.kind, f"{who}: {b.kind}", expected=f"{a.kind}")
    for name in ("gear", "kp", "kv"):
        expected, seen = getattr(a, name), getattr(b, name)
        if expected is not None and seen is not None:
            deviations.near(seen, expected, f"{name} of {who}", "SI")
        elif name != "gear" and expected:  # formats without gears have gains, too, and 0 may be left out
            deviations.equal(False, f"{who}: no {name}", expected=f"{expected}")
        elif name != "gear" and seen is not None:
            deviations.unreported.append(name)
    for name in ("control", "force"):
        bounds, observed = getattr(a, name), getattr(b, name)
        if bounds is None or observed is None:
            if bounds is not None and any(map(isfinite, bounds)):
                deviations.unreported.append(f"{name} range")
            continue
        ranges = _both_or_none(bounds, _at_joint(a, name)), _both_or_none(observed, _at_joint(b, name))
        for side, wanted, given in zip(("lowest", "highest"), *ranges, strict=True):
            deviations.near(given, wanted, f"{side} {name} of {who}", "SI")


def _at_joint(drive: ObservedActuator, what: str) -> float:
    """Factor from the actuator to its joint, of inputs or forces."""
    gear = abs(drive.gear or 1.0)
    return gear if what == "force" or drive.kind == ActuatorKind.MOTOR else 1.0 / gear


def _both_or_none(bounds: tuple[float, float], at_joint: float) -> tuple[float, float]:
    """A range; one that is unbounded on one side, or has a number that means unlimited at the joint, is unlimited."""
    return bounds if all(abs(bound) * at_joint < UNLIMITED * (1.0 - _ROUNDING) for bound in bounds) else (-inf, inf)


def _compare_sensor(deviations: Deviations, a: ObservedSensor, b: ObservedSensor) -> None:
    who = f"sensor '{a.name}'"
    deviations.equal(a.kind == b.kind, f"{who}: {b.kind}", expected=f"{a.kind}")
    for name in ("link", "joint"):
        expected, observed = getattr(a, name), getattr(b, name)
        if expected is not None and observed is not None:
            deviations.equal(expected == observed, f"{who}: on {name} '{observed}'", expected=f"'{expected}'")
    if a.X_LS is not None and b.X_LS is not None:
        distance, angle = a.X_LS.distance_to(b.X_LS)
        deviations.off(distance, f"place of {who}", "m")
        deviations.off(angle, f"place of {who}", "rad")
    for name, unit in _UNITS.items():
        expected, observed = getattr(a, name), getattr(b, name)
        if expected is not None and observed is not None:
            deviations.near(observed, expected, f"{name} of {who}", unit)
        elif expected:
            deviations.unreported.append(name)
