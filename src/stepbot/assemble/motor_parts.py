"""Whether the part of a motor can be that motor: its box and its mass against those of the catalogue."""

from collections.abc import Iterable, Mapping

import numpy as np

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array
from stepbot.robot.model import ComponentMass
from stepbot.step.assembly import Assembly

from .binder import Binder
from .material_assignment import PLACEHOLDER

_SHARE, _LENGTH = 0.2, 4e-3
"""Differences of an edge: as a share, and [m], such as a horn that one drawing includes; both must be exceeded."""
_HEAVIER = 0.25
"""Difference of masses, as a share, that no variant of a motor explains."""
_ASSUMED = ("", "defaults", PLACEHOLDER)
"""Sources of a density that is no part's own."""


def report_unlike_motors(binder: Binder, weighed: Mapping[int, ComponentMass]) -> None:
    """Report SB524, parts that differ from their motor in size or mass."""
    for name, motor in binder.sidecar.motors.items():
        keys = ("actuators", name, "part")
        named = binder.paths.find_one(motor.part).topmost if motor.part else ()
        if not named:  # reported where its mass was given
            continue
        index = named[0]
        differences = []
        edges = extents(binder.assembly, index)
        if motor.size and len(edges) and not is_like(edges, np.array(motor.size)):
            differences.append(f"its box is {millimetres(edges)}, that of '{motor.name}' {millimetres(motor.size)}")
        mass = motor.figure("mass")
        parts = [weighed[i] for i in binder.assembly.subtree(index) if i in weighed]
        if mass is not None and parts and all(part.mass is not None and part.origin not in _ASSUMED for part in parts):
            own = exact_sum(part.mass or 0.0 for part in parts)
            if abs(own - mass.value) > _HEAVIER * mass.value:
                differences.append(f"it weighs {1e3 * own:.3g} g, '{motor.name}' {1e3 * mass.value:.3g} g")
        if differences:
            message = f"'{binder.path(index)}' is not like its motor: {'; '.join(differences)}"
            help = ("check the name of the motor and the path of `part`; a catalogue may leave out a horn or a cable",)
            binder.report("SB524", keys, message, help=help)


def extents(assembly: Assembly, index: int) -> Array:
    """Edges (3,) [m] of the box of a component and everything below it, along its own axes, the shortest first."""
    X_CW = assembly.components[index].X_WC.inverse()
    corners = [
        body.mesh.moved(X_CW @ component.X_WC).bounds
        for i in assembly.subtree(index)
        if (component := assembly.components[i]).body >= 0
        and len((body := assembly.bodies[component.body]).mesh.vertices)
    ]
    if not corners:
        return np.zeros(0)
    low = np.min([corner[0] for corner in corners], axis=0)
    return np.sort(np.max([corner[1] for corner in corners], axis=0) - low)


def is_like(edges: Array, size: Array) -> bool:
    """Whether a box may be that of a motor; edges (3,) [m] of both, the shortest first."""
    apart = np.abs(edges - size)
    return not np.any((apart > _LENGTH) & (apart > _SHARE * size))


def millimetres(edges: Iterable[float]) -> str:
    """Edges [m] as ``24.8 x 39.6 x 45.4 mm``."""
    return " x ".join(f"{1e3 * edge:.3g}" for edge in edges) + " mm"
