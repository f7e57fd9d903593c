"""Draw the UR5e: ``python -m robot_library.universal_robots_ur5e.build`` in the root of the checkout.

Writes ur5e.step beside this file; every run gives the same bytes. Joint origins come from expected.json. The
dimensions below are those of the shells around them; letters in brackets name their sources:

[D] Universal Robots, UR5e technical details: footprint 149 mm across, base with four holes 8.5 mm on 132 mm
    (ISO 9409-1-50-4-M6 tool flange: 63 mm across, four M6 on 50 mm, 31.5 mm centring, 6 mm pin), M8 connector.
[V] Offsets of the shells along the joints' axes in the maker's description, config/ur5e/visual_parameters.yaml:
    138 mm to the upper arm, 7 mm to the forearm, 99.7 mm of wrist 2.
[E] Estimated from photographs, to about 3 mm. Wrists 1 and 2 look the same, so both begin at the same distance before
    their axes. Then base and shoulder never touch wrist 1, as in the SRDF of the description (ros-industrial/
    universal_robot, ur5e_moveit_config/config/ur5e.srdf).
"""

from pathlib import Path

import build123d as bd

from ..drawing import Body, draw_described
from ..shapes import ALUMINIUM, BLACK, DARK, STEEL, at, cylinder, flange, housing, on_circle, rod, tube

SHELL = "#d3d5d8"
LID = "#7dadcc"
"""The pale blue covers over the joints."""

LARGE, SMALL = 59.0, 37.5
"""Radii of the joints of base, shoulder and elbow, and of the wrists [E]."""
UPPER_TUBE, FOREARM_TUBE = 43.0, 36.0
"""Radii of the two tubes [E]."""
UPPER_ARM, FOREARM = 425.0, 392.2
"""From axis to axis, as in expected.json."""
UPPER_OFFSET, FOREARM_OFFSET = 138.0, 7.0
"""Of the tubes from the planes of shoulder and elbow [V]."""
WRIST_1 = 133.3
"""From the elbow's plane to wrist 1's, as in expected.json."""
WRIST_2, WRIST_3 = 99.7, 99.6
"""Lengths of the wrists [V]."""
NECK = SMALL + 8
"""From the start of wrist 1, and of wrist 2, to the axis of the next joint [E]."""
GAP = 1.0
"""Of the black seals between links, each side."""


def base() -> list[Body]:
    """The foot: a flange with four holes, the pedestal, the connector of the cable."""
    foot = flange(74.5, 12, on_circle(4, 132, 45), 4.25) - at(cylinder(5, 12), (0, 66, 0))  # [D]
    pedestal = at(housing(63, 87, 3, 0), (0, 0, 12)) + at(cylinder(LARGE - 3, 4), (0, 0, 98))
    plug = rod((0, -60, 34), (0, -79, 34), 11) + rod((0, -79, 34), (0, -86, 34), 8)
    return [Body("foot", foot, ALUMINIUM), Body("pedestal", pedestal, SHELL), Body("connector", plug - pedestal, BLACK)]


def _tee(radius: float, along: float, below: float, lid: float) -> bd.Shape:
    """Two crossing joint housings: one along z from ``below`` to ``lid``, one from the middle to ``along`` in -y."""
    upright = at(housing(radius, lid - below, 6, 0), (0, 0, below))
    return upright + rod((0, 0, 0), (0, -along, 0), radius)


def shoulder() -> list[Body]:
    """From the base's axis to the shoulder's: a crossing of two housings, the base joint's lid on top."""
    z_0 = -162.5 + 102  # the top of the base in this frame
    body = at(housing(LARGE, 120 - 2 * GAP, 4, 0), (0, 0, z_0 + 2 * GAP))
    body += rod((0, 0, 0), (0, -(UPPER_OFFSET - LARGE - 8 - GAP), 0), LARGE)
    seal = at(tube(LARGE - 2, 30, 2 * GAP), (0, 0, z_0))
    lid = at(housing(LARGE - 4, 12, 8, 0), (0, 0, z_0 + 120))
    back = at(housing(LARGE - 4, 12, 8, 0), (0, LARGE - 8, 0), (-90, 0, 0)) - body
    return [Body("seal", seal, BLACK), Body("housing", body, SHELL), Body("lid", lid, LID), Body("back", back, DARK)]


def _arm(
    reach: float, offset: float, tube_radius: float, near: float, far: float, far_end: tuple[float, float]
) -> bd.Shape:
    """Two housings across the ends of a tube along -x; ``far_end`` is the range of z of the far housing."""
    start = rod((0, 0, offset - near - 8), (0, 0, offset + near - 4), near)
    end = rod((-reach, 0, far_end[0]), (-reach, 0, far_end[1]), far)
    return start + end + rod((0, 0, offset), (-reach, 0, offset), tube_radius)


def _lid(x: float, z: float, radius: float, up: bool) -> bd.Shape:
    return at(housing(radius - 4, 13, 9, 0), (x, 0, z), (0 if up else 180, 0, 0))


def upper_arm() -> list[Body]:
    """Two housings and the tube between them; its lids face away from the shoulder."""
    z = UPPER_OFFSET
    top = z + LARGE - 4
    end = (FOREARM_OFFSET + LARGE + GAP, top)
    return [
        Body("seal", rod((0, 0, z - LARGE - 8 - 2 * GAP), (0, 0, z - LARGE - 8), LARGE - 2), BLACK),
        Body("shell", _arm(UPPER_ARM, z, UPPER_TUBE, LARGE, LARGE - 7, end), SHELL),
        Body("shoulder lid", _lid(0, top, LARGE, up=True), LID),
        Body("elbow lid", _lid(-UPPER_ARM, top, LARGE - 7, up=True), LID),
    ]


def forearm() -> list[Body]:
    """The elbow's other half, the thinner tube, and the housing of wrist 1."""
    z = FOREARM_OFFSET
    near = LARGE - 7
    shell = rod((0, 0, z - 48), (0, 0, z + LARGE - GAP), near)
    shell += rod((0, 0, z), (-FOREARM, 0, z), FOREARM_TUBE)
    shell += rod((-FOREARM, 0, z - 40), (-FOREARM, 0, WRIST_1 - NECK), SMALL)
    return [
        Body("seal", rod((0, 0, z + LARGE - GAP), (0, 0, z + LARGE + GAP), near - 2), BLACK),
        Body("shell", shell, SHELL),
        Body("elbow lid", _lid(0, z - 48, near, up=False), LID),
        Body("wrist lid", _lid(-FOREARM, z - 40, SMALL, up=False), LID),
    ]


def wrist_1() -> list[Body]:
    """From wrist 1 to wrist 2: a crossing, with a lid opposite to wrist 2."""
    start = -NECK
    body = rod((0, 0, start + 2 * GAP), (0, 0, SMALL), SMALL)
    body += rod((0, 44, 0), (0, -(WRIST_2 - NECK), 0), SMALL)
    return [
        Body("seal", rod((0, 0, start), (0, 0, start + 2 * GAP), SMALL - 2), BLACK),
        Body("shell", body, SHELL),
        Body("lid", at(housing(SMALL - 3, 10, 7, 0), (0, 44, 0), (-90, 0, 0)), LID),
        Body("cap", at(housing(SMALL - 3, 6, 4, 0), (0, 0, SMALL)), SHELL),
    ]


def wrist_2() -> list[Body]:
    """From wrist 2 to wrist 3: a crossing, with a lid opposite to the tool."""
    start = -NECK
    body = rod((0, 0, start + 2 * GAP), (0, 0, SMALL), SMALL)
    body += rod((0, -44, 0), (0, WRIST_3 - 53, 0), SMALL)
    return [
        Body("seal", rod((0, 0, start), (0, 0, start + 2 * GAP), SMALL - 2), BLACK),
        Body("shell", body, SHELL),
        Body("lid", at(housing(SMALL - 3, 10, 7, 0), (0, -44, 0), (90, 0, 0)), LID),
        Body("cap", at(housing(SMALL - 3, 6, 4, 0), (0, 0, SMALL)), SHELL),
    ]


def wrist_3() -> list[Body]:
    """The tool flange of ISO 9409-1-50-4-M6, and the connector beside it."""
    body = rod((0, 0, -53 + 2 * GAP), (0, 0, -8), SMALL) + rod((0, -SMALL + 6, -30), (0, -SMALL - 9, -30), 7)
    plate = flange(31.5, 8, on_circle(4, 50, 45), 2.5) - at(cylinder(15.75, 6.2), (0, 0, 1.8))  # [D]
    plate -= at(cylinder(3, 6), (25, 0, 2))
    return [
        Body("seal", rod((0, 0, -53), (0, 0, -53 + 2 * GAP), SMALL - 2), BLACK),
        Body("shell", body, SHELL),
        Body("connector", rod((0, -SMALL - 9, -30), (0, -SMALL - 14, -30), 5.5), BLACK),
        Body("flange", at(plate, (0, 0, -8)), STEEL),
    ]


if __name__ == "__main__":
    draw_described(
        Path(__file__).parent,
        {
            "base_link_inertia": base(),
            "shoulder_link": shoulder(),
            "upper_arm_link": upper_arm(),
            "forearm_link": forearm(),
            "wrist_1_link": wrist_1(),
            "wrist_2_link": wrist_2(),
            "wrist_3_link": wrist_3(),
        },
    )
