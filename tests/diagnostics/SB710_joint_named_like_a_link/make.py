"""A robot that another program made: the sidecar's own checks find this before."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests import robots


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(robots.odd_names(), FORMATS["sdf"], found)
