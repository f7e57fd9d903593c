"""Equal fingers that are drawn without what guides them."""

import numpy as np

from tests.assembled import inferred, joints, part
from tests.solids import box, cylinder

PALM, FINGER = box(100, 40, 20), box(10, 30, 60)


def test_two_equal_fingers_on_a_palm_slide_towards_each_other() -> None:
    """Each has a joint along the line between them, marked for review."""
    found = inferred(part("palm", PALM), part("finger L", FINGER, x=-30, z=40), part("finger R", FINGER, x=30, z=40))
    assert joints(found) == [("prismatic", "finger L", "palm"), ("prismatic", "finger R", "palm")]
    assert all(np.allclose(np.abs(arc.evidence.axis.d), (1, 0, 0)) and arc.evidence.review for arc in found.arcs)


def test_screwed_fingers_are_fixed() -> None:
    """Two pairs of holes hold a finger."""
    palm, finger = PALM, FINGER
    for y in (-8, 8):
        finger -= cylinder(2, 60).at(0, y, -30)
        for x in (-30, 30):
            palm -= cylinder(2, 20).at(x, y, -10)
    found = inferred(part("palm", palm), part("finger L", finger, x=-30, z=40), part("finger R", finger, x=30, z=40))
    assert joints(found) == []


def test_equal_blocks_without_such_a_name_are_fixed() -> None:
    """Equal feet on a plate are no fingers."""
    found = inferred(part("plate", PALM), part("block L", FINGER, x=-30, z=40), part("block R", FINGER, x=30, z=40))
    assert joints(found) == []
