"""The motion of the slider-crank in closed form, as joint positions relative to the drawing."""

from math import pi
from typing import Any

from . import dimensions as d


def motion(shaft: float) -> dict[str, float]:
    """Joint positions [rad, m], 0 in the drawing, of the closed loop at a position of the shaft [rad]."""
    now, drawn = d.CRANK_DRAWN + shaft, d.CRANK_DRAWN
    return {
        "shaft": shaft,
        "big_end": d.rod_angle(now) - d.rod_angle(drawn) - shaft,
        "stroke": (d.piston_place(now) - d.piston_place(drawn)) / 1000,
    }


def piston_at(shaft: float) -> float:
    """Distance [m] of the piston's pin from the shaft's axis, at a shaft position [rad] relative to the drawing."""
    return d.piston_place(d.CRANK_DRAWN + shaft) / 1000


def known() -> dict[str, Any]:
    """The part of expected.json beyond links and joints."""
    return {
        "linkage": {
            "lengths": {"crank": d.THROW / 1000, "rod": d.ROD / 1000},
            "drawn": {"crank": d.CRANK_DRAWN, "rod": d.rod_angle(d.CRANK_DRAWN)},
            "stroke": 2 * d.THROW / 1000,
            "motion": [motion(2 * pi * i / 36) for i in range(37)],
        }
    }
