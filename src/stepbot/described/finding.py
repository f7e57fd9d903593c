"""What is found while a description becomes a robot; the caller decides where it is reported."""

from msgspec import Struct

from stepbot.engines.observation import Quantity

ASSUMED = "SB874:mass"
ASSUMED_CONTACTS = "SB874:contacts"
LOST = "SB860"
UNSUPPORTED = "SB861"
"""Of what a picture of the robot lacks or shows otherwise, too."""
DEVICE = "SB863"
RENAMED = "SB864"
REARRANGED = "SB864"
TAKEN_AS_FIXED = "SB874:base"
OPEN_LIMIT = "SB874:limit"
CHANGED_INERTIA = "SB866"
MOVED = "SB870"


class Finding(Struct, frozen=True):
    """A difference between a description and its robot."""

    code: str
    text: str
    """``subject: problem``, as the message of a diagnostic."""
    differs: tuple[Quantity, ...] = ()
    """Quantities in which the written files therefore differ from the source."""
    help: tuple[str, ...] = ()
    """Remedies that are closer than those of the code."""
