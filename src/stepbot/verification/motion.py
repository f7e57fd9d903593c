"""Compares motion: poses, equations of motion, closures."""

from collections.abc import Iterator
from itertools import repeat

import numpy as np
from msgspec.structs import replace

from stepbot.engines import engine_named
from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Observation, ObservedClosure
from stepbot.formats.lowering.masses import LEAST_MOMENT
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.poses import Poses
from stepbot.geometry.spatial import ZERO3, Array, Pose, angle_between, vector3
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.joint_types import HINGES
from stepbot.robot.mesh_names import SCOPE

from .deviation import Deviations

NO_GRAVITY = 5e-3
"""Share of weight times reach to which gravity forces are relative at least. Planar mechanisms have none, and files
round rotations to 1e-12, which turns weight times reach by as much."""

_FAST = 10.0
"""Acceleration [rad/s^2] above those of the motions that are compared."""


def compare_poses(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Every link at every configuration, relative to the root link."""
    for number, (ours, theirs) in enumerate(zip(reference.poses, observed.poses, strict=False), start=1):
        links = [link for link in ours if link in theirs]
        mine, others = (Poses.of(poses[link] for link in links) for poses in (ours, theirs))
        for link, (distance, angle) in zip(links, mine.distances_to(others), strict=True):
            where = f"link '{link}' at configuration {number}"
            deviations.off(distance, where, "m")
            deviations.off(angle, where, "rad")
    missing = len(reference.poses) - len(observed.poses)
    if observed.poses and missing:
        deviations.equal(False, f"{missing} of {len(reference.poses)} configurations were not reported")


def compare_mass_matrix(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """M(q) at every configuration, relative to its largest entry."""
    order = _order(deviations, reference, observed)
    if order is None:
        return
    allowed = _with_stand_ins(deviations.tolerance, reference)
    pairs = zip(reference.dynamics, observed.dynamics, _inertias_about_root(reference), strict=False)
    for number, (ours, theirs, whole) in enumerate(pairs, start=1):
        if ours.mass_matrix is None or theirs.mass_matrix is None:
            continue
        off = np.abs(theirs.mass_matrix[np.ix_(order, order)] - ours.mass_matrix)
        row, column = np.unravel_index(int(off.argmax()), off.shape)
        names = f"'{reference.coordinates[row]}', '{reference.coordinates[column]}'"
        scale = float(np.abs(ours.mass_matrix).max())
        where = f"mass matrix of {names} at configuration {number}"
        deviations.off(float(off.max()), where, "SI", scale, allowed, whole)


def _with_stand_ins(tolerance: Tolerance, reference: Observation, acceleration: float = 1.0) -> Tolerance:
    """The tolerance with what the least moments of links without mass add, at an acceleration [rad/s^2].

    Such links may also stand between several joints of one link, where they are not listed.
    """
    between = max(0, len(reference.coordinates) - len(reference.links) + 1)
    massless = between + sum(1 for link in reference.links if not link.mass)
    return replace(tolerance, absolute=tolerance.absolute + massless * LEAST_MOMENT * acceleration)


def compare_efforts(
    deviations: Deviations, reference: Observation, observed: Observation, which: str, words: str
) -> None:
    """Efforts at every configuration, relative to their largest entry at any of them.

    Args:
        which: The field of :class:`.Dynamics`.
        words: Before the joint.
    """
    order = _order(deviations, reference, observed)
    known = [efforts for dynamics in reference.dynamics if (efforts := getattr(dynamics, which)) is not None]
    if order is None or not known:
        return
    scale = max(float(np.abs(known).max()), NO_GRAVITY * _weight_times_reach(reference))
    allowed = _with_stand_ins(deviations.tolerance, reference, _FAST)
    for number, pair in enumerate(zip(reference.dynamics, observed.dynamics, strict=False), start=1):
        ours, theirs = (getattr(side, which) for side in pair)
        if ours is None or theirs is None:
            continue
        off = np.abs(theirs[order] - ours)
        name = reference.coordinates[int(off.argmax())]
        deviations.off(float(off.max()), f"{words} joint '{name}' at configuration {number}", "SI", scale, allowed)


def _order(deviations: Deviations, reference: Observation, observed: Observation) -> list[int] | None:
    """Indices of the reference's coordinates among the observed ones; None if there is nothing to compare."""
    if not reference.dynamics or not observed.dynamics:
        return None
    missing = [name for name in reference.coordinates if name not in observed.coordinates]
    extra = [name for name in observed.coordinates if name not in reference.coordinates]
    for name in (*missing, *extra):
        deviations.equal(False, f"joint '{name}' is a coordinate in one file only")
    if missing or extra or not reference.coordinates:
        return None
    return [observed.coordinates.index(name) for name in reference.coordinates]


def _inertias_about_root(observation: Observation) -> Iterator[float]:
    """Sum of mass times squared distance from the root [kg m2] at each configuration; then 0 without end."""
    for poses in observation.poses:
        links = [link for link in observation.links if link.name in poses]
        coms = np.array([link.com or ZERO3 for link in links]).reshape(-1, 3)
        moved = Poses.of(poses[link.name] for link in links).apply(coms)
        masses = np.array([link.mass or 0.0 for link in links])
        yield exact_sum((masses * np.square(moved).sum(axis=1)).tolist())
    yield from repeat(0.0)


def _weight_times_reach(observation: Observation) -> float:
    """Weight [N] times the largest distance [m] of any link from the root: a scale of gravity torques.

    At least that times the largest radius of gyration: a ball about the origin has no other length.
    """
    weight = exact_sum(link.mass or 0.0 for link in observation.links) * float(np.linalg.norm(GRAVITY))
    positions: Array = np.array([X.p for poses in observation.poses for X in poses.values()]).reshape(-1, 3)
    radii = [
        float(np.sqrt(np.abs(link.inertia).max() / link.mass))
        for link in observation.links
        if link.mass and link.inertia is not None
    ]
    return weight * max(float(np.linalg.norm(positions, axis=1).max(initial=0.0)), *radii, 0.0)


def compare_closures(deviations: Deviations, reference: Observation, observed: Observation) -> None:
    """Closures by name: links, positions, and gaps over the mechanism's range."""
    if reference.closures is None or observed.closures is None:
        return
    theirs = {closure.name: closure for closure in observed.closures}
    known = {closure.name for closure in reference.closures}
    for name in theirs:  # MuJoCo constrains the axis of a closure by a second constraint, <closure>::axis
        if name.split(SCOPE)[0] not in known:
            deviations.equal(False, f"closure '{name}' is not in the robot")
    gap = exact_sum(closure.residual or 0.0 for closure in observed.closures)
    for ours in reference.closures:
        if ours.name not in theirs:
            deviations.equal(False, f"closure '{ours.name}' is missing")
            continue
        counterpart = theirs[ours.name]
        if (counterpart.link_a, counterpart.link_b) == (ours.link_b, ours.link_a):
            counterpart = _turned(counterpart)
        links = (counterpart.link_a, counterpart.link_b) == (ours.link_a, ours.link_b)
        deviations.equal(links, f"closure '{ours.name}' holds '{counterpart.link_a}' to '{counterpart.link_b}'")
        engine = engine_named(observed.engine)
        several = engine.several_loops if engine and len(reference.closures) > 1 else None
        _compare_closure(deviations, ours, counterpart, observed.engine, several or deviations.tolerance, gap)


def _turned(closure: ObservedClosure) -> ObservedClosure:
    """The same closure with its ends exchanged."""
    return replace(
        closure,
        link_a=closure.link_b,
        link_b=closure.link_a,
        X_AF=closure.X_BF,
        X_BF=closure.X_AF,
        points=closure.points and closure.points[::-1],
        axes=closure.axes and closure.axes[::-1],
    )


def _compare_closure(
    deviations: Deviations,
    ours: ObservedClosure,
    observed: ObservedClosure,
    engine: str,
    open_by: Tolerance,
    gap: float,
) -> None:
    name = f"closure '{ours.name}'"
    for side, X, Y in (("a", ours.X_AF, observed.X_AF), ("b", ours.X_BF, observed.X_BF)):
        if X is None or Y is None:
            continue
        deviations.equal(ours.kind == observed.kind, f"{name}: {observed.kind}", expected=f"{ours.kind}")
        deviations.off(float(np.linalg.norm(X.p - Y.p)), f"{name}, frame on link {side}", "m")
        deviations.off(_turn(ours, X, Y), f"{name}, frame on link {side}", "rad")
    if ours.axis is not None and observed.axis is not None:
        deviations.off(float(np.linalg.norm(np.subtract(ours.axis, observed.axis))), f"axis of {name}", "rad")
    _compare_held(deviations, name, ours, observed)
    # A loop that cannot close exactly has no exact solution, and each solver distributes the gap differently.
    own = ours.residual or 0.0
    reach = max((float(np.linalg.norm(X.p)) for X in (ours.X_AF, ours.X_BF) if X is not None), default=0.0)
    if observed.residual is not None:
        deviations.off(max(observed.residual - 2.0 * own, 0.0), f"{name} over its range", "m", reach, open_by)
    if observed.angle_error is not None:
        simulator = engine_named(engine)
        simulated = simulator.driven_angle if simulator else None
        # A simulation leaves gaps, which are compared above; next to a dead centre, small ones turn joints far.
        angle = deviations.tolerance.absolute if simulated is None else simulated + gap * ours.sensitivity
        allowed = Tolerance(angle, relative=10.0)
        where = f"following joints of {name}"
        deviations.off(observed.angle_error, where, "rad or m", own / (reach or 1.0), tolerance=allowed)


def _turn(closure: ObservedClosure, X: Pose, Y: Pose) -> float:
    """Angle [rad] between two orientations of an end of a closure, but for turns that it leaves free."""
    if closure.kind == "ball":
        return 0.0
    if closure.kind in HINGES and closure.axis is not None:
        return angle_between(vector3(X.R @ closure.axis), vector3(Y.R @ closure.axis))
    return X.distance_to(Y)[1]


def _compare_held(deviations: Deviations, name: str, ours: ObservedClosure, observed: ObservedClosure) -> None:
    """The points and the axes of a closure; the sign of an axis has no meaning."""
    if ours.points is None or observed.points is None:
        return
    for side, expected, seen in zip("ab", ours.points, observed.points, strict=True):
        deviations.off(float(np.linalg.norm(np.subtract(seen, expected))), f"{name}, point on link {side}", "m")
    wrong = f"{name} holds " + ("no axis" if ours.axes else "an axis that is not in the robot")
    deviations.equal((ours.axes is None) == (observed.axes is None), wrong)
    if ours.axes is None or observed.axes is None:
        return
    lengths = [np.linalg.norm(axes[0]) / np.linalg.norm(axes[1]) for axes in (ours.axes, observed.axes)]
    deviations.off(abs(float(lengths[1] - lengths[0])), f"{name}, points on its axis", "of their distance")
    way = 1.0 if np.dot(ours.axes[0], observed.axes[0]) > 0.0 else -1.0
    for side, axis, other in zip("ab", ours.axes, observed.axes, strict=True):
        deviations.off(angle_between(axis, vector3(way * np.array(other))), f"{name}, axis on link {side}", "rad")
