"""Draw the 2F-85 gripper: ``python -m robot_library.robotiq_2f85.build`` in the root of the checkout.

Writes 2f85.step beside this file; every run gives the same bytes. Joint origins come from expected.json. The
dimensions below are those of the parts around them; letters in brackets name their sources:

[P] The fingertip pads in the maker's description: 22 mm wide, 6.35 mm thick, 37.5 mm high.
[J] Positions of the pins, from the joints in expected.json.
[D] Data sheet: 75 mm across the coupling; 85 mm between the open pads, which these positions and pads give to 1 mm.
[E] Estimated from photographs, to about 2 mm.

All pins are parallel to x. Along x the parts are in layers, symmetric about the middle: outer knuckle and inner finger
in the middle, the outer finger's two cheeks beside them, then those of the inner knuckle, then the body's. One side
is drawn with y outwards; the other is the same, rotated by half a turn.
"""

from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..shapes import ALUMINIUM, BLACK, DARK, STEEL, at, cylinder, flange, hull_plate, on_circle, rod

Pin = tuple[float, float]
"""(y, z)."""

OUTER, INNER = (30.6011, 54.904), (12.7, 61.42)
"""Pins of outer and inner knuckle in the body [J]."""
KNUCKLE: Pin = (31.5, -4.1)
"""From the outer knuckle's pin to the outer finger's frame [J]."""
FINGER: Pin = (6.1, 47.1)
"""From there to the inner finger's pin [J]."""
CLOSING: Pin = (INNER[0] - OUTER[0], INNER[1] - OUTER[1])
"""From the inner finger's pin to that of the inner knuckle: the distance between the pins in the body. The four pins
form a parallelogram, which keeps the pads upright."""
CRANK: Pin = (KNUCKLE[0] + FINGER[0], KNUCKLE[1] + FINGER[1])
"""From pin to pin of either knuckle's crank."""
PAD: Pin = (-22.0203446693, 32.42)
"""Centre of the pad in the inner finger [J]."""
MIDDLE, FORK, KNUCKLE_FORK, BODY_FORK = (0.0, 6.8), (7.4, 11.8), (12.4, 16.4), (17.0, 24.0)
"""Range of each layer, as distances from the middle [E]."""


def _plates(circles: list[tuple[Pin, float]], layer: tuple[float, float]) -> list[bd.Shape]:
    """The hull of circles in (y, z), within a layer: one plate across the middle, or one on each side."""
    inside, outside = layer
    thickness = 2 * outside if inside == 0 else outside - inside
    starts = [-outside] if inside == 0 else [-outside, inside]
    plate = hull_plate(circles, thickness)
    return [bd.Plane(origin=(x, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0)) * plate for x in starts]


def _pin(place: Pin, half: float, radius: float) -> bd.Shape:
    return rod((-half, *place), (half, *place), radius)


def body() -> list[Body]:
    """The coupling, the housing of motor and spindle, the cheeks with the pins, and the palm."""
    coupling = flange(37.5, 12, on_circle(4, 50, 45), 3.3) - at(cylinder(34, 2), (0, 0, 8))  # [D]
    lower = bd.loft([_level(12, 73, 73, 36), _level(40, 58, 76, 16)]) + bd.loft(
        [_level(39.8, 58, 76, 16), _level(46, 52, 74, 14)]
    )
    cheeks: bd.Shape = lower
    for plate in _plates(
        [((-34, 46), 6), ((34, 46), 6), ((-31, 56), 8.5), ((31, 56), 8.5), ((-14, 64), 9), ((14, 64), 9)], BODY_FORK
    ):
        cheeks += plate
    palm = at(bd.Box(21, 17, 52), (0, 0, 66)) + at(bd.Box(30, 26, 4), (0, 0, 90))
    holes = [_pin((sign * y, z), 24.6, 3.0) for sign in (-1, 1) for y, z in (OUTER, INNER)]
    housing = cheeks + palm
    for hole in holes:
        housing -= hole
    plug = rod((28, 0, 24), (44, 0, 24), 6) - housing
    return [
        Body("coupling", coupling, ALUMINIUM),
        Body("housing", housing, BLACK),
        *(Body("pin", pin, STEEL) for pin in holes),
        Body("plug", plug.solids().sort_by(bd.Axis.X)[-1], DARK),
    ]


def _level(z: float, depth: float, width: float, edge: float) -> bd.Face:
    return (bd.Pos(0, 0, z) * bd.RectangleRounded(depth, width, edge)).face()


def outer_knuckle() -> list[Body]:
    """The crank driven by the spindle."""
    (plate,) = _plates([((0, 0), 9), (KNUCKLE, 8)], MIDDLE)
    return [Body("crank", plate - _pin((0, 0), 20, 3.05), DARK)]


def outer_finger() -> list[Body]:
    """Two cheeks from the crank to the inner finger's pin, joined by a rod."""
    plates = _plates([((0, 0), 8), (FINGER, 7.5)], FORK)
    pins = [_pin((0, 0), FORK[1], 3), _pin(FINGER, FORK[1] + 0.4, 3)]
    for pin in pins:
        plates = [plate - pin for plate in plates]
    return [*(Body("cheek", plate, DARK) for plate in plates), *(Body("pin", pin, STEEL) for pin in pins)]


def inner_knuckle() -> list[Body]:
    """The other crank: two cheeks beside everything else."""
    plates = _plates([((0, 0), 7), (CRANK, 6.5)], KNUCKLE_FORK)
    pin = _pin(CRANK, KNUCKLE_FORK[1], 2.5)
    return [*(Body("cheek", plate - _pin((0, 0), 20, 3.05) - pin, DARK) for plate in plates), Body("pin", pin, STEEL)]


def inner_finger() -> list[Body]:
    """The finger that carries the pad; the parallelogram keeps it upright."""
    (web,) = _plates([((0, 0), 7), (CLOSING, 6)], MIDDLE)
    lug = _plates([(CLOSING, 6)], (0.0, FORK[1]))[0]
    back = at(bd.Box(25, 7.5, 46), (0, PAD[0] + 7.0, PAD[1] - 1))
    (web_up,) = _plates([(CLOSING, 5), ((PAD[0] + 7, 46), 3), ((-1, 6), 5)], MIDDLE)
    holes = _pin((0, 0), 20, 3.05) + _pin(CLOSING, 20, 2.55)
    return [Body("finger", web + lug + back + web_up - holes, BLACK)]


def pad() -> list[Body]:
    """The fingertip's pad around its own middle [P], with grooves across."""
    block = bd.Box(22, 6.35, 37.5)
    for z in range(-15, 16, 5):
        block -= at(bd.Box(22, 0.8, 1.2), (0, -6.35 / 2 + 0.4, z))
    return [Body("pad", block, "#4a4d52")]


if __name__ == "__main__":
    links = {
        "outer_knuckle": outer_knuckle(),
        "outer_finger": outer_finger(),
        "inner_knuckle": inner_knuckle(),
        "inner_finger": inner_finger(),
        "inner_finger_pad": pad(),
    }
    draw_described(
        Path(__file__).parent,
        {
            "robotiq_arg2f_base_link": body(),
            **{f"{side}_{name}": bodies for side in ("left", "right") for name, bodies in links.items()},
        },
    )
