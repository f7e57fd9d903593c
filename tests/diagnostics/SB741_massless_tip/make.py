"""A finger whose tip has no mass."""

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from tests.robots import tree


def find(found: Diagnostics) -> None:
    """Ask the library."""
    lower(tree(), FORMATS["usd"], found)
