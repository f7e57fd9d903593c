"""Simulation in Drake: passive motion, and loops closed by its constraint solver."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stepbot.robot.closures import closure_gap

from ..observation import ObservedClosure, Request
from .plant import Built, build

NUDGES = (0.02, -0.02, 0.002, -0.002)
"""Offsets [rad], [m] of the following joints from the reference's solution, from which Drake's solver starts."""
BACK = 1e-6
"""Distance [rad], [m] from the reference's solution at which no further offset is tried."""
SETTLED = 1e-12
"""Motion [rad], [m] per step below which the plant is at rest."""
MOST_STEPS = 400


def simulate(built: Built, request: Request) -> bool:
    """Simulate from the initial pose, without actuation; returns whether all values stayed finite."""
    from pydrake.systems.analysis import Simulator

    simulator = Simulator(built.diagram)
    context = built.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    built = replace(built, context=context)
    built.place(request.initial)
    try:
        simulator.AdvanceTo(request.simulate)
    except RuntimeError:  # the solver throws on NaN
        return False
    return bool(np.isfinite(built.plant.GetPositionsAndVelocities(context)).all())


def closures_in(_built: Built, request: Request) -> tuple[ObservedClosure, ...]:
    """How well Drake's constraints close each loop of the reference.

    Drake starts near each closed configuration, with the driven joints locked and without gravity, and its solver
    closes the loops step by step. Next to a dead centre another configuration that closes them may be as near, so there
    it starts from several sides, and nearer. The residual is the remaining gap between the reference's frames.
    """
    plain = build(request, (0.0, 0.0, 0.0), shapes=False)
    residual = {closure.name: 0.0 for closure in request.closures}
    deviation = 0.0
    for q in (q for way in request.ways for q in way):
        deviation = max(deviation, _back_at(plain, request, q))
        X_W = {body.name(): plain.X_WB(body) for body in plain.bodies}
        for closure in request.closures:
            gap = closure_gap(closure, X_W[closure.link_a], X_W[closure.link_b])[0]
            residual[closure.name] = max(residual[closure.name], gap)
    return tuple(
        ObservedClosure(
            closure.name,
            closure.kind.value,
            closure.link_a,
            closure.link_b,
            residual=residual[closure.name],
            angle_error=deviation,
        )
        for closure in request.closures
    )


def _back_at(built: Built, request: Request, q: Mapping[str, float]) -> float:
    """The least distance [rad] or [m] from a solution at which Drake's solver comes to rest next to it."""
    distances: list[float] = []
    for nudge in NUDGES:
        found = _closed(built, request, q, nudge)
        distances.append(max((abs(found[name] - q[name]) for name in found if name not in request.driven), default=0.0))
        if distances[-1] <= BACK:
            break
    return min(distances)


def _closed(built: Built, request: Request, q: Mapping[str, float], nudge: float) -> dict[str, float]:
    """The coordinates at which Drake's solver comes to rest."""
    plant, context = built.plant, built.context
    # Drake reads no mimics of SDFormat: the followers of a driven joint are locked with it.
    held = {*request.driven, *(name for name, mimic in request.mimics.items() if mimic.joint in request.driven)}
    built.place({name: q.get(name, 0.0) + (0.0 if name in held else nudge) for name in built.coordinates.names})
    for joint in built.joints:
        if joint.name() in held:
            joint.Lock(context)
        elif joint.is_locked(context):
            joint.Unlock(context)
    before = np.array(plant.GetPositions(context))
    for _ in range(MOST_STEPS):
        # Every step starts at rest: only the remaining gap moves the links.
        plant.SetVelocities(context, np.zeros(plant.num_velocities()))
        built.diagram.ExecuteForcedEvents(built.whole)
        after = np.array(plant.GetPositions(context))
        moved, before = float(np.abs(after - before).max()), after
        if moved < SETTLED:
            break
    return built.coordinates.read(before)
