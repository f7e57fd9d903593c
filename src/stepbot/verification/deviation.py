"""Collects deviations and keeps the worst."""

from collections.abc import Iterable, Mapping
from math import inf, isfinite, isnan

from msgspec import Struct, field

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
    Quantity.INERTIA: Tolerance(relative=1e-9, of_whole=1e-15),
    Quantity.GRAVITY_SETTINGS: Tolerance(absolute=1e-9),
    Quantity.POSES: Tolerance(absolute=1e-9),
    Quantity.MASS_MATRIX: Tolerance(relative=1e-9, of_whole=1e-15),
    Quantity.GRAVITY: Tolerance(relative=1e-9),
    Quantity.INVERSE_DYNAMICS: Tolerance(relative=1e-9),
    Quantity.CLOSURES: Tolerance(absolute=1e-9),
    Quantity.MESHES: Tolerance(absolute=1e-6, relative=2**-23),  # of buildings, by single precision
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


class Deviation(Struct, frozen=True):
    """Difference of two numbers."""

    amount: float
    """In ``unit``."""
    allowed: float
    """In ``unit``."""
    unit: str
    """Empty for a count of differences."""
    where: str
    """Link, joint, configuration."""
    values: tuple[float, float] | None = None
    """The expected number and the observed one, in ``unit``; None for other comparisons."""
    expected: str = ""
    """What was expected in place of what ``where`` ends with; empty if it states all."""

    @property
    def ratio(self) -> float:
        """Deviation as a multiple of the tolerance."""
        if self.amount == 0.0:
            return 0.0
        return self.amount / self.allowed if self.allowed > 0.0 else inf

    @property
    def passed(self) -> bool:
        """Whether it is within tolerance; NaN never is."""
        return self.amount <= self.allowed

    def __str__(self) -> str:
        if self.unit:
            return f"{self.where}: {self.amount:.3g} {self.unit} off, {self.allowed:.3g} allowed"
        return f"{self.where}, {self.expected} expected" if self.expected else self.where


class Deviations(Struct):
    """All deviations of one quantity."""

    tolerance: Tolerance
    deviations: list[Deviation] = field(default_factory=list)
    unreported: list[str] = field(default_factory=list)
    """Values of the quantity that the engine does not report."""

    def near(self, observed: float, expected: float, where: str, unit: str) -> None:
        """Compare two numbers, relative to the expected one; equal infinities are equal."""
        amount = 0.0 if observed == expected else abs(observed - expected)
        scale = abs(expected) if isfinite(expected) else 0.0
        self.off(amount, where, unit, scale, values=(float(expected), float(observed)))

    def off(
        self,
        amount: float,
        where: str,
        unit: str,
        scale: float = 0.0,
        tolerance: Tolerance | None = None,
        whole: float = 0.0,
        values: tuple[float, float] | None = None,
    ) -> None:
        """Add a deviation that was computed elsewhere."""
        amount = inf if isnan(amount) else float(amount)
        allowed = (tolerance or self.tolerance).allowed(scale, whole)
        self.deviations.append(Deviation(amount, allowed, unit, where, values))

    def equal(self, same: bool, where: str, *, expected: str = "") -> None:
        """Add the result of a comparison without a number.

        Args:
            same: Whether there is no difference.
            where: Describes a difference, and ends with what was found where something else is ``expected``.
            expected: What takes the place of that.
        """
        self.deviations.append(Deviation(0.0 if same else 1.0, 0.0, "", where, expected=expected))

    @property
    def worst(self) -> Deviation | None:
        """The deviation nearest to, or farthest beyond, its tolerance; None if nothing was compared."""
        return max(self.deviations, key=lambda deviation: deviation.ratio, default=None)

    @property
    def failures(self) -> list[Deviation]:
        """Deviations beyond tolerance, worst first."""
        failed = [deviation for deviation in self.deviations if not deviation.passed]
        return sorted(failed, key=lambda deviation: -deviation.ratio)
