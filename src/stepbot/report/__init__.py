"""Verification results for people and programs: ``report.json`` and JUnit XML.

May be called by ``verification`` and everything above it; independent of formats and engines.
"""

from typing import NamedTuple


class Summary(NamedTuple):
    """What the default output prints about a conversion, except its files and diagnostics.

    It is cached with the conversion; an unchanged one is shown without the results that these texts describe.
    """

    robot: str
    """``four_bar: 4 links, 4 joints (1 closes a loop), 1 degree of freedom, 3.13 kg``."""
    proof: tuple[str, ...]
    """Lines: which formats are proven by which engines, and what is not."""
    weak: str
    """Number and names of the joints on weak evidence; empty without any."""
