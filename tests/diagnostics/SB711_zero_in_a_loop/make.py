"""A four-bar linkage drawn at a position other than zero."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests import robots


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(robots.four_bar_with_zeros(), FORMATS["sdf"], found)
