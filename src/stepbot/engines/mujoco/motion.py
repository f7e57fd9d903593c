"""Simulation in MuJoCo: passive motion, and loops closed by Newton's method on the equality rows."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY, Array, Pose, vector3
from stepbot.robot.closures import RANK_TOLERANCE, closure_gap
from stepbot.robot.mesh_names import SCOPE

from ..observation import ObservedClosure, Request
from .coordinates import Gimbals

if TYPE_CHECKING:
    from .compiled import Compiled

NUDGE = 1e-4
"""Offset [rad], [m] of the following joints from the reference's solution, from which MuJoCo's rows correct them."""


def simulate(compiled: "Compiled", request: Request) -> tuple[bool, tuple[str, ...]]:
    """Simulate from the initial pose, without actuators.

    Three hinges that represent a ball joint lose a degree of freedom when the first and the last axis are parallel:
    there the mass matrix is singular for any robot. The motion is reversed before that point, and continues.

    Returns:
        Whether all values stayed finite, and notes on reversals.
    """
    engine, model = compiled.engine, compiled.model
    flags, step = int(model.opt.disableflags), float(model.opt.timestep)
    model.opt.disableflags = flags | int(engine.mjtDisableBit.mjDSBL_ACTUATION)
    if request.format == "urdf":
        model.opt.timestep = min(step, request.timestep)
    try:
        data = compiled.data(request.initial)
        gimbals = Gimbals(compiled, data)
        for _ in range(round(request.simulate / float(model.opt.timestep))):
            engine.mj_step(model, data)
            gimbals.turn_back(data)
    finally:
        model.opt.disableflags, model.opt.timestep = flags, step
    bad = any(warning.number for warning in data.warning)
    return bool(np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all() and not bad), gimbals.notes


def initial_penetrations(compiled: "Compiled", request: Request) -> tuple[tuple[str, str], ...]:
    """The links whose overlap in the initial pose alone makes the simulation diverge; empty if it is not that."""
    model, data = compiled.model, compiled.data(request.initial)
    compiled.engine.mj_collision(model, data)
    deep = [(int(one.geom1), int(one.geom2)) for one in data.contact if one.dist < 0.0]
    masks = model.geom_contype.copy(), model.geom_conaffinity.copy()
    geoms = [geom for pair in deep for geom in pair]
    model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
    try:
        finite = bool(deep) and simulate(compiled, request)[0]
    finally:
        model.geom_contype[:], model.geom_conaffinity[:] = masks
    if not finite:
        return ()
    links = [sorted(compiled.name("BODY", int(model.geom_bodyid[geom])) for geom in pair) for pair in deep]
    return tuple(sorted({(a, b) for a, b in links}))


def close_by_newton(compiled: "Compiled", request: Request) -> tuple[ObservedClosure, ...]:
    """The closures in the file, and how well each agrees with the reference's closure of the same name.

    MuJoCo starts near each closed configuration of the reference, with the driven joints in place, and Newton's method
    on its own equality rows solves for the others. The residual is the remaining gap between the reference's frames.
    """
    in_file = {closure.name: closure for closure in _closures_in_file(compiled)}
    wanted = [closure for closure in request.closures if closure.name in in_file]
    residual = {closure.name: 0.0 for closure in wanted}
    deviation = 0.0
    for q in request.closed if wanted else ():
        solved, data = _newton(compiled, request, q)
        deviation = max([deviation, *(abs(solved[name] - q[name]) for name in solved)])
        for closure in wanted:
            X_WA, X_WB = (compiled.X_WB(data, _body(compiled, link)) for link in (closure.link_a, closure.link_b))
            residual[closure.name] = max(residual[closure.name], closure_gap(closure, X_WA, X_WB)[0])
    return tuple(
        replace(closure, residual=residual[closure.name], angle_error=deviation)
        if closure.name in residual
        else closure
        for closure in in_file.values()
    )


_NO_POSES: tuple[Pose | None, Pose | None] = None, None
AXIS = f"{SCOPE}axis"
"""Suffix of a second constraint, which constrains another point on the axis of the closure of that name."""


def _closures_in_file(compiled: "Compiled") -> Iterator[ObservedClosure]:
    """Active equality constraints between two bodies or sites, by name.

    A closure whose axis is constrained by a second constraint is reported as one.
    """
    in_file = {closure.name: closure for closure in _constraints(compiled)}
    for closure in in_file.values():
        held, on_axis = in_file.get(closure.name.removesuffix(AXIS)), in_file.get(f"{closure.name}{AXIS}")
        if closure.name.endswith(AXIS) and held is not None and _links(held) == _links(closure):
            continue
        if closure.points is not None and on_axis is not None and on_axis.points is not None:
            first, second = (
                vector3(np.subtract(there, here)) for here, there in zip(closure.points, on_axis.points, strict=True)
            )
            closure = replace(closure, axes=(first, second))
        yield closure


def _links(closure: ObservedClosure) -> tuple[str, str]:
    return closure.link_a, closure.link_b


def _constraints(compiled: "Compiled") -> Iterator[ObservedClosure]:
    engine, model = compiled.engine, compiled.model
    words = {engine.mjtEq.mjEQ_CONNECT: "connect", engine.mjtEq.mjEQ_WELD: "weld"}
    for e in range(model.neq):
        word = words.get(engine.mjtEq(model.eq_type[e]))
        if word is None or not model.eq_active0[e]:
            continue
        bodies, points, poses = [int(model.eq_obj1id[e]), int(model.eq_obj2id[e])], None, _NO_POSES
        if engine.mjtObj(model.eq_objtype[e]) == engine.mjtObj.mjOBJ_SITE:
            points = vector3(model.site_pos[bodies[0]]), vector3(model.site_pos[bodies[1]])
            if word == "weld":
                a, b = (Pose.from_quaternion(model.site_quat[s].tolist(), model.site_pos[s]) for s in bodies)
                poses = a, b
            bodies = [int(model.site_bodyid[site]) for site in bodies]
        elif word == "connect":
            points = vector3(model.eq_data[e][:3]), vector3(model.eq_data[e][3:6])
        else:
            poses = Pose.from_quaternion(model.eq_data[e][6:10].tolist(), model.eq_data[e][3:6]), IDENTITY
            points = poses[0].position, poses[1].position
        link_a, link_b = (compiled.name("BODY", body) for body in bodies)
        kind = word if poses is _NO_POSES else "fixed"
        yield ObservedClosure(compiled.name("EQUALITY", e), kind, link_a, link_b, *poses, points=points)


def _newton(compiled: "Compiled", request: Request, q: Mapping[str, float]) -> tuple[dict[str, float], Any]:
    """Joint positions that satisfy the equality rows, and the state there; the driven joints stay at ``q``."""
    engine, model = compiled.engine, compiled.model
    names = compiled.coordinates.names
    following = [i for i, name in enumerate(names) if name not in request.driven]
    solved = {name: q.get(name, 0.0) + (NUDGE if i in following else 0.0) for i, name in enumerate(names)}
    data = compiled.data(solved)
    for _ in range(50):
        residual, J = _equality_rows(compiled, data)
        if not residual.size:
            break
        rates = compiled.coordinates.velocities.rates(solved)[:, following]
        step = -np.linalg.lstsq(J @ rates, residual, rcond=RANK_TOLERANCE)[0]
        for i, change in zip(following, step.tolist(), strict=True):
            solved[names[i]] += change
        compiled.coordinates.place(data.qpos, solved)
        if np.abs(step).max(initial=0.0) < 1e-14:
            break
    engine.mj_kinematics(model, data)
    return {names[i]: solved[names[i]] for i in following}, data


def _equality_rows(compiled: "Compiled", data: Any) -> tuple[Array, Array]:
    """Violation (m,) of the equality constraints and its Jacobian (m, nv), without limits, friction and contact."""
    engine, model = compiled.engine, compiled.model
    flags, jacobian = int(model.opt.disableflags), int(model.opt.jacobian)
    off = engine.mjtDisableBit
    model.opt.disableflags = int(off.mjDSBL_CONTACT) | int(off.mjDSBL_LIMIT) | int(off.mjDSBL_FRICTIONLOSS)
    model.opt.jacobian = int(engine.mjtJacobian.mjJAC_DENSE)
    try:
        engine.mj_fwdPosition(model, data)
        mine = data.efc_type[: data.nefc] == int(engine.mjtConstraint.mjCNSTR_EQUALITY)
        J = np.array(data.efc_J).reshape(-1, model.nv)[: data.nefc][mine]
        return np.array(data.efc_pos[: data.nefc])[mine], J
    finally:
        model.opt.disableflags, model.opt.jacobian = flags, jacobian


def _body(compiled: "Compiled", name: str) -> int:
    return int(compiled.engine.mj_name2id(compiled.model, compiled.engine.mjtObj.mjOBJ_BODY, name))
