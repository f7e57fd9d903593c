"""A spindle that moves along its axis as it turns."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests.mechanisms import screw


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(screw(), FORMATS["usd"], found)
