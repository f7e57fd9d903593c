"""Tolerances of the comparison, where an engine declares none of its own.

A deviation passes if it is at most ``absolute + relative * scale + of_whole * whole``, where the scale is the size of
the compared quantity: the mass, the largest entry of a matrix, the diagonal of a box.
"""

from collections.abc import Iterable, Mapping

from stepbot.engines import engine_named
from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Quantity

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

COLOR = Tolerance(absolute=1e-6)
"""Engines store colours in single precision."""

SURFACE = Tolerance(relative=1e-6)
"""USD stores contact properties in single precision."""


def tolerance(engines: Iterable[str], quantity: Quantity) -> Tolerance:
    """Tolerance between engines: the loosest of theirs, else the default of the quantity."""
    known = (engine_named(name) for name in engines)
    own = [one.tolerances[quantity.value] for one in known if one is not None and quantity.value in one.tolerances]
    own = own or [TOLERANCES[quantity]]
    return Tolerance(
        max(one.absolute for one in own), max(one.relative for one in own), max(one.of_whole for one in own)
    )
