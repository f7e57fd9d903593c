"""Rollers of omnidirectional wheels, and round bodies around a hub that are none."""

from math import pi

import numpy as np
import pytest

from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, inferred, joints, part, turned
from tests.solids import box, cylinder

COUNT = 6
BASE = part("base", box(200, 200, 60), z=-80)
"""Some way below the wheel."""


def wheel(inclination: float, *, radial: bool = False, count: int = COUNT) -> list[Node]:
    """A hub about z, and rollers of r 6 mm around it with gaps, inclined to z [rad] or along the radius."""
    roller = turned(cylinder(6, 30).at(0, 0, -15), rpy=(0, pi / 2, 0) if radial else (inclination, 0, 0))
    nodes = [part("hub", cylinder(22, 30).at(0, 0, -15))]
    for n in range(count):
        angle = 2 * pi * n / COUNT
        nodes.append(part(f"roller {n}", roller, 38 * np.cos(angle), 38 * np.sin(angle), rpy=(0, 0, angle)))
    return nodes


@pytest.mark.parametrize("inclination", [pi / 4, pi / 2])
def test_rollers_of_mecanum_and_omni_wheels_turn_about_their_own_axes(inclination: float) -> None:
    """Each roller turns on the hub, and the hub on the base; all are marked for review."""
    found = inferred(BASE, *wheel(inclination), sources=BARE)
    expected = [("revolute", "base", "hub"), *(("revolute", "hub", f"roller {n}") for n in range(COUNT))]
    assert joints(found) == expected
    for arc in found.arcs:
        assert arc.evidence.review == "guessed from its shape; no contact shows this joint"
        if arc.evidence.of_roller:
            assert abs(arc.evidence.axis.d[2]) == pytest.approx(np.cos(inclination), abs=1e-9)
        else:
            assert np.allclose(abs(arc.evidence.axis.d), (0, 0, 1))


@pytest.mark.parametrize("nodes", [wheel(0.0), wheel(0.0, radial=True), wheel(pi / 4, count=4)])
def test_bearing_rollers_spokes_and_uneven_patterns_are_no_rollers(nodes: list[Node]) -> None:
    """Round bodies parallel to the hub, along its radius, or only on one side of it, are not taken for rollers."""
    found = inferred(BASE, *nodes, sources=BARE)
    assert not [arc for arc in found.arcs if arc.evidence.of_roller]
    assert {arc.evidence.type for arc in found.arcs if not arc.evidence.review} <= {JointKind.FIXED}
