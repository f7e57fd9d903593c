"""The types of joints and closures: a type is one row, and whoever needs to know something about it asks the row."""

from enum import StrEnum
from typing import Self


class JointKind(StrEnum):
    """The type of a joint or closure."""

    # fmt: off
    #              name           has_axis  about    slides  bounded  closes  chain
    FIXED       = "fixed",        False,    "",      False,  False,   True,   ()
    REVOLUTE    = "revolute",     True,     "line",  False,  True,    True,   ("",)
    CONTINUOUS  = "continuous",   True,     "line",  False,  False,   False,  ("",)
    PRISMATIC   = "prismatic",    True,     "",      True,   True,    True,   ("",)
    BALL        = "ball",         False,    "point", False,  False,   True,   ("_yaw", "_pitch", "_roll")
    PLANAR      = "planar",       True,     "",      False,  False,   False,  ("_x", "_y", "_turn")
    SCREW       = "screw",        True,     "line",  True,   False,   False,  ("",)
    UNIVERSAL   = "universal",    True,     "point", False,  False,   False,  ("_1", "_2")
    CYLINDRICAL = "cylindrical",  True,     "line",  True,   False,   False,  ("_slide", "_turn")
    FLOATING    = "floating",     False,    "",      False,  False,   False,  ("_x", "_y", "_z", "_turn_yaw", "_turn_pitch", "_turn_roll")  # noqa: E501
    # fmt: on

    has_axis: bool
    """Whether it has an `axis`: the line or direction of its motion, or a plane's normal."""
    about: str
    """What stays in place while it turns: a ``line``, a ``point``, or nothing."""
    slides: bool
    bounded: bool
    """Whether it needs a lower and an upper limit."""
    closes: bool
    """Whether a closure may be of this type."""
    chain: tuple[str, ...]
    """For each coordinate, what its name adds to the joint's: those of the joints that it unfolds to."""

    def __new__(
        cls,
        name: str,
        has_axis: bool = False,
        about: str = "",
        slides: bool = False,
        bounded: bool = False,
        closes: bool = False,
        chain: tuple[str, ...] = (),
    ) -> Self:
        """One row of the table."""
        kind = str.__new__(cls, name)
        kind._value_ = name
        kind.has_axis, kind.about, kind.slides = has_axis, about, slides
        kind.bounded, kind.closes, kind.chain = bounded, closes, chain
        return kind

    @property
    def coordinates(self) -> int:
        """Degrees of freedom."""
        return len(self.chain)

    @property
    def turns(self) -> bool:
        """Whether it turns about its axis."""
        return self.has_axis and bool(self.about)

    @property
    def is_hinge(self) -> bool:
        """Whether it turns about a line, and nothing else."""
        return self.about == "line" and not self.slides

    @property
    def needs(self) -> str:
        """The key beside its axis without which a joint of this type does not move: "" for none."""
        return {"screw": "pitch", "universal": "axis2"}.get(self.value, "")

    @property
    def is_pair(self) -> bool:
        """Whether it is a hinge or a slide: what every format and engine has."""
        return self.is_hinge or (self.slides and not self.about)


def kinds_with(**row: object) -> tuple[JointKind, ...]:
    """The types whose row has these values, in the order of the table."""
    return tuple(kind for kind in JointKind if all(getattr(kind, name) == value for name, value in row.items()))


HINGES = kinds_with(is_hinge=True)
PAIRS = kinds_with(is_pair=True)
"""Hinges and slides."""
