"""A robot with a sensor of every kind."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests.devices import equipped


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(equipped(), FORMATS["usd"], found)
