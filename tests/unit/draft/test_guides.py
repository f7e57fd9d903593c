"""Slides on two rods, and crosses of universal joints."""

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
import pytest

from stepbot.draft.contacts import captured
from stepbot.draft.contacts.captured import Captured, _slide
from stepbot.draft.contacts.contacts import Patch
from stepbot.draft.contacts.planes import Facing
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.guides import CAPTURED, ON_PIN, REVIEW
from stepbot.draft.inference import infer_from
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, assembled, cut, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder

ALONG_X, ALONG_Y = (0.0, pi / 2, 0.0), (pi / 2, 0.0, 0.0)


def carriage(count: int) -> list[Node]:
    """A block on parallel rods along x between two posts."""
    rods = [(y, 30.0) for y in (-30.0, 30.0)[:count]]
    base, block = box(400, 200, 20).at(0, 0, -10), box(50, 100, 20).at(0, 0, 30)
    for x in (-100, 100):
        base = base + box(10, 100, 45).at(x, 0, 22.5)
    for y, z in rods:
        base = base - turned(cylinder(4, 10), -105, y, z, ALONG_X) - turned(cylinder(4, 10), 95, y, z, ALONG_X)
        block = block - turned(cylinder(4.05, 50), -25, y, z, ALONG_X)
    drawn = [part(f"rod {n}", turned(cylinder(4, 210), -105, y, z, ALONG_X)) for n, (y, z) in enumerate(rods)]
    return [part("base", base), part("block", block), *drawn]


def test_block_on_two_rods_slides() -> None:
    """A block with bores on two parallel rods slides along them; the rods go with the base."""
    found = inferred(*carriage(2), sources=BARE)
    assert joints(found) == [("prismatic", "base", "block")]
    assert links(found) == [{"base", "rod 0", "rod 1"}, {"block"}]
    assert abs(found.arcs[0].evidence.axis.d) == pytest.approx((1, 0, 0))


def test_two_blocks_on_the_same_rods_both_slide() -> None:
    """A block with long bores on the rods of another slides on them, too; it does not hold them."""
    base, left, *rods = carriage(2)
    block = box(50, 100, 20).at(60, 0, 30)
    for y in (-30.0, 30.0):
        block = block - turned(cylinder(4.05, 50), 35, y, 30, ALONG_X)
    found = inferred(base, left, part("other", block), *rods, sources=BARE)
    assert joints(found) == [("prismatic", "base", "block"), ("prismatic", "base", "other")]
    assert {"base", "rod 0", "rod 1"} in links(found)


def test_drive_screw_behind_a_coupling_turns_and_holds_no_nut() -> None:
    """A lead screw in a coupling turns with the motor; the nut moves with the block on the rods."""
    base, block, *rods = carriage(2)
    motor = box(42, 42, 40).at(-125, 0, 30) - turned(cylinder(2.5, 10), -114, 0, 30, ALONG_X)
    output = turned(cylinder(2.5, 24), -114, 0, 30, ALONG_X)
    coupling = turned(cylinder(8, 24) - cylinder(2.5, 12) - cylinder(4, 12).at(0, 0, 12), -102, 0, 30, ALONG_X)
    screw, nut = (
        turned(cylinder(4, 170), -90, 0, 30, ALONG_X),
        turned(cylinder(5, 50) - cylinder(4, 50), -25, 0, 30, ALONG_X),
    )
    hollow = cut(Solid(block.shape, box(1, 1, 1).moments), turned(cylinder(5, 60), -30, 0, 30, ALONG_X))
    open_base = cut(Solid(base.shape, box(1, 1, 1).moments), turned(cylinder(10, 40), -120, 0, 30, ALONG_X))
    drive = group("NEMA17", part("case", motor), part("shaft", output))
    found = inferred(
        part("base", open_base),
        part("block", hollow),
        *rods,
        drive,
        part("coupling", coupling),
        part("TR8x8 lead screw", screw),
        part("TR8x8 nut", nut),
    )
    assert ("prismatic", "base", "block") in joints(found)
    assert any({"coupling", "TR8x8 lead screw"} < one for one in links(found))
    assert any({"block", "TR8x8 nut"} <= one for one in links(found))


def test_yoke_with_two_rods_in_bearings_slides_and_its_block_lets_the_crank_turn() -> None:
    """Rods in bushings slide with the yoke on both; the block on the crank's pin slides in the slot of the yoke."""
    base = box(300, 160, 10).at(0, 0, -5)
    post = box(16, 150, 60).at(0, 0, 30)
    for y in (-50, 50):
        post = post - turned(cylinder(8, 16), -8, y, 40, ALONG_X)
    base = base + post.at(-120, 0, 0) + post.at(120, 0, 0)
    base = base - cylinder(5.05, 10).at(0, 0, -10)
    bush = turned(cylinder(8, 16) - cylinder(6, 16), -8, 0, 0, ALONG_X)
    nodes = [part("bushing", bush, x, y, 40) for x in (-120, 120) for y in (-50, 50)]
    crank = cylinder(5, 30).at(0, 0, -15) + cylinder(35, 5).at(0, 0, 15) + cylinder(5, 20).at(22, 0, 20)
    block = box(16, 18, 12).at(22, 0, 30) - cylinder(5, 12).at(22, 0, 24)
    yoke = box(30, 130, 24).at(22, 0, 36) - box(16, 66, 24).at(22, 0, 36)
    for y in (-50, 50):
        yoke = yoke - turned(cylinder(6, 30), 7, y, 40, ALONG_X)
        nodes.append(part("rod", turned(cylinder(6, 280), -130, y, 40, ALONG_X)))
    found = inferred(part("base", base), part("crank", crank), part("block", block), part("yoke", yoke), *nodes)
    assert sorted(kind for kind, *_ in joints(found)) == ["prismatic", "prismatic", "revolute", "revolute"]
    assert {("prismatic", "base", "yoke"), ("prismatic", "block", "yoke")} <= set(joints(found))


def test_block_on_one_rod_does_not_only_slide() -> None:
    """On one rod a block turns as well: no prismatic joint."""
    assert "prismatic" not in [kind for kind, *_ in joints(inferred(*carriage(1), sources=BARE))]


def test_lever_on_the_pins_of_two_others_does_not_slide() -> None:
    """A thick lever on two pins, each in a lever of its own, turns on both: no part holds the pins like rods."""
    lever = box(60, 14, 10)
    for x in (-20.0, 20.0):
        lever = lever - turned(cylinder(3.05, 14), x, 7, 0, ALONG_Y)
    nodes = [part("lever", lever)]
    for name, x in (("left", -20.0), ("right", 20.0)):
        nodes.append(part(f"{name} pin", turned(cylinder(3, 24), x, 12, 0, ALONG_Y)))
        for n, y in enumerate((-9.7, 9.7)):
            cheek = box(10, 4.4, 60).at(x, y, -25) - turned(cylinder(3, 4.4), x, y + 2.2, 0, ALONG_Y)
            nodes.append(part(f"{name} cheek {n}", cheek))
    found = inferred(*nodes, sources=BARE)
    assert {kind for kind, *_ in joints(found)} == {"revolute"}
    assert {"left pin", "left cheek 0", "left cheek 1"} in links(found)


def forks(radius: float) -> tuple[Solid, Solid]:
    """Two forks around a cross, with a bore in each of their cheeks."""
    lower, upper = box(90, 40, 20).at(0, 0, -90), box(40, 90, 20).at(0, 0, 90)
    for sign in (-1, 1):
        lower = lower + box(10, 40, 100).at(sign * 35, 0, -30)
        upper = upper + box(40, 10, 100).at(0, sign * 35, 30)
    lower = lower - turned(cylinder(radius, 10), -40, 0, 0, ALONG_X) - turned(cylinder(radius, 10), 30, 0, 0, ALONG_X)
    upper = upper - turned(cylinder(radius, 10), 0, 40, 0, ALONG_Y) - turned(cylinder(radius, 10), 0, -30, 0, ALONG_Y)
    return lower, upper


CROSS = turned(cylinder(3, 80), -40, 0, 0, ALONG_X) + turned(cylinder(3, 80), 0, 40, 0, ALONG_Y)


def test_cross_is_a_universal_joint() -> None:
    """A small block with two pins at a right angle, each in a fork, is the cross between them."""
    lower, upper = forks(3.02)
    found = inferred(group("in", part("fork", lower)), group("out", part("fork", upper)), part("cross", CROSS))
    (arc,) = found.arcs
    assert arc.evidence.type == JointKind.UNIVERSAL
    assert arc.evidence.axis.point == pytest.approx((0, 0, 0), abs=1e-9)
    assert arc.evidence.axis2 is not None
    assert abs(arc.evidence.axis.d @ arc.evidence.axis2.d) < 1e-9


@pytest.mark.parametrize("pin", [3.0, 2.99])
def test_cross_in_bushes_turns_in_both_forks(pin: float) -> None:
    """Its pins are in bushes, exactly or with play, and these in the forks: two hinges, and each bush with its fork."""
    lower, upper = forks(5)
    cross = turned(cylinder(pin, 80), -40, 0, 0, ALONG_X) + turned(cylinder(pin, 80), 0, 40, 0, ALONG_Y)
    bush = cylinder(5, 10) - cylinder(3, 10)
    places = ((-40, 0, ALONG_X), (30, 0, ALONG_X), (0, 40, ALONG_Y), (0, -30, ALONG_Y))
    bushes = [part(f"bush {n}", bush, x, y, 0, rpy) for n, (x, y, rpy) in enumerate(places)]
    found = inferred(part("lower", lower), part("upper", upper), part("cross", cross), *bushes, sources=BARE)
    assert joints(found) == [("revolute", "cross", "lower"), ("revolute", "cross", "upper")]
    assert sorted(map(len, links(found))) == [1, 3, 3]


def test_faces_of_one_side_hold_nothing() -> None:
    """Two faces of a slide that face the same way, within rounding or drawn a little apart, do not hold it."""
    patch = Patch(0, 1, np.zeros(3), np.array([0.0, 0.0, 1.0]), 1e-4, np.zeros((1, 3)), (), np.zeros(3), 0.0)
    x, near = np.array([1.0, 0.0, 0.0]), np.array([cos(1e-5), sin(1e-5), 0.0])
    same, apart = ([Facing(x, 0.0, patch), Facing(other, 0.0, patch)] for other in (near, -near))
    assert not captured._is_between(same)
    assert captured._is_between(apart)


def slot(length: float) -> list[Node]:
    """A block of 70 mm in a slot of a length [mm]: a floor, a plate with the slot and a lid with a narrower one."""
    floor, plate, lid = box(200, 100, 5).at(0, 0, -2.5), box(200, 100, 10).at(0, 0, 5), box(200, 100, 5).at(0, 0, 12.5)
    plate, lid = plate - box(length, 40, 10).at(0, 0, 5), lid - box(length, 24, 5).at(0, 0, 12.5)
    for x in (-90, 90):
        floor, plate, lid = (
            solid - cylinder(2, 5 * count).at(x, 40, z)
            for solid, count, z in ((floor, 1, -5), (plate, 2, 0), (lid, 1, 10))
        )
    block = box(70, 39, 9).at(0, 0, 4.5) + box(70, 20, 20).at(0, 0, 19)
    return [part("floor", floor), part("plate", plate), part("lid", lid), part("block", block)]


def test_a_slot_of_bolted_plates_guides_a_slide() -> None:
    """A floor, a plate with a slot and a lid with a narrower one hold a block that none of them holds alone."""
    found = inferred(*slot(180))
    assert joints(found) == [("prismatic", "block", "plate")]
    assert abs(found.arcs[0].evidence.axis.d) == pytest.approx((1, 0, 0))
    assert found.arcs[0].evidence.review


@pytest.mark.parametrize(("length", "slides"), [(70.0, 0), (180.0, 1)])
def test_equal_groups_of_bolted_parts_are_compared_once(
    length: float, slides: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is no slide among bolted parts is not tried in their copies; a slide is found in each."""
    tried: list[bool] = []

    def slide(facing: Sequence[Facing]) -> Captured | None:
        found = _slide(facing)
        tried.append(found is not None)
        return found

    monkeypatch.setattr(captured, "_slide", slide)
    parts, counts = slot(length), []
    for copies in (1, 4):
        tried.clear()
        nodes = [
            Node(f"copy {n}", children=parts, X=Pose.from_xyz_rpy((0.5 * n, 0.1, 0.0), (0, 0, n * pi / 2)))
            for n in range(copies)
        ]
        assert len(Survey(assembled(*nodes), ALL_SOURCES).captured) == copies * slides
        counts.append(tried.count(False))
    assert counts[0] > 1
    assert counts[1] == counts[0]


def test_a_link_of_a_wrist_is_no_cross() -> None:
    """A small link that turns about one axis, and has the bore of a flange on one that intersects it, is a link."""
    fork = box(600, 100, 30).at(-330, 0, 0) + box(60, 8, 30).at(0, 16, 0) + box(60, 8, 30).at(0, -16, 0)
    fork = cut(fork, turned(cylinder(7, 60), 0, 30, 0, ALONG_Y))
    link = box(54, 24, 20).at(17, 0, 0) + turned(cylinder(7, 40), 0, 20, 0, ALONG_Y)
    link = cut(link, turned(cylinder(6, 20), 24, 0, 0, ALONG_X))
    flange = turned(cylinder(6, 40), 24, 0, 0, ALONG_X) + box(10, 120, 20).at(69, 20, 0)
    found = inferred(part("fork", fork), part("link", link), part("flange", flange))
    assert joints(found) == [("revolute", "flange", "link"), ("revolute", "fork", "link")]


@pytest.mark.parametrize("pads", [True, False])
def test_a_tube_slides_on_glide_pads(pads: bool) -> None:
    """A tube with clearance to pads on the wall of a wider one slides; 4 mm of clearance alone guide nothing."""
    outer = box(80, 80, 400) - box(74, 74, 402)
    inner = box(66, 66, 400) - box(60, 60, 402)
    lined = [
        part(f"pad {n} {z}", turned(box(3.8, 30, 30), rpy=(0, 0, n * pi / 2)), *at, z)
        for z in (120.0, 180.0)
        for n, at in enumerate(((35.1, 0.0), (0.0, 35.1), (-35.1, 0.0), (0.0, -35.1)))
    ]
    found = inferred(part("outer", outer), part("inner", inner, z=150), *(lined if pads else []), sources=BARE)
    moving = [kind for kind, *_ in joints(found) if kind != "fixed"]
    assert moving == (["prismatic"] if pads else [])
    assert not pads or found.arcs[0].evidence.review == REVIEW.format(CAPTURED)


def test_a_rod_as_thick_as_its_bore_is_the_screw_of_a_slide() -> None:
    """Of three parallel rods in a block two have play and guide it; the third is drawn as a thread in it and turns."""
    nodes = carriage(2)
    base, block = (
        box(400, 200, 20).at(0, 0, -10),
        box(50, 100, 20).at(0, 0, 30) - turned(cylinder(6, 50), -25, 0, 30, ALONG_X),
    )
    for x in (-100, 100):
        base = base + box(10, 100, 45).at(x, 0, 22.5)
    for y in (-30.0, 30.0):
        for x in (-105, 95):
            base = base - turned(cylinder(4, 10), x, y, 30, ALONG_X)
        block = block - turned(cylinder(4.05, 50), -25, y, 30, ALONG_X)
    for x in (-105, 95):
        base = base - turned(cylinder(6.1, 10), x, 0, 30, ALONG_X)
    screw = turned(cylinder(6, 240), -120, 0, 30, ALONG_X)
    found = inferred(part("base", base), part("block", block), *nodes[2:], part("screw", screw), sources=BARE)
    assert joints(found) == [("prismatic", "base", "block")]
    assert not any({"block", "screw"} <= link for link in links(found))


def test_a_plate_that_screws_hold_does_not_slide_on_them() -> None:
    """A ring below a table, its unnamed screws sunk in this, does not slide though a block on the table hides them."""
    ring, table, block, screws = cylinder(50, 14), cylinder(60, 15), box(100, 100, 20).at(0, 0, 10), list[Node]()
    for x in (-45, 45):
        ring = ring - cylinder(2.1, 14).at(x, 0, 0)
        table = table - cylinder(2.1, 15).at(x, 0, 0) - cylinder(3.7, 4).at(x, 0, 11)
        screws.append(part(f"c{x}", cylinder(2, 25) + cylinder(3.5, 4).at(0, 0, 25), x, 0, -14))
    nodes = [part("ring", ring, z=-14), part("table", table), part("block", block, z=15)]
    assert not joints(inferred(*nodes, *screws, sources=BARE))


def channel_and_block(play: float, *others: Node) -> Survey:
    """A block on a pin of an arm, in a channel of the base that is open towards the arm."""
    channel = box(300, 40, 60) - box(300, 25, 40).at(0, 7.5, 0)
    block = box(40, 20, 40 - 2 * play).at(0, 7.5, 0) - turned(cylinder(6.02, 20), 0, 17.5, 0, ALONG_Y)
    arm = box(20, 8, 200).at(0, 26, 80) - turned(cylinder(6, 8), 0, 30, 0, ALONG_Y)
    pin = turned(cylinder(6, 32), 0, 30, 0, ALONG_Y)
    nodes = part("base", channel), part("block", block), part("arm", arm), part("pin", pin)
    return Survey(assembled(*nodes, *others), ALL_SOURCES)


def test_block_on_a_pin_slides_in_its_channel() -> None:
    """With play between two faces along its pin; not without, and not if something beside the pin holds it."""
    slide = channel_and_block(0.1).captured[1, 2]
    assert slide.axis.is_along(np.array([1.0, 0.0, 0.0]))
    assert slide.has_play
    (arc,) = (arc for arc in infer_from(channel_and_block(0.1)).arcs if arc.evidence.type == JointKind.PRISMATIC)
    assert arc.evidence.why == f"{ON_PIN} with clearance"
    assert arc.evidence.review == REVIEW.format(ON_PIN)
    assert (1, 2) not in channel_and_block(0.0).captured
    assert (1, 2) not in channel_and_block(0.1, part("lug", box(10, 10, 10).at(25, 7.5, 0))).captured


@pytest.mark.parametrize(("count", "slides"), [(2, 2), (3, 0)])
def test_what_is_in_a_row_on_a_rail_is_clipped_to_it(count: int, slides: int) -> None:
    """Two carriages may slide on a rail; of three that could not pass each other, as terminals, none does."""
    rail = box(400, 40, 20) - box(400, 20, 10) - box(400, 10, 6).at(0, 0, 7.5)
    block = box(30, 19.8, 9.8) + box(30, 9.8, 8).at(0, 0, 8) + box(30, 30, 40).at(0, 0, 31)
    blocks = [part(f"block {n}", block, x=-120.0 + 70.0 * n) for n in range(count)]
    found = inferred(part("rail", rail), *blocks)
    assert [kind for kind, *_ in joints(found)] == ["prismatic"] * slides


def test_bodies_of_a_linear_actuator_are_one_case_and_its_piston_slides() -> None:
    """Also where the rod is as thick as the bore of the head: motor and head go with the tube."""
    tube = cylinder(19, 200) - cylinder(15, 180).at(0, 0, 20)
    rod = cylinder(14.8, 12).at(0, 0, 60) + cylinder(10, 200).at(0, 0, 72)
    head = cylinder(15, 8).at(0, 0, 192) + cylinder(19, 12).at(0, 0, 200) - cylinder(10, 20).at(0, 0, 192)
    bodies = part("actuator tube", tube), part("actuator motor", cylinder(19, 60).at(0, 0, -60)), part("rod", rod)
    found = inferred(group("linear actuator", *bodies, part("actuator head", head)))
    (case,) = (names for names in links(found) if "linear actuator/actuator tube" in names)
    assert case == {f"linear actuator/actuator {name}" for name in ("tube", "motor", "head")}
    (arc,) = found.arcs
    assert arc.evidence.type == JointKind.PRISMATIC
    assert arc.evidence.review
