"""Pairs of links whose contacts a MuJoCo model excludes.

https://mujoco.readthedocs.io/en/stable/computation/index.html#collision-detection, "Selection"
"""

from itertools import combinations
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .compiled import Compiled


def excluded_pairs(compiled: "Compiled") -> tuple[tuple[str, str], ...]:
    """Pairs of links with collision geometry whose contacts MuJoCo excludes; sorted."""
    engine, model = compiled.engine, compiled.model
    excluded = {divmod(int(signature), 1 << 16) for signature in model.exclude_signature}
    follows_tree = not int(model.opt.disableflags) & int(engine.mjtDisableBit.mjDSBL_FILTERPARENT)

    def left_out(a: int, b: int) -> bool:
        if (a, b) in excluded or (b, a) in excluded:
            return True
        weld_a, weld_b = (int(model.body_weldid[body]) for body in (a, b))
        if weld_a == weld_b:
            return True
        above_a, above_b = (int(model.body_weldid[model.body_parentid[weld]]) for weld in (weld_a, weld_b))
        # Bodies fixed to the world count as part of it, and any moving body may touch the world.
        return follows_tree and 0 not in (weld_a, weld_b) and (above_a == weld_b or above_b == weld_a)

    bodies = [body for body in compiled.bodies if any(_masks(compiled, body))]
    pairs = [
        (compiled.name("BODY", a), compiled.name("BODY", b))
        for a, b in combinations(bodies, 2)
        if left_out(a, b) or not _may_touch(compiled, a, b)
    ]
    return tuple(sorted((min(pair), max(pair)) for pair in pairs))


def _masks(compiled: "Compiled", body: int) -> tuple[int, int]:
    """The contact type and affinity bits of a body's geoms."""
    model = compiled.model
    types = affinities = 0
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        types |= int(model.geom_contype[g])
        affinities |= int(model.geom_conaffinity[g])
    return types, affinities


def _may_touch(compiled: "Compiled", a: int, b: int) -> bool:
    (types_a, with_a), (types_b, with_b) = _masks(compiled, a), _masks(compiled, b)
    return bool(types_a & with_b or types_b & with_a)
