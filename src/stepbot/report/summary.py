"""What a command prints about a conversion, as texts whose lines the width of the screen decides.

The texts of a conversion are cached with it, and an unchanged one is shown without the results that they describe.
"""

from typing import NamedTuple


class Summary(NamedTuple):
    """What the default output prints about a conversion, except its files and diagnostics."""

    robot: str
    """``four_bar: 4 links, 4 joints (1 closes a loop), 1 degree of freedom, 3.13 kg``."""
    proof: tuple[str, ...]
    """Lines: which formats are proven by which engines, and what is not."""
    weak: str
    """Number and names of the joints on weak evidence; empty without any."""
