"""Joints at named bearings: what is in the bore turns in what is around the ring."""

from math import cos, pi, sin

import pytest

from stepbot.robot.model import JointKind
from tests.assembled import Node, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder

RING = cylinder(11, 7) - cylinder(4, 7)
SEAT = box(200, 40, 7).at(80, 0, 3.5) - cylinder(11, 7)


BALLS = RING - cylinder(2.4, 4).at(7.5, 0, 2) - cylinder(2.4, 4).at(2.3, 7.1, 2) - cylinder(2.4, 4).at(-6.1, 4.4, 2)
"""The ring as bought in, with balls in a cage on one side: its centre of mass is off the axis."""


def nodes(axle_radius: float, ring: Solid = RING) -> list[Node]:
    """An arm with a bearing in its seat, and a base with an axle through the bearing."""
    axle = cylinder(axle_radius, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35)
    return [group("base", part("axle", axle)), group("swing", part("arm", SEAT), part("ball bearing", ring))]


def test_axle_turns_in_the_seat() -> None:
    """The joint is between the axle and the seat, about the bearing's axis; the bearing goes with its seat."""
    found = inferred(*nodes(4))
    assert joints(found) == [("revolute", "base/axle", "swing/arm")]
    assert links(found) == [{"base/axle"}, {"swing/arm", "swing/ball bearing"}]
    assert found.arcs[0].evidence.by_role
    assert found.arcs[0].evidence.axis.distance(found.survey.parts[5].com) < 1e-9
    assert found.arcs[0].evidence.through == 5


@pytest.mark.parametrize("gap", [0.3, 0.0])
def test_ring_that_alone_is_between_a_shaft_and_a_bore_is_a_bearing(gap: float) -> None:
    """What stands on the output of a module turns with it, with a mark; an output that fits its case turns nowhere."""
    case = box(60, 60, 24).at(0, 0, 12) - cylinder(24, 14).at(0, 0, 6) - cylinder(15.13 + gap, 4).at(0, 0, 20)
    case -= cylinder(20, 6)
    output = cylinder(15.13, 19).at(0, 0, 6) + cylinder(28, 6).at(0, 0, 25)
    module = group("m", part("a", case), part("b", output), part("c", cylinder(24, 14) - cylinder(15.13, 14), z=6))
    found = inferred(module, part("arm", box(50, 50, 90).at(0, 0, 76)))
    turning = [arc.evidence for arc in found.arcs if arc.evidence.through >= 0]
    assert [bool(hinge.review) for hinge in turning] == [True] * bool(gap)
    assert ({"m/b", "arm"} in links(found)) == bool(gap)


def test_two_rods_in_linear_bearings_are_one_slide() -> None:
    """A carriage with two LM8UU on the rods of a frame slides, with a mark; the list of bearings is no link."""
    bush = cylinder(7.5, 24).at(0, 0, -12) - cylinder(4, 24).at(0, 0, -12)
    carriage, frame = box(80, 30, 24), box(80, 40, 20).at(0, 0, -100)
    for x in (-25, 25):
        carriage -= cylinder(7.5, 24).at(x, 0, -12)
        frame += cylinder(4, 190).at(x, 0, -95)
    frame += box(80, 40, 20).at(0, 0, 100)
    bushes = group("bought", *(part("LM8UU", bush, x) for x in (-25, 25)))
    found = inferred(part("frame", frame), part("carriage", carriage), bushes)
    assert [(arc.evidence.type, bool(arc.evidence.review)) for arc in found.arcs] == [(JointKind.PRISMATIC, True)]
    assert {"carriage", "bought/LM8UU"} in links(found)


def test_a_bearing_with_drawn_balls_is_one() -> None:
    """What is named a bearing need not be symmetric: balls and cages are not."""
    found = inferred(*nodes(4, BALLS))
    assert not found.survey.parts[5].is_balanced(found.arcs[0].evidence.axis)
    assert joints(found) == [("revolute", "base/axle", "swing/arm")]
    assert found.arcs[0].evidence.through == 5


def test_bearing_without_an_axle_gives_no_joint() -> None:
    """An axle much thinner than the bore does not turn in it."""
    assert not [arc for arc in inferred(*nodes(2)).arcs if arc.evidence.by_role]


def test_bearing_screwed_on_by_its_bore_turns_what_the_screw_holds() -> None:
    """A plate on a screw through the bearing's bore turns in the bearing's seat."""
    screw = part("M8x30 screw", cylinder(4, 30).at(0, 0, -20) + cylinder(6.5, 8).at(0, 0, 10))
    lever = part("lever", box(120, 20, 10).at(-40, 0, -5) - cylinder(4, 10).at(0, 0, -10))
    found = inferred(group("swing", part("arm", SEAT), part("ball bearing", RING)), group("link", lever), screw)
    assert [arc.evidence.type for arc in found.arcs] == [JointKind.REVOLUTE]
    assert {"swing/arm", "swing/ball bearing"} in links(found)


@pytest.mark.parametrize(("radius", "beside"), [(6, 0.0), (2, 7.5)])
def test_what_stands_on_a_bearing_turns_in_it_if_it_is_on_its_axis(radius: float, beside: float) -> None:
    """A foot on the face of a bearing in its seat turns about the bearing's axis only if that is its own."""
    post = cylinder(radius, 30).at(beside, 0, 7) + box(60, 60, 10).at(0, 0, 42)
    found = inferred(group("swing", part("arm", SEAT), part("ball bearing", RING)), part("post", post))
    assert [arc.evidence.through == 3 for arc in found.arcs] == [not beside]


def holed(solid: Solid, away: float, radius: float, turn: float) -> Solid:
    """A solid above z = 0 with six holes in a circle."""
    for k in range(6):
        angle = turn + k * pi / 3
        solid -= cylinder(radius, 14).at(away * cos(angle), away * sin(angle), 0)
    return solid


@pytest.mark.parametrize("gap", [0.3, 1.2])
def test_rings_across_a_gap_turn_if_each_is_bolted_to_a_part(gap: float) -> None:
    """A slewing ring: the outer one on a base, the inner one, between which balls run, below a table."""
    outer = holed(cylinder(66, 14) - cylinder(52, 14), 60, 2.5, 0.0)
    inner = holed(cylinder(52 - gap, 14) - cylinder(36, 14), 43, 2.1, 0.5)
    table = holed(box(150, 150, 14).at(0, 0, 7), 43, 2.2, 0.5)
    nodes = [part("plate", holed(box(160, 160, 14).at(0, 0, 7), 60, 2.7, 0.0), z=-14), part("table", table, z=15)]
    found = inferred(*nodes, group("ring", part("a", outer), part("b", inner, z=1)))
    assert joints(found) == [("revolute", "plate", "table")]
    assert {frozenset(link) for link in links(found)} == {
        frozenset({"plate", "ring/a"}),
        frozenset({"table", "ring/b"}),
    }


def test_rings_of_one_bearing_turn_on_each_other() -> None:
    """Rings drawn as two parts of what is named a bearing, a shaft in one and a seat around the other, are no link."""
    rings = [part("in", cylinder(5.6, 7) - cylinder(4, 7)), part("out", cylinder(11, 7) - cylinder(9.3, 7))]
    shaft = cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35)
    found = inferred(part("stand", shaft), part("arm", SEAT), group("608ZZ", *rings))
    assert joints(found) == [("revolute", "arm", "stand")]
    assert {frozenset(link) for link in links(found)} == {
        frozenset({"stand", "608ZZ/in"}),
        frozenset({"arm", "608ZZ/out"}),
    }


def test_a_ring_outside_of_a_bearing_is_no_ring_of_it() -> None:
    """A ring in what is named a bearing turns in one elsewhere only by its width and seat."""
    rings = [part("in", cylinder(5.6, 7) - cylinder(4, 7)), part("out", cylinder(11, 7) - cylinder(9.3, 7))]
    shaft = cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35)
    found = inferred(part("stand", shaft), part("arm", SEAT), group("608ZZ", rings[0]), group("tube", rings[1]))
    assert [arc.evidence.why for arc in found.arcs] == ["rings of one width, each in a seat of its own"]


@pytest.mark.parametrize("outer_width", [7.0, 4.0])
def test_rings_of_one_width_in_seats_of_their_own_turn(outer_width: float) -> None:
    """Rings that no name or tree shows to be a bearing turn, marked, if they are equally wide."""
    rings = [part("a", cylinder(5.6, 7) - cylinder(4, 7)), part("b", cylinder(11, outer_width) - cylinder(9.3, 7))]
    shaft = cylinder(4, 60).at(0, 0, -30) + box(80, 80, 10).at(0, 0, -35)
    found = inferred(part("c", shaft), part("d", SEAT), *rings)
    assert any(arc.evidence.by_role and arc.evidence.review for arc in found.arcs) == (outer_width == 7.0)


def test_rods_in_holders_of_their_own_do_not_turn() -> None:
    """Rods that are parts, fixed in a can, carry what has linear bearings on them: one slide."""
    bush = cylinder(10.5, 30).at(0, 0, -15) - cylinder(6, 30).at(0, 0, -15)
    carriage, can = box(150, 50, 30), box(180, 60, 25).at(0, 0, -100)
    nodes = []
    for x in (-60, 60):
        carriage -= cylinder(10.5, 30).at(x, 0, -15)
        can -= cylinder(6, 25).at(x, 0, -112.5)
        nodes += [part("shaft", cylinder(6, 200), x, z=-112.5), part("LM12UU", bush, x)]
    found = inferred(part("can", can), part("carriage", carriage), *nodes)
    assert joints(found) == [("prismatic", "can", "carriage")]


@pytest.mark.parametrize(("collar", "kind"), [(0, "prismatic"), (8, "revolute")])
def test_rod_that_reaches_far_out_of_a_plain_bearing_slides(collar: float, kind: str) -> None:
    """A long smooth rod with nothing to hold it along its bushing slides, to be reviewed; one with a collar turns."""
    bush = cylinder(6, 22).at(0, 0, -11) - cylinder(4.05, 22).at(0, 0, -11)
    arm = box(80, 30, 22).at(30, 0, 0) - cylinder(6, 22).at(0, 0, -11)
    stick = cylinder(4, 140).at(0, 0, -70) + box(30, 12, 6).at(6, 0, -70)
    if collar:
        stick = stick + (cylinder(collar, 4) - cylinder(4, 4)).at(0, 0, 11)
    found = inferred(group("arm", part("plate", arm), part("plain bushing", bush)), group("tool", part("stick", stick)))
    assert joints(found) == [(kind, "arm/plate", "tool/stick")]
    assert kind != "prismatic" or found.arcs[0].evidence.review.endswith("it may turn, too")


def test_what_a_shaft_in_bearings_ends_in_turns_with_it() -> None:
    """Cranks on the ends of a spindle with exact fits are one body, which turns in the bearings between them."""
    shell = box(30, 200, 30) - turned(cylinder(11, 200), 0, 100, 0, (pi / 2, 0, 0))
    rings = [part(f"bearing {n}", turned(RING, 0, y, 0, (pi / 2, 0, 0))) for n, y in enumerate((-80.0, 87.0))]
    spindle = part("spindle", turned(cylinder(4, 250), 0, 125, 0, (pi / 2, 0, 0)))
    eye = turned(cylinder(4, 15), 0, 7.5, 0, (pi / 2, 0, 0))
    crank = box(90, 15, 20).at(35, 0, 0) - eye
    nodes = part("left crank", crank, 0, 117.5), part("right crank", crank, 0, -117.5, rpy=(0, pi, 0))
    found = inferred(part("shell", shell), *rings, spindle, *nodes)
    assert {"spindle", "left crank", "right crank"} in links(found)
    assert [kind for kind, *_ in joints(found)] == ["revolute"]


@pytest.mark.parametrize(("hole", "is_its_own"), [(1.7, True), (2.2, False)])
def test_what_a_screw_in_a_bearing_goes_through_turns_in_the_seat(hole: float, *, is_its_own: bool) -> None:
    """An M3 in a ring's bore and, 10 mm away, in the clearance hole of an arm; a wider hole is not its own."""
    lever = box(60, 10, 3).at(25, 0, 1.5) - cylinder(3, 3)
    arm = box(60, 10, 4).at(-25, 0, 2) - cylinder(hole, 4)
    ring, screw = cylinder(3, 2.5) - cylinder(1.5, 2.5), cylinder(1.5, 18) + cylinder(2.75, 3).at(0, 0, 18)
    nodes = [part("arm", arm, z=-14), part("lever", lever), part("MR63ZZ", ring, z=0.25), part("M3x18", screw, z=-14)]
    assert (
        any(h.through == 3 and {h.a, h.b} == {1, 2} for arc in inferred(*nodes).arcs for h in [arc.evidence])
        == is_its_own
    )


def rollers(count: int, hole: float) -> list[Node]:
    """A plate with pins in its holes, and on each pin a roller with a bearing in each of its ends."""
    plate, nodes = box(300 + 40 * count, 150, 10).at(20 * count - 20, 0, -6), list[Node]()
    roller = cylinder(10, 20) - cylinder(6.5, 5) - cylinder(6.5, 5).at(0, 0, 15) - cylinder(3, 20)
    ring = cylinder(6.5, 5) - cylinder(2, 5)
    for x in (40.0 * n for n in range(count)):
        plate -= cylinder(hole, 10).at(x, 0, -11)
        rings = [part(f"624zz {n} {x:.0f}", ring, x, z=z) for n, z in enumerate((0, 15))]
        nodes += [part(f"drum {x:.0f}", roller, x), *rings, part(f"pin {x:.0f}", cylinder(2, 31).at(0, 0, -11), x)]
    return [part("plate", plate), *nodes]


@pytest.mark.parametrize("hole", [2.0, 2.2, 2.3])
def test_rollers_on_two_bearings_turn_about_their_pins(hole: float) -> None:
    """Each is a link, however small, also if the plate has the clearance of a bolt's hole around the pins."""
    found = inferred(*rollers(2, hole))
    assert joints(found) == [("revolute", "drum 0", "plate"), ("revolute", "drum 40", "plate")]
