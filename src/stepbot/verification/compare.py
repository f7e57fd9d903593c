"""One comparison for all formats and engines: two observations that should be of the same robot.

Links are paired by name, joints by their child link (MuJoCo has no names for fixed joints). A quantity that one side
does not report is not compared, and recorded as not run, never as passed.
"""

from collections.abc import Callable, Mapping
from functools import partial
from math import dist, inf, nan

import numpy as np
from msgspec import Struct

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, Quantity
from stepbot.geometry.spatial import Array, angle_between
from stepbot.robot.mesh_names import SCOPE

from .deviation import Deviations, tolerance
from .motion import compare_closures, compare_efforts, compare_mass_matrix, compare_poses
from .shapes import (
    compare_actuators,
    compare_contacts,
    compare_meshes,
    compare_names,
    compare_sensors,
    compare_shapes,
    link_pairs,
)

EARTH = (9.76, 9.84)
"""Acceleration of gravity [m/s^2] on the ground anywhere on Earth: 9.764 on Huascaran, 9.834 on the Arctic Ocean.
https://doi.org/10.1002/grl.50838"""
_SIDEWAYS = 1e-9
"""Maximum horizontal gravity [m/s^2] if the other file leaves gravity to the simulator."""


def compare_gravity_settings(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Compare the acceleration of gravity, and its share that acts on each link.

    A file without an acceleration of gravity leaves it to the simulator; the other file must then have Earth's.
    """
    if reference.gravity is not None and observed.gravity is not None:
        _compare_acceleration(deviations, reference.gravity, observed.gravity)
    for a, b in link_pairs(reference, observed):
        if a.gravity_compensation is None or b.gravity_compensation is None or not (a.mass or b.mass):
            continue
        where = f"gravity compensation of link '{a.name}'"
        deviations.near(b.gravity_compensation, a.gravity_compensation, where, "of its weight")


def _compare_acceleration(deviations: Deviations, expected: tuple[float, ...], observed: tuple[float, ...]) -> None:
    if expected and observed:
        where = f"acceleration of gravity {_text(observed)} instead of {_text(expected)}"
        deviations.off(dist(expected, observed), where, "m/s^2")
        return
    for given in filter(None, (expected, observed)):
        there = "here" if given is observed else "in the file that it is compared with"
        words = f"acceleration of gravity {_text(given)} {there}; the other file leaves it to the simulator: Earth's"
        deviations.equal(_is_earths(given), f"{words} is expected, {EARTH[0]:g} to {EARTH[1]:g} m/s^2 downwards")


def _is_earths(gravity: tuple[float, ...]) -> bool:
    x, y, z = gravity
    return max(abs(x), abs(y)) <= _SIDEWAYS and EARTH[0] <= -z <= EARTH[1]


def _text(gravity: tuple[float, ...]) -> str:
    return f"({', '.join(f'{one:.10g}' for one in gravity)})"


Comparison = Callable[[Deviations, Observation, Observation], None]


class QuantityComparison(Struct, frozen=True):
    """The result of comparing one quantity."""

    quantity: Quantity
    deviations: Deviations
    not_run: str = ""
    """Why nothing was compared; empty if something was."""


def compare(reference: Observation, observed: Observation) -> tuple[QuantityComparison, ...]:
    """Compare everything that both sides report, in the order of the report.

    Quantities that the robot does not have (loops, mimics, frames) are left out.
    """
    results = []
    for quantity, comparison in _COMPARISONS.items():
        has = _HAS.get(quantity)
        if has and not (has(reference) or has(observed)):
            continue
        deviations = Deviations(tolerance((reference.engine, observed.engine), quantity))
        reason = observed.not_run.get(quantity) or reference.not_run.get(quantity) or ""
        if not reason:
            comparison(deviations, reference, observed)
            if not deviations.deviations and has and (quantity in _OPTIONAL or not has(reference)):
                continue
            if not deviations.deviations:
                reason = f"{observed.engine} does not report it"
        results.append(QuantityComparison(quantity, deviations, reason))
    return tuple(results)


def _compare_links(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    if reference.name is not None and observed.name is not None:
        deviations.equal(
            reference.name == observed.name, f"robot is named '{observed.name}'", expected=f"'{reference.name}'"
        )
    compare_names(deviations, "link", reference.links, observed.links)


def _kind(joint: ObservedJoint) -> str:
    """Type of a joint; a revolute one without limits is continuous, because most engines do not distinguish them."""
    unlimited = joint.limit is not None and joint.limit.lower == -inf and joint.limit.upper == inf
    reported = {"lower", "upper"} <= set(joint.limit_fields)
    return "continuous" if joint.kind == "revolute" and unlimited and reported else joint.kind


def _compare_joints(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    ours, theirs = _by_child(reference), _by_child(observed)
    deviations.equal(len(ours) == len(theirs), f"{len(observed.joints)} joints", expected=f"{len(reference.joints)}")
    for child in dict.fromkeys([*ours, *theirs]):
        a, b = ours.get(child), theirs.get(child)
        if a is None or b is None:
            joint = a or b
            assert joint is not None
            wrong = "is missing" if b is None else "is not in the robot"
            deviations.equal(False, f"joint '{joint.name}' above link '{child}' {wrong}")
            continue
        known = a.name and b.name
        deviations.equal(
            not known or a.name == b.name, f"joint above link '{child}': named '{b.name}'", expected=f"'{a.name}'"
        )
        deviations.equal(_kind(a) == _kind(b), f"joint '{a.name}': {_kind(b)}", expected=f"{_kind(a)}")
        deviations.equal(a.parent == b.parent, f"joint '{a.name}': parent '{b.parent}'", expected=f"'{a.parent}'")
    if reference.base is not None and observed.base is not None:
        deviations.equal(reference.base == observed.base, f"base: {observed.base}", expected=f"{reference.base}")


def _by_child(observation: Observation) -> dict[str, ObservedJoint]:
    return {joint.child: joint for joint in observation.joints}


def _moving_pairs(reference: Observation, observed: Observation) -> list[tuple[ObservedJoint, ObservedJoint]]:
    """Joints that move on both sides."""
    theirs = _by_child(observed)
    pairs = [(joint, theirs[joint.child]) for joint in reference.joints if joint.child in theirs]
    return [(a, b) for a, b in pairs if a.kind != "fixed" and b.kind != "fixed"]


def _compare_axes(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in _moving_pairs(reference, observed):
        for words, expected, observed_axis in (("axis", a.axis, b.axis), ("second axis", a.axis2, b.axis2)):
            if expected is not None and observed_axis is not None:
                deviations.off(angle_between(expected, observed_axis), f"{words} of joint '{a.name}'", "rad")
        if a.pitch is not None and b.pitch is not None:
            deviations.near(b.pitch, a.pitch, f"pitch of joint '{a.name}'", "m/rad")


def _compare_limits(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in _moving_pairs(reference, observed):
        if a.limit is None or b.limit is None:
            continue
        for name in a.limit_fields:
            if name in b.limit_fields:
                expected, observed_limit = getattr(a.limit, name), getattr(b.limit, name)
                deviations.near(observed_limit, expected, f"{name} limit of joint '{a.name}'", _unit(a, name))
            else:
                deviations.unreported.append(name)


def _unit(joint: ObservedJoint, name: str) -> str:
    sliding = joint.kind == "prismatic"
    if name == "effort":
        return "N" if sliding else "N m"
    return ("m" if sliding else "rad") + ("/s" if name == "velocity" else "")


def _compare_dynamics(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in _moving_pairs(reference, observed):
        if a.dynamics is None or b.dynamics is None:
            continue
        for name in a.dynamics_fields:
            expected = getattr(a.dynamics, name)
            if name in b.dynamics_fields:
                words = f"{name.replace('_', ' ')} of joint '{a.name}'"
                deviations.near(getattr(b.dynamics, name), expected, words, "SI")
            elif expected:
                deviations.unreported.append(name.replace("_", " "))


def _compare_mimic(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in _moving_pairs(reference, observed):
        if not (a.mimic_read and b.mimic_read and (a.mimic or b.mimic)):
            continue
        if a.mimic is None or b.mimic is None:
            deviations.equal(False, f"joint '{a.name}': " + ("does not mimic" if a.mimic else "mimics another"))
            continue
        leads = a.mimic.joint == b.mimic.joint
        deviations.equal(leads, f"joint '{a.name}': mimics '{b.mimic.joint}'", expected=f"'{a.mimic.joint}'")
        for name in ("multiplier", "offset"):
            expected, observed_value = getattr(a.mimic, name), getattr(b.mimic, name)
            deviations.near(observed_value, expected, f"mimic {name} of joint '{a.name}'", "SI")


def _compare_mass(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in link_pairs(reference, observed):
        if a.mass is not None and b.mass is not None:
            deviations.near(b.mass, a.mass, f"mass of link '{a.name}'", "kg")


def _compare_com(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in link_pairs(reference, observed):
        if a.com is None or b.com is None or not (a.mass or b.mass):  # without mass there is no centre of mass
            continue
        off = float(np.linalg.norm(np.subtract(b.com, a.com)))
        deviations.off(off, f"centre of mass of link '{a.name}'", "m", max(_gyration(a), float(np.linalg.norm(a.com))))


def _gyration(link: ObservedLink) -> float:
    """Radius of gyration [m]: the size of a link according to its inertia."""
    if not link.mass or link.mass < 0.0 or link.inertia is None:
        return 0.0
    return float(np.sqrt(max(np.trace(np.array(link.inertia)), 0.0) / (2.0 * link.mass)))


def _compare_inertia(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    for a, b in link_pairs(reference, observed):
        if a.inertia is not None and b.inertia is not None:
            expected: Array = np.array(a.inertia)
            off = float(np.abs(np.array(b.inertia) - expected).max())
            about_origin = (a.mass or 0.0) * float(np.sum(np.square(a.com or 0.0)))  # Drake stores it so
            largest = float(np.abs(expected).max())
            deviations.off(off, f"inertia of link '{a.name}'", "kg m^2", largest, whole=about_origin)


def _compare_frames(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    if reference.frames is None or observed.frames is None:
        return
    loops = {closure.name for closure in reference.closures or ()}
    # MuJoCo's sites include the ends of closures, as <closure>::a.
    extra = [name for name in observed.frames if name not in reference.frames and name.split(SCOPE)[0] not in loops]
    for name in extra:
        deviations.equal(False, f"frame '{name}' is not in the robot")
    for name, (link, X_LF) in reference.frames.items():
        if name not in observed.frames:
            deviations.equal(False, f"frame '{name}' is missing")
            continue
        observed_link, Y_LF = observed.frames[name]
        deviations.equal(link == observed_link, f"frame '{name}': on link '{observed_link}'", expected=f"'{link}'")
        distance, angle = X_LF.distance_to(Y_LF)
        deviations.off(distance, f"frame '{name}'", "m")
        deviations.off(angle, f"frame '{name}'", "rad")


def _compare_initial(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    if reference.initial is None or observed.initial is None:
        return
    kinds = {joint.name: joint.kind for joint in reference.joints}
    for name, position in reference.initial.items():
        unit = "rad or m" if name not in kinds else "m" if kinds[name] == "prismatic" else "rad"
        deviations.near(observed.initial.get(name, nan), position, f"initial position of joint '{name}'", unit)


def _compare_simulation(deviations: Deviations, _reference: Observation, observed: Observation) -> None:
    if observed.simulation_finite is not None:
        pairs = ", ".join(f"'{a}' and '{b}'" for a, b in observed.initial_penetrations)
        cause = f"; it does not without contacts of links that overlap in the initial pose: {pairs}" if pairs else ""
        deviations.equal(observed.simulation_finite, f"simulation diverged{cause}")


def _compare_warnings(deviations: Deviations, _reference: Observation, observed: Observation) -> None:
    deviations.equal(True, "")
    for warning in observed.warnings:
        deviations.equal(False, warning)


_COMPARISONS: Mapping[Quantity, Comparison] = {
    Quantity.LOAD: lambda deviations, _reference, _observed: deviations.equal(True, ""),
    Quantity.LINKS: _compare_links,
    Quantity.JOINTS: _compare_joints,
    Quantity.AXES: _compare_axes,
    Quantity.LIMITS: _compare_limits,
    Quantity.DYNAMICS: _compare_dynamics,
    Quantity.MIMIC: _compare_mimic,
    Quantity.MASS: _compare_mass,
    Quantity.COM: _compare_com,
    Quantity.INERTIA: _compare_inertia,
    Quantity.GRAVITY_SETTINGS: compare_gravity_settings,
    Quantity.POSES: compare_poses,
    Quantity.MASS_MATRIX: compare_mass_matrix,
    Quantity.GRAVITY: partial(compare_efforts, which="gravity", words="gravity force on"),
    Quantity.INVERSE_DYNAMICS: partial(compare_efforts, which="inverse", words="effort of"),
    Quantity.CLOSURES: compare_closures,
    Quantity.MESHES: compare_meshes,
    Quantity.SHAPES: compare_shapes,
    Quantity.CONTACTS: compare_contacts,
    Quantity.FRAMES: _compare_frames,
    Quantity.ACTUATORS: compare_actuators,
    Quantity.SENSORS: compare_sensors,
    Quantity.INITIAL: _compare_initial,
    Quantity.SIMULATION: _compare_simulation,
    Quantity.WARNINGS: _compare_warnings,
}


def _moves(observation: Observation) -> bool:
    return any(joint.kind != "fixed" for joint in observation.joints)


def _has_shapes(observation: Observation) -> bool:
    return any(link.has_visuals or link.has_collisions for link in observation.links) or bool(
        observation.missing_meshes
    )


_HAS: Mapping[Quantity, Callable[[Observation], bool]] = {
    Quantity.AXES: lambda observation: any(joint.axis is not None for joint in observation.joints),
    Quantity.COM: lambda observation: any(link.mass != 0.0 for link in observation.links),
    Quantity.LIMITS: _moves,
    Quantity.DYNAMICS: _moves,
    Quantity.MIMIC: lambda observation: any(joint.mimic for joint in observation.joints),
    Quantity.GRAVITY_SETTINGS: lambda observation: (
        bool(observation.gravity) or any(link.gravity_compensation for link in observation.links)
    ),
    Quantity.MASS_MATRIX: _moves,
    Quantity.GRAVITY: _moves,
    Quantity.INVERSE_DYNAMICS: _moves,
    Quantity.CLOSURES: lambda observation: bool(observation.closures),
    Quantity.MESHES: _has_shapes,
    Quantity.SHAPES: _has_shapes,
    Quantity.CONTACTS: lambda observation: bool(observation.excluded_pairs),
    Quantity.FRAMES: lambda observation: bool(observation.frames),
    Quantity.ACTUATORS: lambda observation: bool(observation.actuators),
    Quantity.SENSORS: lambda observation: bool(observation.sensors),
    Quantity.INITIAL: lambda observation: observation.initial is not None and any(observation.initial.values()),
}
"""Whether a robot has the quantity; every robot has the others."""

_OPTIONAL = frozenset({Quantity.GRAVITY_SETTINGS, Quantity.INITIAL, Quantity.CONTACTS, Quantity.SHAPES})
"""Quantities that few formats or engines report; their loss is reported by the writer, not as an omitted check."""
