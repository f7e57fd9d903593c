"""Decisions from evidence: the stronger wins, and fasteners bridge nothing."""

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.draft_robot import _Drafting
from stepbot.draft.evidence.evidence import Evidence, JointEvidence, Priority, Verdict
from stepbot.draft.inference import InferredMechanism
from stepbot.draft.mechanism.decide import decide, nearest
from stepbot.draft.mechanism.joints import same_joint
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.draft.parts.axis import Axis
from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, assembled, group, inferred, joints, links, part
from tests.solids import box, cylinder

BLOCK = box(40, 40, 10)
AXIS = Axis(np.zeros(3), np.array([0.0, 0.0, 1.0]))


def survey() -> Survey:
    """Three blocks on each other."""
    return Survey(assembled(*(part(f"block {n}", BLOCK, z=10.0 * n) for n in range(3))), ALL_SOURCES)


def hinge(score: float, a: int, b: int, priority: Priority = Priority.FOUND) -> JointEvidence:
    """A joint between two of them."""
    return JointEvidence(score, a, b, JointKind.REVOLUTE, AXIS, "", priority=priority)


def test_stronger_evidence_wins() -> None:
    """A joint of 0.8 refuses a weld of 0.7 between its sides, and a weld of 0.9 the joint."""
    for score, groups in ((0.7, [[1], [2, 3]]), (0.9, [[1, 2, 3]])):
        found = Evidence()
        found.joint(hinge(0.8, 1, 2))
        found.weld(score, 1, 2, "")
        found.weld(0.95, 2, 3, "")
        made = decide(survey(), [], found)
        assert list(made.clusters.groups().values()) == groups
        assert (found.joints[0].verdict == Verdict.TAKEN) == (len(groups) == 2)


def slide(score: float, a: int, b: int) -> JointEvidence:
    """A slide between two of them along the line that they turn about, 20 mm beside it."""
    return JointEvidence(score, a, b, JointKind.PRISMATIC, Axis(np.array([0.02, 0.0, 0.0]), AXIS.d), "")


def test_a_weld_does_not_lock_firmer_joints() -> None:
    """A block that turns on another and one that slides on it are not one: neither joint could move then."""
    found = Evidence()
    found.joint(hinge(0.9, 1, 3))
    found.joint(slide(0.88, 2, 3))
    found.weld(0.86, 1, 2, "")
    assert list(decide(survey(), [], found).clusters.groups().values()) == [[1], [2], [3]]


@pytest.mark.parametrize(("score", "verdict"), [(0.9, Verdict.REPEATED), (0.6, Verdict.TAKEN)])
def test_a_screw_and_its_nut_have_no_joint_of_their_own(score: float, verdict: Verdict) -> None:
    """A shaft turns in a frame, and what is around it slides there, by firmer evidence: both are free already."""
    nut = box(40, 40, 10) - cylinder(4, 10).at(0, 0, -5)
    drawn = Survey(
        assembled(part("spindle", cylinder(4, 80).at(0, 0, -40)), part("nut", nut), part("frame", BLOCK, z=-60)),
        ALL_SOURCES,
    )
    found = Evidence()
    found.joint(replace(hinge(0.7, 1, 2), relation=drawn.relation(1, 2)))
    found.joint(hinge(score, 1, 3))
    found.joint(slide(0.88, 2, 3))
    decide(drawn, [], found)
    assert found.joints[0].verdict == verdict


def test_rank_comes_before_score() -> None:
    """A stated joint holds against welds of any score."""
    found = Evidence()
    found.joint(hinge(0.6, 2, 3, Priority.STATED))
    found.weld(0.97, 2, 3, "")
    made = decide(survey(), [], found)
    assert list(made.clusters.groups().values()) == [[1], [2], [3]]
    assert (found.joints[0].verdict, found.welds[0].verdict) == (Verdict.TAKEN, Verdict.REFUSED)


def test_weak_joints_are_offered() -> None:
    """A joint below 0.5 is not drafted."""
    found = Evidence()
    found.joint(hinge(0.4, 1, 2))
    decide(survey(), [], found)
    assert found.joints[0].verdict == Verdict.OFFERED


def test_screw_does_not_join_two_parts() -> None:
    """A screw through two plates that do not touch goes with the tighter one, and does not make them one."""
    plates = [box(300, 200, 10).at(0, 0, z) - cylinder(r, 10).at(0, 0, z - 5) for z, r in ((0.0, 4.3), (60.0, 4.0))]
    screw = part("M8x80 screw", cylinder(4, 80).at(0, 0, -10))
    found = inferred(part("lower", plates[0]), part("upper", plates[1]), screw)
    assert {"upper", "M8x80 screw"} in links(found)
    assert {"lower"} in links(found)


def test_nearest_part_is_the_one_with_the_nearest_faces() -> None:
    """A body in the open corner of a bracket, 60 mm from its faces, is nearest to the post 2 mm beside it."""
    bracket = box(200, 200, 10).at(0, 0, 5) + box(10, 200, 190).at(-95, 0, 105)
    nodes = [
        part("bracket", bracket),
        part("post", box(20, 20, 150), 50, z=85),
        part("body", box(10, 10, 10), 28, z=85),
    ]
    assert nearest(Survey(assembled(*nodes), ALL_SOURCES), [3]) == 2


@pytest.mark.parametrize(
    ("has_hub", "review"),
    [(False, "nothing is fastened to it"), (True, "what the motor turns is only drawn beside its output")],
)
def test_arm_drawn_around_a_horn_moves_with_it(has_hub: bool, review: str) -> None:
    """An arm that overlaps the horn of a motor, or a hub on it, and whose faces touch nothing, is a marked guess."""
    servo = group("servo", part("case", box(40, 20, 40), z=20), part("horn", cylinder(8, 4), z=40))
    hub = [part("hub", box(10, 10, 4), z=46)] * has_hub
    arm = part("arm", box(120, 18, 10), 50, z=52 if has_hub else 47)
    found = inferred(part("base", box(200, 200, 10), z=-5), servo, *hub, arm)
    assert links(found) == [{"base", "servo/case"}, {"servo/horn", "arm"} | ({"hub"} if has_hub else set())]
    assert [(str(arc.evidence.type), arc.evidence.review) for arc in found.arcs] == [("revolute", review)]
    assert "output of a motor beside it" in found.guesses[5 + has_hub]


def test_a_loaded_output_gets_no_more() -> None:
    """A horn with an arm and a motor on it does not get the hoop around it, too, which is nearer to the base."""
    servo = group("servo", part("case", box(40, 20, 40), z=20), part("horn", cylinder(8, 4), z=40))
    arm = [part("arm", box(60, 18, 4), 22, z=46), part("hub motor", box(20, 30, 30), 46, z=63)]
    frame = box(300, 130, 32).at(50, 0, 46) - box(280, 110, 32).at(50, 0, 46)
    found = inferred(part("base", box(200, 200, 10), z=-5), servo, *arm, part("hoop", frame))
    assert {"servo/horn", "arm", "hub motor"} in links(found)
    assert not any({"horn", "hoop"} <= link for link in links(found))


@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.4, 0.3, 0.2), (0.0, 0.0, 0.7)])
def test_nearest_part_does_not_depend_on_how_a_limb_is_turned(rpy: tuple[float, float, float]) -> None:
    """A shin is 2 mm from its foot, and 12 mm from a larger thigh, however all three are turned."""
    thigh, shin, foot = box(90, 100, 20).at(0, 0, 72), box(20, 20, 100), box(20, 60, 20).at(0, 0, -62)
    nodes = [part(name, solid, rpy=rpy) for name, solid in (("thigh", thigh), ("shin", shin), ("foot", foot))]
    assert nearest(Survey(assembled(*nodes), ALL_SOURCES), [2]) == 3


def motors_of_bodies() -> list[Node]:
    """Two motors without names, each a block with a plug and an output plate, 1 mm above a base."""
    block, plug, plate = box(40, 20, 40), box(10, 20, 10), cylinder(8, 4) + box(60, 18, 6).at(20, 0, 7)
    nodes = [part("base", box(400, 200, 20), z=-11)]
    for x in (-100.0, 100.0):
        nodes += [
            part(f"block {x}", block, x, z=20),
            part(f"plug {x}", plug, x - 25, z=20),
            part(f"plate {x}", plate, x, z=40),
        ]
    return nodes


def test_unnamed_motor_with_its_plug_is_held_by_the_nearest_part() -> None:
    """A plug on an unnamed motor is no support: the motor is on the base, 1 mm below it."""
    found = inferred(*motors_of_bodies(), sources=BARE)
    assert {"base", "block -100.0", "plug -100.0", "block 100.0", "plug 100.0"} in links(found)
    assert len(links(found)) == 3


def test_joints_of_the_same_motion() -> None:
    """Slides are the same if they are parallel, hinges on one axis, balls and universal joints at one centre."""

    def joint(kind: JointKind, point: tuple[float, float, float], along: tuple[float, float, float]) -> JointEvidence:
        return JointEvidence(1.0, 0, 1, kind, Axis(np.array(point), np.array(along)), "")

    x, z, here, aside = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.03, 0.0, 0.0)
    slide, hinge, ball, cardan = JointKind.PRISMATIC, JointKind.REVOLUTE, JointKind.BALL, JointKind.UNIVERSAL
    assert same_joint(joint(slide, here, z), joint(slide, aside, z))
    assert not same_joint(joint(slide, here, z), joint(slide, here, x))
    assert same_joint(joint(hinge, here, z), joint(hinge, (0.0, 0.0, 0.5), z))
    assert not same_joint(joint(hinge, here, z), joint(hinge, aside, z))
    assert not same_joint(joint(slide, here, z), joint(hinge, aside, z))
    assert same_joint(joint(ball, here, z), joint(ball, here, x))
    assert not same_joint(joint(ball, here, z), joint(ball, aside, z))
    assert same_joint(joint(ball, here, z), joint(cardan, aside, x))


def test_weak_axes_are_offered_where_no_joint_is() -> None:
    """An axis from 0.3 is a comment, unless its two links are joined otherwise: there it is an alternative."""
    nodes = [part(f"block {n}", BLOCK, z=10.0 * n) for n in range(3)]
    found = InferredMechanism(
        survey(), [[1], [2, 3]], 0, [TreeJoint(hinge(0.9, 1, 2), 0, 1, is_closure=False)], [], [], {}
    )
    aside = Axis(np.array([0.01, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    weak = ((0.3, 2, 3), (0.29, 3, 2), (0.4, 1, 3))
    found.offered.extend(replace(hinge(score, a, b), axis=aside) for score, a, b in weak)
    draft = _Drafting(assembled(*nodes), found).draft("blocks")
    assert [((one.a, one.b), one.confidence.score) for one in draft.offered] == [(("block 1", "block 2"), 0.3)]
    assert [one.confidence.score for one in draft.joints[0].alternatives] == [0.4]


def test_levers_that_touch_turn_on_pins_of_their_own() -> None:
    """Welded, neither of two levers side by side could turn, each on a pin of one base."""
    lever = box(80, 20, 5).at(0, 10, 2.5) - cylinder(5, 5).at(0, 10, 0)
    base = box(200, 60, 5).at(0, 0, -2.5) + cylinder(5, 5).at(0, 10, 0) + cylinder(5, 5).at(0, -10, 0)
    found = inferred(part("base", base), part("left", lever), part("right", lever, 0, -20, 0))
    assert joints(found) == [("revolute", "base", "left"), ("revolute", "base", "right")]
