"""What a command prints about a conversion, as texts whose lines the width of the screen decides.

The texts of a conversion are cached with it, and an unchanged one is shown without the results that they describe.
"""

from typing import NamedTuple


class JointText(NamedTuple):
    """The texts of one joint in the joint table."""

    head: str
    """Name, kind and links, after a mark."""
    place: str
    """Its axis, which follows the head where one line holds both; empty if ``details`` starts with it."""
    details: tuple[str, ...]
    """Each starts a line of its own."""


class JointTable(NamedTuple):
    """The joint table in texts."""

    title: str
    joints: tuple[JointText, ...]
    weak: str
    """Number and names of the joints on weak evidence; empty if there are none."""


class Summary(NamedTuple):
    """What the default output prints about a conversion, except its files and diagnostics."""

    robot: str
    """``four_bar: 4 links, 4 joints (1 closes a loop), 1 degree of freedom, 3.13 kg``."""
    proof: tuple[str, ...]
    """Lines: which formats are proven by which engines, and what is not."""
    doubtful: JointTable | None
    """The joints on weak evidence; None without any."""
