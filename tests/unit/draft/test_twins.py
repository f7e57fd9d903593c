"""Equal bodies that nothing holds: fingers and wheels by their shape, and what is neither."""

from math import pi

import numpy as np
import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.evidence import JointEvidence, Verdict
from stepbot.draft.evidence.repetition import repeated_joints
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, assembled, inferred, joints, links, part, turned
from tests.solids import box, cylinder

ALONG_Y = (pi / 2, 0.0, 0.0)
FINGER = box(20, 15, 60)


def gripper(size: float) -> list[Node]:
    """A palm of a size [mm] with two fingers in front of it, 2 mm away and 30 mm apart."""
    palm = part("palm", box(size, size, size))
    fingers = [part(name, FINGER, x=x, z=size / 2 + 32) for name, x in (("one", -25.0), ("two", 25.0))]
    return [palm, *fingers]


def test_two_equal_bodies_before_a_larger_one_slide() -> None:
    """Two blocks in front of a palm are fingers: they slide towards each other, marked for review."""
    found = inferred(*gripper(100.0), sources=BARE)
    assert joints(found) == [("prismatic", "one", "palm"), ("prismatic", "palm", "two")]
    for arc in found.arcs:
        assert abs(arc.evidence.axis.d) == pytest.approx((1.0, 0.0, 0.0))
        assert arc.evidence.review == "guessed from its shape; no contact shows this joint"


@pytest.mark.parametrize("ratio", [1.0 - 5e-4, 1.0 + 5e-4])
def test_fingers_that_are_equal_but_for_a_rounding(ratio: float) -> None:
    """Bodies whose volumes differ by half a thousandth are equal."""
    palm, one, _ = gripper(100.0)
    two = part("two", box(20, 15, 60 * ratio), x=25.0, z=82.0)
    assert joints(inferred(palm, one, two, sources=BARE)) == [
        ("prismatic", "one", "palm"),
        ("prismatic", "palm", "two"),
    ]


def test_a_joint_is_repeated_on_its_own_side() -> None:
    """Arm and lever turn on one line on either side of a cart: no arm turns on the lever of the other side."""
    bore = turned(cylinder(4, 10), -5, rpy=(0, pi / 2, 0))
    arm, lever = ((box(10, 20, length) - bore).at(x, 0, 0) for length, x in ((60, 40), (90, 50)))
    named = [(n, name, solid) for n in (0, 1) for name, solid in (("arm", arm), ("lever", lever))]
    sides = [part(f"{name} {n}", solid, rpy=(0, 0, n * pi)) for n, name, solid in named]
    survey = Survey(assembled(*sides), ALL_SOURCES)
    known = JointEvidence(0.9, 1, 2, JointKind.REVOLUTE, Axis(np.zeros(3), np.array([1.0, 0.0, 0.0])), "")
    found = repeated_joints(survey, [known], [[1], [2], [3], [4]])
    assert [(h.a, h.b) for h in found] == [(3, 4)]


@pytest.mark.parametrize(("off", "count"), [(0.0, 1), (0.3, 1), (3.0, 0)])
def test_a_joint_is_repeated_where_an_equal_part_is_on_the_same_body(off: float, count: int) -> None:
    """A leg turns on its pin of the body as its twin does, also if drawn 0.3 mm off; not beside the pin."""
    body = box(200, 40, 20) + cylinder(4, 20).at(-60, 0, 10) + cylinder(4, 20).at(60, 0, 10)
    leg = box(20, 90, 8) - cylinder(4.05, 8).at(0, 0, -4)
    legs = [part(f"leg {n}", leg, x + off * n, 0, 18) for n, x in enumerate((-60.0, 60.0))]
    survey = Survey(assembled(part("body", body), *legs), ALL_SOURCES)
    axis = Axis(np.array([-0.06, 0.0, 0.018]), np.array([0.0, 0.0, 1.0]))
    known = JointEvidence(0.9, 1, 2, JointKind.REVOLUTE, axis, "")
    found = repeated_joints(survey, [known], [[1], [2], [3]])
    assert [(h.a, h.b) for h in found] == [(1, 3)] * count


def test_tiny_fingers_are_offered_only() -> None:
    """Fingers of less than two thousandths of the volume belong to the palm; their motion is offered."""
    found = inferred(*gripper(400.0), sources=BARE)
    assert links(found) == [{"palm", "one", "two"}]
    offered = [h for h in found.offered if "equal" in h.why]
    assert [(str(h.type), h.verdict) for h in offered] == [("prismatic", Verdict.OFFERED)] * 2


def test_equal_round_bodies_are_wheels() -> None:
    """Four discs beside a chassis, 3 mm away, turn about their own axes."""
    wheels = [
        part(f"disc {n}", turned(cylinder(50, 30), rpy=ALONG_Y), x, y + 15, -40)
        for n, (x, y) in enumerate([(-120, -118), (-120, 118), (120, -118), (120, 118)])
    ]
    found = inferred(part("chassis", box(400, 200, 80)), *wheels, sources=BARE)
    assert joints(found) == [("revolute", "chassis", f"disc {n}") for n in range(4)]
    assert all(np.allclose(abs(arc.evidence.axis.d), (0, 1, 0)) for arc in found.arcs)


def test_single_body_and_unequal_ones_are_no_twins() -> None:
    """One loose block, or two of different sizes, get no joint."""
    palm, one, _ = gripper(100.0)
    other = part("other", box(20, 15, 50), x=25, z=82)
    for nodes in ([palm, one], [palm, one, other]):
        assert joints(inferred(*nodes, sources=BARE)) == []


def test_equal_pads_on_different_bodies_are_no_fingers() -> None:
    """Pads, each near a finger of its own, are not the fingers of one hand."""
    palm, one, two = gripper(100.0)
    pads = [part(f"pad {n}", box(2, 15, 30), x=x, z=90) for n, x in enumerate((-13.5, 13.5))]
    found = inferred(palm, one, two, *pads, sources=BARE)
    assert not [arc for arc in found.arcs if {arc.evidence.a, arc.evidence.b} & {4, 5}]
