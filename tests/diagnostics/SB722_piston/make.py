"""A loop closed by a piston."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests import closed_mechanisms


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(closed_mechanisms.sliding_closure(), FORMATS["mjcf"], found)
