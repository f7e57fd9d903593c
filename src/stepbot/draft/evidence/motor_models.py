"""Which motors of the catalogue a motor of an assembly may be: by its names, and by its box."""

from functools import cache

import numpy as np

from stepbot.assemble.motor_parts import extents, is_like, millimetres
from stepbot.draft.contacts.roles import spoken_names
from stepbot.draft.draft import Models
from stepbot.geometry.spatial import Array
from stepbot.sidecar.motors import body_size, catalogue_motor, catalogue_names, motors_named_in
from stepbot.step.assembly import Assembly

_EXACT = 7e-4
"""Difference [m] of edges up to which a box alone indicates a motor: two drawings of one."""


def models(assembly: Assembly, path: str) -> Models | None:
    """The motors that the component at a path may be; None if neither its name nor its box is one's."""
    index = assembly.index_of.get(path, 0)
    edges = extents(assembly, index)
    box = f"its box is {millimetres(edges)}" if len(edges) else "it has no box"
    for i in assembly.subtree(index) if index else ():
        for text in spoken_names(assembly.components[i]):
            named = motors_named_in(text)
            if named:
                return _named(named, text, edges, box)
    alike = tuple(name for name, size in _sizes() if len(edges) and np.all(np.abs(edges - size) < _EXACT))
    return Models(alike, "", f"by size alone: {box}") if alike else None


def _named(named: tuple[str, ...], text: str, edges: Array, box: str) -> Models:
    """Those of the named motors whose boxes fit, or all of them if none does."""
    sizes = {name: body_size(catalogue_motor(name)) for name in named}
    fit = tuple(name for name, size in sizes.items() if not size or (len(edges) and is_like(edges, np.array(size))))
    known = [size for name, size in sizes.items() if size and name in fit]
    verdict = f", which fits {millimetres(known[0])}" if known else ", unlike the catalogue's" if not fit else ""
    kept = fit or named
    shared = catalogue_motor(kept[0]).family if len(kept) > 1 else ()
    return Models(kept, shared[0] if shared else "", f"named '{text}'; {box}{verdict}")


@cache
def _sizes() -> tuple[tuple[str, Array], ...]:
    """The boxes in the catalogue, edges in order."""
    sizes = ((name, body_size(catalogue_motor(name))) for name in catalogue_names())
    return tuple((name, np.array(size)) for name, size in sizes if size)
