"""Simulation in PyBullet: passive motion, and loops closed by added constraints, since no file format has them."""

from collections.abc import Mapping, Sequence
from math import ceil, dist, inf, isfinite, isnan
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.model import JointKind, LoopClosure, Mimic
from stepbot.robot.pybullet_closures import SECOND_POINT, add_constraints, constraints_of

from ..observation import ObservedClosure, Request

if TYPE_CHECKING:
    from .body import Body

STEP = 1e-3
"""Step [s] of all simulations here."""
SWEEPS = 200
"""Solver iterations per step for loops that share joints: the solver takes constraints one by one, and its default, 50,
leaves coupled loops open four to eight times as wide."""
_SWEEPS_OF_ONE = 50
"""PyBullet's default, for a loop of its own, whatever else is in the robot."""
_SWEEPS_OF_SLOW = (1000, 10000)
"""The same where loops are driven slowly, and where they are still open."""
_THRESHOLD = 1e-7
"""PyBullet's default of the squared residual at which the solver stops."""
_ROUNDING = 1e-9
"""Share of a way that is rounding."""
_SLOWEST = 100.0
"""Factor by which driven joints slow down at most."""
SPEED = 1.0
"""Speed of a driven joint [rad/s]."""
SLIDING_SPEED = 0.1
"""Speed of a driven prismatic joint [m/s]."""
_GEAR_CORRECTION = 0.2
"""Part of a mimic's error in position that each step corrects: without, the errors of all steps add up, and pull the
loops apart that imply the same motion."""
STRENGTH = 1e3
"""Maximum force [N], [N m] of motors and constraints, per newton of weight: enough to start at once, but not enough to
jam a loop whose pins are not exactly parallel."""


def simulate(body: "Body", request: Request) -> bool:
    """Simulate from the initial pose, without motors; returns whether all values stayed finite."""
    engine, step = body.engine, min(STEP, request.timestep)
    engine.setTimeStep(step)
    body.set(request.initial)
    release(body)
    gears(body, request.mimics, strength(body))
    for _ in range(round(request.simulate / step)):
        engine.stepSimulation()
    states = [engine.getJointState(body.id, index)[:2] for index in body.coordinates.values()]
    base = [*engine.getBasePositionAndOrientation(body.id), *engine.getBaseVelocity(body.id)]
    return all(isfinite(value) for state in (*states, *base) for value in state)


def strength(body: "Body") -> float:
    """Maximum force [N], [N m] of motors and constraints on a body."""
    masses = [float(body.engine.getDynamicsInfo(body.id, index)[0]) for index in range(-1, len(body.joints))]
    return STRENGTH * max(1e-3, exact_sum(masses)) * float(np.linalg.norm(GRAVITY))


def release(body: "Body") -> None:
    """Switch off the velocity motors that PyBullet adds to every joint."""
    for index in body.coordinates.values():
        body.engine.setJointMotorControl2(body.id, index, body.engine.VELOCITY_CONTROL, force=0.0)


def gears(body: "Body", mimics: Mapping[str, Mimic], force: float) -> list[int]:
    """Make mimicking joints follow, by a gear of a maximum force [N], [N m] from the leader's link to theirs.

    PyBullet's ratio has the opposite sign: leader + ratio * follower = const. Returns the constraints.
    """
    engine, made = body.engine, []
    for name, mimic in mimics.items():
        follower, leader = body.coordinates[name], body.coordinates[mimic.joint]
        if mimic.multiplier == 0.0:
            continue
        axis = body.joints[follower][13]
        gear = engine.createConstraint(
            body.id, leader, body.id, follower, engine.JOINT_GEAR, axis, [0, 0, 0], [0, 0, 0]
        )
        engine.changeConstraint(
            gear,
            gearRatio=-1.0 / mimic.multiplier,
            relativePositionTarget=-mimic.offset / mimic.multiplier,
            erp=_GEAR_CORRECTION,
            maxForce=force,
        )
        made.append(gear)
    return made


def close_in_simulation(body: "Body", request: Request) -> tuple[tuple[ObservedClosure, ...], tuple[str, ...]]:
    """Drive the mechanism through its range, loops closed by constraints, and report the gaps.

    Loops without common joints are driven one after the other, all other joints held: PyBullet's constraints drift
    when links that carry them move. Joint damping is switched off, and all links get one mass and inertia, for good:
    they do not affect the poses of the links, and the solver converges late where they differ.
    """
    engine = body.engine
    engine.setTimeStep(STEP)
    for index in body.coordinates.values():
        engine.changeDynamics(body.id, index, jointDamping=0.0)
    _even_out(body)
    observed: dict[str, ObservedClosure] = {}
    notes = ["loops closed by stepbot's point-to-point constraints, 1 ms steps, at most 1 rad/s"]
    regular = tuple(way[:count] for way, count in zip(request.ways, request.regular, strict=False))
    left_out = sum(map(len, request.ways)) - sum(map(len, regular))
    for closures, joints in _coupled(body, request):
        driven = _driven(body, request, closures, joints)
        off, before = _off(driven, request), inf
        for sweeps in _SWEEPS_OF_SLOW if any(len(way) > 1 for way in regular) else ():
            if off <= 1.0 or off > 0.5 * before:  # closed, or as open as it was drawn
                break
            driven = _driven(body, replace(request, ways=regular), closures, joints, slowly=sweeps)
            off, before = _off(driven, request), off
            if left_out and len(notes) == 1:
                notes.append(
                    f"{left_out} of {len(request.closed)} configurations left out: loops are near a singularity"
                )
        observed |= {one.name: one for one in driven}
    return tuple(observed[closure.name] for closure in request.closures), tuple(notes)


def _even_out(body: "Body") -> None:
    """Share the mass of a body among its links, each with a radius of gyration of the mean distance of its joints."""
    engine, count = body.engine, len(body.joints)
    masses = [float(engine.getDynamicsInfo(body.id, index)[0]) for index in range(-1, count)]
    share = max(1e-3, exact_sum(masses)) / count
    size = exact_sum(float(np.linalg.norm(joint[14])) for joint in body.joints) / count or SECOND_POINT
    for index in range(count):
        engine.changeDynamics(body.id, index, mass=share, localInertiaDiagonal=[share * size * size] * 3)


def _off(closures: Sequence[ObservedClosure], request: Request) -> float:
    """How far loops opened, or their joints moved elsewhere, in tolerances.

    Next to a dead centre, links outrun the solver.
    """
    from . import ENGINE

    wide = ENGINE.several_loops if len(request.closures) > 1 and ENGINE.several_loops else ENGINE.tolerances["closures"]
    gaps = [(closure.residual or 0.0) / wide.absolute for closure in closures]
    angles = [(closure.angle_error or 0.0) / (ENGINE.driven_angle or inf) for closure in closures]
    return max(inf if isnan(one) else one for one in (*gaps, *angles))


def _driven(
    body: "Body", request: Request, closures: Sequence[LoopClosure], joints: set[str], *, slowly: int = 0
) -> list[ObservedClosure]:
    """The gaps of some closures while their joints are driven through the range, and how far these are off.

    ``slowly`` is the number of sweeps where they are driven slowly.
    """
    engine = body.engine
    sweeps = slowly or (SWEEPS if len(closures) > 1 else _SWEEPS_OF_ONE)
    # By default a sweep ends early where velocities are small: loops that move slowly stick, and open.
    threshold = 0.0 if slowly else _THRESHOLD
    engine.setPhysicsEngineParameter(numSolverIterations=sweeps, solverResidualThreshold=threshold)
    held = [_Held(body, closure, closure.name in request.held_by_a_point) for closure in closures]
    # What mimics a driven joint is driven, too: gears give way, and near a dead centre loops multiply that.
    driven = [
        coordinate
        for coordinate in body.coordinates
        if coordinate in joints and _leader(request, coordinate) in request.driven
    ]
    geared = {name: mimic for name, mimic in request.mimics.items() if name in joints and name not in driven}
    of_gears, others = gears(body, geared, strength(body)), body.coordinates.keys() - joints
    following, deviation = joints.difference(driven), 0.0
    for way in (way for way in request.ways if any(q[name] != way[0][name] for q in way for name in driven)):
        body.set(way[0])
        release(body)
        for name in others:
            _hold(body, name)
        for q in way[1:]:
            _drive(body, driven, {name: q[name] for name in joints}, held, slowly=bool(slowly))
            off = (abs(_position(body, name) - q[name]) for name in following)
            deviation = max(deviation, *off, 0.0)
    for one in held:
        one.release()
    for gear in of_gears:
        engine.removeConstraint(gear)
    return [replace(one.observed, residual=one.widest, angle_error=deviation) for one in held]


def _coupled(body: "Body", request: Request) -> list[tuple[list[LoopClosure], set[str]]]:
    """The closures in groups that have joints, or leaders of joints, in common, each with all of these joints."""
    above = {body.links[info[0] + 1]: (body.name(info[0]), body.links[info[16] + 1]) for info in body.joints}

    def way_up(link: str) -> set[str]:
        names = set()
        while link in above:
            name, link = above[link]
            names.add(name)
        return names & body.coordinates.keys()

    groups: list[tuple[list[LoopClosure], set[str]]] = []
    for closure in request.closures:
        closures, joints = [closure], {_leader(request, one) for one in way_up(closure.link_a) ^ way_up(closure.link_b)}
        for group in [group for group in groups if group[1] & joints]:
            groups.remove(group)
            closures, joints = [*group[0], *closures], joints | group[1]
        groups.append((closures, joints))
    return [
        (closures, {coordinate for coordinate in body.coordinates if _leader(request, coordinate) in joints})
        for closures, joints in groups
    ]


def _leader(request: Request, name: str) -> str:
    """The joint that a joint follows by mimics, or itself."""
    while name in request.mimics:
        name = request.mimics[name].joint
    return name


class _Held:
    """A closure as constraints, as programs add them to a body."""

    def __init__(self, body: "Body", closure: LoopClosure, by_a_point: bool) -> None:
        self.observed = ObservedClosure(closure.name, closure.kind.value, closure.link_a, closure.link_b)
        self.widest = 0.0
        self._body, self._closure = body, closure
        self._ends = []
        """Indices of both links, and the frame of the closure in their inertial frames."""
        for link, X_LF in ((closure.link_a, closure.X_AF), (closure.link_b, closure.X_BF)):
            index = body.links.index(link) - 1
            self._ends.append((index, body.X_LI[index + 1].inverse() @ X_LF))
        self._constraints = add_constraints(body.id, [one.document for one in constraints_of(closure, by_a_point)])
        for constraint in self._constraints:
            body.engine.changeConstraint(constraint, maxForce=strength(body))

    def release(self) -> None:
        """Remove the constraints."""
        for constraint in self._constraints:
            self._body.engine.removeConstraint(constraint)

    def measure(self) -> None:
        """Keep the gap if it is the widest so far."""
        engine, ends = self._body.engine, []
        for index, X_IF in self._ends:
            if index < 0:
                frame = engine.getBasePositionAndOrientation(self._body.id)
            else:
                frame = engine.getLinkState(self._body.id, index, computeForwardKinematics=1)[:2]
            ends.append(engine.multiplyTransforms(*frame, X_IF.position, (0.0, 0.0, 0.0, 1.0))[0])
        gap = dist(*ends)
        if self._closure.kind is JointKind.PRISMATIC:  # it is free along its axis
            (a, X_IF), _ = self._ends
            axis_W = (self._body.X_WI(a) @ X_IF).turn(self._closure.axis)
            gap = float(np.linalg.norm(np.cross(axis_W, np.subtract(*ends))))
        self.widest = max(self.widest, gap)


def _drive(
    body: "Body", driven: Sequence[str], goal: Mapping[str, float], held: Sequence[_Held], *, slowly: bool
) -> None:
    """Move the driven joints to ``goal`` and measure the gaps on the way; no joint exceeds its speed on average.

    Next to a dead centre, the others turn much faster than the driven ones, and gaps grow with the square of a speed:
    slowly, none does so in any step.
    """
    engine, force = body.engine, strength(body)
    start = {name: _position(body, name) for name in goal}
    fastest = {name: _speed(body, name) * STEP for name in goal}
    most = 1.0 / max(1, *(ceil(abs(goal[name] - at) / fastest[name]) for name, at in start.items()))
    share, gone, before = most, 0.0, start
    while gone < 1.0:
        gone = 1.0 if gone + share > 1.0 - _ROUNDING else gone + share
        for name in driven:
            planned = start[name] + gone * (goal[name] - start[name])
            engine.setJointMotorControl2(
                body.id,
                body.coordinates[name],
                engine.VELOCITY_CONTROL,
                targetVelocity=(planned - _position(body, name)) / STEP,
                force=force,
            )
        engine.stepSimulation()
        for one in held:
            one.measure()
        if slowly:
            after = {name: _position(body, name) for name in goal}
            excess = max(abs(after[name] - at) / fastest[name] for name, at in before.items())
            share, before = min(most, max(share / max(excess, 0.5), most / _SLOWEST)), after


def _hold(body: "Body", name: str) -> None:
    """Keep a joint where it is."""
    index, engine = body.coordinates[name], body.engine
    engine.setJointMotorControl2(body.id, index, engine.VELOCITY_CONTROL, targetVelocity=0.0, force=strength(body))


def _position(body: "Body", name: str) -> float:
    return float(body.engine.getJointState(body.id, body.coordinates[name])[0])


def _speed(body: "Body", name: str) -> float:
    prismatic = body.joints[body.coordinates[name]][2] == body.engine.JOINT_PRISMATIC
    return SLIDING_SPEED if prismatic else SPEED
