"""A robot built by another program, since the checks of the sidecar report this first."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests import robots


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(robots.odd_names(), FORMATS["sdf"], found)
