"""What a motor of the catalogue gives its actuator: each figure at the joint, with its source."""

from msgspec import Struct


class MotorFigure(Struct, frozen=True):
    """A number that a motor gives its actuator."""

    quantity: str
    """``effort``, ``velocity``, ``armature``, ``friction``, ``damping``, ``kp``, ``mass`` or ``backlash``; no file has
    the last one."""
    value: float
    """At the joint, after the gear; [SI]. ``kp`` is on the motor's side."""
    unit: str
    source: str


class Motor(Struct, frozen=True):
    """The motor of an actuator."""

    name: str
    """Its name in the catalogue."""
    figures: tuple[MotorFigure, ...] = ()
    """What it gives, in the order of the quantities."""
    doubts: tuple[str, ...] = ()
    """Why these figures may be wrong."""
    unknown: tuple[str, ...] = ()
    """Quantities that no source gives."""
    size: tuple[float, ...] = ()
    """Edges [m] of its box, the shortest first; empty if unknown."""
    part: str = ""
    """Path of its component in the assembly; empty if it is not given."""

    def figure(self, quantity: str) -> MotorFigure | None:
        """What it gives for a quantity; None if nothing."""
        return next((figure for figure in self.figures if figure.quantity == quantity), None)
