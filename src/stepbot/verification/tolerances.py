"""Tolerances of the comparison.

A deviation passes if it is at most ``absolute + relative * scale + of_whole * whole``, where the scale is the size of
the compared quantity: the mass, the largest entry of a matrix, the diagonal of a box.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from stepbot.engines.observation import Quantity


@dataclass(frozen=True)
class Tolerance:
    """The tolerance of a quantity."""

    absolute: float = 0.0
    relative: float = 0.0
    of_whole: float = 0.0
    """For a small part of something large, the rounding of the latter."""

    def allowed(self, scale: float, whole: float = 0.0) -> float:
        """Largest deviation that passes."""
        return self.absolute + self.relative * scale + self.of_whole * whole


EQUAL = Tolerance()

TOLERANCES: Mapping[Quantity, Tolerance] = {
    Quantity.LOAD: EQUAL,
    Quantity.LINKS: EQUAL,
    Quantity.JOINTS: EQUAL,
    Quantity.AXES: Tolerance(absolute=1e-9),
    Quantity.LIMITS: Tolerance(absolute=1e-9, relative=1e-9),
    Quantity.DYNAMICS: Tolerance(absolute=1e-9, relative=1e-9),
    Quantity.MIMIC: Tolerance(absolute=1e-9, relative=1e-9),
    Quantity.MASS: Tolerance(relative=1e-9),
    Quantity.COM: Tolerance(relative=1e-9),
    Quantity.INERTIA: Tolerance(relative=1e-9),
    Quantity.GRAVITY_SETTINGS: Tolerance(absolute=1e-9),
    Quantity.POSES: Tolerance(absolute=1e-9),
    Quantity.MASS_MATRIX: Tolerance(relative=1e-9),
    Quantity.GRAVITY: Tolerance(relative=1e-9),
    Quantity.INVERSE_DYNAMICS: Tolerance(relative=1e-9),
    Quantity.CLOSURES: Tolerance(absolute=1e-9),
    Quantity.MESHES: Tolerance(absolute=1e-6),
    Quantity.SHAPES: EQUAL,
    Quantity.CONTACTS: EQUAL,
    Quantity.FRAMES: Tolerance(absolute=1e-9),
    Quantity.ACTUATORS: Tolerance(absolute=1e-9, relative=1e-9),
    Quantity.SENSORS: Tolerance(absolute=1e-9, relative=1e-9),
    Quantity.INITIAL: Tolerance(absolute=1e-9),
    Quantity.TEXT: Tolerance(relative=1e-9),
    Quantity.SELF_COLLISION: EQUAL,
    Quantity.SIMULATION: EQUAL,
    Quantity.WARNINGS: EQUAL,
}

ENGINE_TOLERANCES: Mapping[tuple[str, Quantity], Tolerance] = {
    # PyBullet converts every inertia to principal axes, by an iteration that stops at products below 1e-6 of the trace,
    # which is up to three times the largest entry.
    ("pybullet", Quantity.INERTIA): Tolerance(relative=3e-6),
    ("pybullet", Quantity.POSES): Tolerance(absolute=1e-6),
    ("pybullet", Quantity.MASS_MATRIX): Tolerance(relative=1e-6),
    ("pybullet", Quantity.GRAVITY): Tolerance(relative=1e-6),
    ("pybullet", Quantity.INVERSE_DYNAMICS): Tolerance(relative=1e-6),
    # It closes loops by constraints of a simulation with steps of 1 ms, with gaps of 2e-6 of the lengths of the links.
    ("pybullet", Quantity.CLOSURES): Tolerance(absolute=1e-5, relative=5e-6),
    # UsdPhysics stores numbers in single precision, accurate to 6e-8 of each; a pose is a product of several.
    ("usd", Quantity.AXES): Tolerance(absolute=1e-6),
    ("usd", Quantity.LIMITS): Tolerance(absolute=1e-9, relative=2e-7),
    ("usd", Quantity.DYNAMICS): Tolerance(absolute=1e-9, relative=2e-7),
    ("usd", Quantity.MIMIC): Tolerance(absolute=1e-9, relative=2e-7),
    ("usd", Quantity.MASS): Tolerance(relative=1e-7),
    ("usd", Quantity.COM): Tolerance(relative=2e-7),
    ("usd", Quantity.INERTIA): Tolerance(relative=5e-7),
    ("usd", Quantity.POSES): Tolerance(absolute=1e-6),
    ("usd", Quantity.MASS_MATRIX): Tolerance(relative=1e-6),
    ("usd", Quantity.GRAVITY): Tolerance(relative=1e-6),
    ("usd", Quantity.INVERSE_DYNAMICS): Tolerance(relative=1e-6),
    ("usd", Quantity.CLOSURES): Tolerance(absolute=1e-6),
    ("usd", Quantity.ACTUATORS): Tolerance(absolute=1e-9, relative=2e-7),
    ("usd", Quantity.INITIAL): Tolerance(absolute=1e-6),
    # Newton computes in single precision throughout: kinematics, and inertias turned from their principal axes.
    ("newton", Quantity.AXES): Tolerance(absolute=1e-6),
    ("newton", Quantity.LIMITS): Tolerance(absolute=1e-9, relative=2e-7),
    ("newton", Quantity.DYNAMICS): Tolerance(absolute=1e-9, relative=2e-7),
    ("newton", Quantity.MIMIC): Tolerance(absolute=1e-9, relative=2e-7),
    ("newton", Quantity.MASS): Tolerance(relative=1e-7),
    ("newton", Quantity.COM): Tolerance(relative=2e-7),
    ("newton", Quantity.INERTIA): Tolerance(relative=5e-6),
    ("newton", Quantity.POSES): Tolerance(absolute=5e-6),
    # It adds inertias about the root in single precision, with four roundings of 6e-8: a light wheel far from it keeps
    # fewer digits.
    ("newton", Quantity.MASS_MATRIX): Tolerance(relative=2e-5, of_whole=2.4e-7),
    ("newton", Quantity.CLOSURES): Tolerance(absolute=1e-6),
    ("newton", Quantity.ACTUATORS): Tolerance(absolute=1e-9, relative=2e-7),
    # It computes hulls of collision meshes on a grid of 1/10216 of their extent.
    ("pybullet", Quantity.MESHES): Tolerance(absolute=1e-6, relative=2e-4),
}

COLOR = Tolerance(absolute=1e-6)
"""Engines store colours in single precision."""

SEVERAL_LOOPS: Mapping[str, Tolerance] = {
    # Its solver handles the constraints of a step one by one: gaps of 1.3e-4 m remain in a Stewart platform.
    "pybullet": Tolerance(absolute=3e-4),
}
"""Gap of coupled loops over their range, for engines that do not solve them simultaneously."""

DRIVEN_ANGLE = {"pybullet": 1e-3}
"""Deviation [rad] or [m] of following joints in an engine's simulation; for others, that of the closures."""


def tolerance(engines: Iterable[str], quantity: Quantity) -> Tolerance:
    """Tolerance between engines: the loosest of theirs, else the default of the quantity."""
    own = [ENGINE_TOLERANCES[engine, quantity] for engine in engines if (engine, quantity) in ENGINE_TOLERANCES]
    own = own or [TOLERANCES[quantity]]
    return Tolerance(
        max(one.absolute for one in own), max(one.relative for one in own), max(one.of_whole for one in own)
    )
