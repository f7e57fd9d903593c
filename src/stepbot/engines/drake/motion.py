"""Drake in motion: a second of falling, and loops that its constraint solver closes."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stepbot.robot.closures import closure_gap

from ..observation import ObservedClosure, Request
from .plant import Built, build

NUDGE = 0.02
"""How far [rad], [m] following joints are put off the reference's solution before Drake's solver leads them back."""
SETTLED = 1e-12
"""Motion [rad], [m] in a step below which nothing moves any more."""
MOST_STEPS = 400


def simulate(built: Built, request: Request) -> bool:
    """Let the plant move from its initial pose, without actuation; whether everything stayed finite."""
    from pydrake.systems.analysis import Simulator

    simulator = Simulator(built.diagram)
    context = built.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    built = replace(built, context=context)
    built.place(request.initial)
    try:
        simulator.AdvanceTo(request.simulate)
    except RuntimeError:  # the solver gives up on numbers that are none
        return False
    return bool(np.isfinite(built.plant.GetPositionsAndVelocities(context)).all())


def closures_in(_built: Built, request: Request) -> tuple[ObservedClosure, ...]:
    """How well Drake's constraints close each loop of the reference.

    Drake starts beside each closed configuration, with the driven joints locked in place and without weight, and its
    solver draws the loops together step by step. The residual is how far the reference's frames are apart then.
    """
    plain = build(request, (0.0, 0.0, 0.0), shapes=False)
    residual = {closure.name: 0.0 for closure in request.closures}
    deviation = 0.0
    for q in (q for way in request.ways for q in way):
        found = _closed(plain, request, q)
        deviation = max([deviation, *(abs(found[name] - q[name]) for name in found if name not in request.driven)])
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


def _closed(built: Built, request: Request, q: Mapping[str, float]) -> dict[str, float]:
    """The coordinates where Drake's solver comes to rest."""
    plant, context = built.plant, built.context
    # Drake reads no mimics of SDFormat: what follows a driven joint is held with it.
    held = {*request.driven, *(name for name, mimic in request.mimics.items() if mimic.joint in request.driven)}
    built.place({name: q.get(name, 0.0) + (0.0 if name in held else NUDGE) for name in built.coordinates.names})
    for joint in built.joints:
        if joint.name() in held:
            joint.Lock(context)
        elif joint.is_locked(context):
            joint.Unlock(context)
    before = np.array(plant.GetPositions(context))
    for _ in range(MOST_STEPS):
        # Every step starts at rest: what is left of the gap moves the links, and nothing else does.
        plant.SetVelocities(context, np.zeros(plant.num_velocities()))
        built.diagram.ExecuteForcedEvents(built.whole)
        after = np.array(plant.GetPositions(context))
        moved, before = float(np.abs(after - before).max()), after
        if moved < SETTLED:
            break
    return built.coordinates.read(before)
