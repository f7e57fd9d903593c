"""The doubt about the length unit of a STEP file, before there is a robot."""

from stepbot.diagnostics import Diagnostics, Span
from stepbot.robot.scale import LARGEST, other_units
from stepbot.step.assembly import Assembly


def report_large_assembly(assembly: Assembly, found: Diagnostics) -> None:
    """Report SB420, an assembly of tens of metres: drawn in another unit than declared."""
    box = assembly.bounds(0)
    size = 0.0 if box is None else max(high - low for low, high in zip(*box, strict=True))
    if size > LARGEST:
        message = f"{assembly.source}: size of {size:.3g} m; check its length unit ({assembly.unit})"
        found.add("SB420", message, Span(assembly.source), help=other_units(size, assembly.unit))
