"""Evidence of two parts in contact: joint or weld, and how strong."""

from math import pi

import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.evidence import Evidence
from stepbot.draft.evidence.pairs import PairEvidence
from stepbot.draft.evidence.pivots import screwed_evidence
from stepbot.draft.evidence.subassemblies import Structure, several_axes
from stepbot.draft.evidence.wheels import wheel_evidence
from tests.assembled import BARE, Node, assembled, cut, group, inferred, joints, part, turned
from tests.solids import Solid, box, cylinder


def evidence(*nodes: Node) -> Evidence:
    """The evidence of all pairs."""
    survey, found = Survey(assembled(*nodes), ALL_SOURCES), Evidence()
    structure = Structure(survey, set())
    PairEvidence(survey, structure, found).collect([])
    several_axes(structure, found)
    return found


def strongest(evidence: Evidence) -> str:
    """Type or ``weld`` of the strongest evidence."""
    best = evidence.ranked()[0]
    return str(getattr(best, "type", "weld"))


def plate(*holes: tuple[float, float]) -> Solid:
    """A plate of 10 mm with holes of r 3 mm, its upper side at z = 0."""
    solid = box(80, 60, 10).at(0, 0, -5)
    for x, y in holes:
        solid -= cylinder(3, 10).at(x, y, -10)
    return solid


def upside(solid: Solid) -> Solid:
    """The same plate above z = 0."""
    return solid.at(0, 0, 10)


PIN = plate() + cylinder(10, 30)
BORED = box(80, 60, 25).at(0, 0, 12.5) - cylinder(10.02, 25)


def test_pin_between_subassemblies_is_a_joint_and_within_one_a_weld() -> None:
    """A pin in a bore turns between two subassemblies; in one of them it is only offered."""
    apart = evidence(group("a", part("pin", PIN)), group("b", part("arm", BORED)))
    assert strongest(apart) == "revolute"
    assert apart.ranked()[0].score >= 0.8
    together = evidence(group("a", part("pin", PIN), part("arm", BORED)), part("other", box(5, 5, 5), 500))
    assert max(h.score for h in together.joints) < 0.5


def test_holes_make_plates_one() -> None:
    """Two holes in line are a weld of 0.92; one is weaker, whether a screw is in it or not."""
    two = [(-20, 0), (20, 0)]
    found = evidence(part("lower", plate(*two)), part("upper", upside(plate(*two))))
    assert (strongest(found), found.ranked()[0].score) == ("weld", 0.92)
    one = evidence(part("lower", plate(two[0])), part("upper", upside(plate(two[0]))))
    assert one.ranked()[0].score < 0.6


def test_spigot_does_not_guide() -> None:
    """A pin that is in its bore by less than half of its radius centres the part and does not guide it."""
    short = plate() + cylinder(10, 3)
    found = evidence(group("a", part("spigot", short)), group("b", part("cover", BORED)))
    long = evidence(group("a", part("pin", PIN)), group("b", part("arm", BORED)))
    assert found.joints[0].score == pytest.approx(long.joints[0].score - 0.25, abs=0.04)


@pytest.mark.parametrize(("depth", "kind"), [(25.0, "prismatic"), (2.0, "weld")])
def test_spigots_on_two_lines_do_not_guide(depth: float, kind: str) -> None:
    """A part slides on two pins unless they are in it by less than half of their radius: spigots of a cover."""
    pins, cover = plate(), box(80, 60, 30).at(0, 0, 16)
    for x in (-20, 20):
        pins += cylinder(10, depth + 1).at(x, 0, 0)
        cover -= cylinder(10.02, 30).at(x, 0, 0)
    assert strongest(evidence(group("a", part("plate", pins)), group("b", part("cover", cover)))) == kind


def test_tyre_is_one_wheel_with_a_rim_with_two_spokes() -> None:
    """Spokes in one line make the inertia of a rim uneven about its axis; that of its tyre is even."""
    rim = cylinder(40, 20) - cylinder(33, 20) + box(70, 6, 20).at(0, 0, 10)
    tyre = cylinder(42, 20) - cylinder(40, 20)
    found = evidence(part("wheel", rim), part("tyre", tyre))
    assert strongest(found) == "weld"
    assert not found.joints


@pytest.mark.parametrize(("width", "count"), [(24.0, 2), (70.0, 0)])
def test_a_tyre_with_play_does_not_turn_on_its_rim(width: float, count: int) -> None:
    """What the assembly rolls on, as wide as what it is around, is fixed to it; not a roll that is far wider."""
    chassis, nodes = box(240, 60, 30), []
    tyre = cylinder(60, width).at(0, 0, -width / 2) - cylinder(40.2, width).at(0, 0, -width / 2)
    rim = cylinder(40, 20).at(0, 0, -10) - cylinder(14, 20).at(0, 0, -10)
    rings = [cylinder(r, 8).at(0, 0, -4) - cylinder(hole, 8).at(0, 0, -4) for r, hole in ((8.4, 6), (14, 11.6))]
    for x in (-90, 90):
        chassis += turned(cylinder(6, 60), x, -30, 0, (pi / 2, 0, 0))
        nodes += [part(f"{n} {x}", one, x, -80, 0, (pi / 2, 0, 0)) for n, one in enumerate((rim, tyre, *rings))]
    found = Evidence()
    wheel_evidence(Survey(assembled(part("body", chassis), *nodes), ALL_SOURCES), [], found)
    assert [weld.why for weld in found.welds] == ["a tyre on its rim"] * count


def test_two_axes_between_subassemblies_are_no_joint() -> None:
    """Two parallel pins, each in a bore of the other subassembly, turn about neither."""
    pins = [part(f"pin {x}", cylinder(5, 30), x=x) for x in (-25.0, 25.0)]
    arms = [
        part(f"eye {x}", box(20, 20, 20).at(0, 0, 20) - cylinder(5.02, 20).at(0, 0, 10), x=x) for x in (-25.0, 25.0)
    ]
    found = evidence(group("a", part("plate", plate()), *pins), group("b", *arms, part("bar", box(80, 20, 8), z=34)))
    across = [h for h in found.joints if {h.a, h.b} & {7, 8} and {h.a, h.b} & {3, 4}]
    assert across
    assert all(h.score <= 0.45 for h in across)


def test_pin_in_an_arm_that_lies_on_a_plate_is_marked() -> None:
    """An arm on a pin that also lies on the pin's plate, off-centre, may turn; the score asks for a review."""
    arm = box(120, 40, 25).at(40, 0, 12.5) - cylinder(10.02, 25)
    found = evidence(group("a", part("pin", PIN)), group("b", part("arm", arm)))
    assert strongest(found) == "revolute"
    assert 0.5 < found.ranked()[0].score < 0.8


def test_shaft_as_thick_as_its_bore_is_fixed_where_others_have_play() -> None:
    """A shaft without play turns in its bore if no pin of the assembly has any, else it is pressed in."""
    tight = [
        part("shaft", cylinder(10, 60)),
        part("lever", box(80, 60, 25).at(0, 0, 30) - cylinder(10, 25).at(0, 0, 17.5)),
    ]
    loose = [part("pin", PIN, x=500), part("arm", BORED, x=500)]
    assert strongest(evidence(*tight)) == "revolute"
    found = evidence(*tight, *loose)
    best = {frozenset((e.a, e.b)): e for e in reversed(found.ranked())}
    assert best[frozenset((1, 2))] in found.welds
    assert best[frozenset((3, 4))] in found.joints


@pytest.mark.parametrize("has_strap", [True, False])
def test_a_strap_clamps_what_lies_in_a_cradle(has_strap: bool) -> None:
    """A round case between a cradle and a strap of its own radius does not turn; without a strap it may."""
    case = turned(cylinder(20, 80), -40, 0, 0, (0, pi / 2, 0)) + box(10, 8, 8).at(45, 12, 0)
    bore = turned(cylinder(20, 30), -15, 0, 0, (0, pi / 2, 0))
    cradle, strap = cut(box(30, 60, 30).at(0, 0, -15), bore), cut(box(30, 60, 30).at(0, 0, 15), bore)
    nodes = [part("cradle", cradle), part("case", case), *([part("strap", strap)] if has_strap else [])]
    assert len(joints(inferred(*nodes, sources=BARE))) == (0 if has_strap else 1)


@pytest.mark.parametrize("size", [0.5, 1.0, 4.0])
def test_a_rim_on_its_hub_turns_with_it_on_the_axle(size: float) -> None:
    """Of two fits on one line the one with play turns: a rim as wide as its hub is fixed to it."""
    s = size
    axle = box(60 * s, 60 * s, 60 * s).at(0, 0, -30 * s) + cylinder(7.5 * s, 50 * s)
    hub = cylinder(30 * s, 34 * s) - cylinder(7.6 * s, 34 * s)
    rim = cylinder(60 * s, 8 * s) - cylinder(30 * s, 8 * s)
    found = inferred(part("a", axle), part("b", hub, z=10 * s), part("c", rim, z=25 * s))
    assert joints(found) == [("revolute", "a", "b")]
    assert found.links == [[1], [2, 3]]


def test_an_axle_is_no_ring_of_its_wheel() -> None:
    """What is named after a wheel, but an axle, is what the wheel turns on."""
    arm = box(60, 14, 5).at(-20, 0, 2.5) - cylinder(1.6, 5)
    wheel = cylinder(20, 14).at(0, 0, 6) - cylinder(1.65, 14).at(0, 0, 6)
    axle = cylinder(1.6, 22) + cylinder(3, 2.5).at(0, 0, 22)
    found = inferred(part("arm", arm), part("road wheel", wheel), part("wheel axle", axle))
    assert joints(found) == [("revolute", "arm", "road wheel")]


@pytest.mark.parametrize(("screws", "play", "count"), [(2, 0.0, 1), (1, 0.0, 2), (2, 0.4, 1), (2, -0.5, 1)])
def test_two_screws_through_a_gap_hold_two_plates(screws: int, play: float, count: int) -> None:
    """Plates on two screws with spacers between them are one link, though they do not touch; also in tapped holes."""
    holes = [(-20.0, 0.0), (20.0, 0.0)][:screws]
    screw = cylinder(3 - play, 40).at(0, 0, -10) + cylinder(5, 6).at(0, 0, 30)
    spacer = cylinder(5, 20) - cylinder(3.1, 20)
    nodes = [part("lower", plate(*holes)), part("upper", plate(*holes).at(0, 0, 30))]
    for x, y in holes:
        nodes += [part("M6x40 screw", screw, x, y), part("spacer", spacer, x, y)]
    survey, found = Survey(assembled(*nodes), ALL_SOURCES), Evidence()
    screwed_evidence(survey, found)
    assert len(found.welds) == 2 - count


@pytest.mark.parametrize("screws", [0, 2])
def test_screws_in_tapped_holes_hold_a_case_in_its_bore(screws: int) -> None:
    """The flange of a case is on the block that it is screwed to, with screws drawn wider than their tapped holes."""
    block = box(80, 80, 40).at(0, 0, 20) - cylinder(20, 40)
    case = cylinder(20, 40) + cylinder(32, 4).at(0, 0, 40) + box(10, 10, 20).at(5, 0, 54)
    nodes = []
    for x in (-26.0, 26.0)[:screws]:
        block, case = block - cylinder(2.5, 20).at(x, 0, 20), case - cylinder(3.3, 4).at(x, 0, 40)
        nodes.append(part("M6x16 screw", cylinder(3, 16).at(0, 0, 28) + cylinder(5, 6).at(0, 0, 44), x))
    found = inferred(part("block", block), part("case", case), *nodes)
    assert len(joints(found)) == (0 if screws else 1)


def test_tube_in_a_tube_slides() -> None:
    """A tube with play in another one, over two diameters, slides; it may turn, too."""
    outer = cylinder(25, 300) - cylinder(22, 300)
    inner = cylinder(21.75, 300) - cylinder(19, 300)
    head = group("head", part("inner", inner, z=150), part("plate", box(120, 40, 5), z=452.5))
    found = inferred(group("foot", part("outer", outer), part("base", box(200, 200, 5), z=-2.5)), head)
    assert [(kind, arc.evidence.review) for (kind, *_), arc in zip(joints(found), found.arcs, strict=True)] == [
        ("prismatic", "a round tube in another one: it may turn, too")
    ]


def test_a_shaft_with_a_flat_and_no_play_is_fixed_in_its_bore() -> None:
    """A D shaft in a coupling turns it and does not slide; with play, it may."""
    for play in (0.0, 0.05):
        shaft = cylinder(3, 40) - box(6, 2, 20).at(0, 3, 30)
        bore = cylinder(3 + play, 20) - box(7, 2, 20).at(0, 3 + play, 10)
        hub = box(30, 30, 20).at(0, 0, 30) - bore.at(0, 0, 20)
        assert (strongest(evidence(part("shaft", shaft), part("hub", hub))) == "weld") == (not play)


@pytest.mark.parametrize(("radius", "lug"), [(5.0, False), (5.0, True), (4.95, False)])
def test_a_round_foot_as_thick_as_its_hole_is_to_be_reviewed(radius: float, lug: bool) -> None:
    """It is pressed or screwed in as likely as it turns; not so with play, or if it shows how far it has turned."""
    plate = box(200, 200, 10) - cylinder(5, 10).at(40, 40, -5)
    foot = cylinder(radius, 6).at(0, 0, -5) + cylinder(20, 30).at(0, 0, -35)
    foot = foot + box(60, 10, 10).at(20, 0, -20) if lug else foot
    found = inferred(part("plate", plate), part("foot", foot, 40, 40), sources=BARE)
    assert joints(found) == [("revolute", "foot", "plate")]
    (arc,) = found.arcs
    assert arc.evidence.review.startswith("round, and as thick") == (radius == 5.0 and not lug)
