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
    """The joints on weak evidence; empty if there are none."""


class Proof(NamedTuple):
    """The verification results of each file in texts."""

    rows: tuple[tuple[str, str, str, str, str], ...]
    """Format, file, status, engines and worst deviation of each file."""
    remarks: tuple[str, ...]
    """Independent joints of a robot with loops, and the number of checks."""


class Summary(NamedTuple):
    """All that is printed about a conversion, except its files and diagnostics."""

    joint_table: JointTable | None
    """None without joints."""
    masses: str
    """The masses of the links; empty without links."""
    collisions: str
    """How well collision shapes match the solids; empty without collision shapes."""
    proof: Proof | None
    """None without checks."""
