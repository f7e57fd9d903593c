"""Outputs of motors: the axis of a horn, and unnamed parts that turn on a case."""

import numpy as np
import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.evidence.evidence import Evidence
from stepbot.draft.evidence.motor_outputs import OutputAxes, hidden_outputs
from stepbot.draft.evidence.motors import Motor
from stepbot.draft.evidence.near_outputs import NearOutput
from stepbot.draft.parts.axis import Axis
from tests.assembled import Node, assembled, group, inferred, joints, links, part
from tests.made.kit import drilled
from tests.solids import box, cylinder

LID, FRONT = box(40, 20, 4), box(40, 20, 20)
"""Front half and lid of a case."""


def survey(*more: Node) -> Survey:
    """A case of two halves, its front above z = 0 [mm], its lid below, and other parts; the case is part 1."""
    return Survey(assembled(part("front", FRONT, z=10), part("lid", LID, z=-2), *more), ALL_SOURCES)


def test_discs_on_either_half_are_outputs() -> None:
    """A disc on the front and one on the lid, each with an arm on it, are horn and idler."""
    arms = part("arm", box(80, 10, 3), 40, 0, 24.5), part("arm", box(80, 10, 3), 40, 0, -8.5)
    found = survey(part("disc", cylinder(8, 3), 10, 0, 20), part("disc 2", cylinder(7, 3), 10, 0, -7), *arms)
    assert hidden_outputs(found, Motor("servo", (1, 2, 3, 4), 1)) == [3, 4]


def test_plates_and_covers_are_no_outputs() -> None:
    """A square plate on the case is not turned, and a tiny disc that carries nothing is a cover of a screw."""
    found = survey(part("plate", box(12, 12, 3), 10, 0, 21.5), part("cover", cylinder(1, 0.5), -10, 0, 20))
    assert hidden_outputs(found, Motor("servo", (1, 2, 3, 4), 1)) == []


def test_axis_is_that_of_the_horn() -> None:
    """The output axis goes through the horn, and reaches as far as its contact."""
    found = survey(part("disc", cylinder(8, 3), 10, 0, 20))
    motor = Motor("servo", (1, 2, 3), 1, outputs=(3,))
    output = OutputAxes(found, [motor]).of(motor, motor.outputs)
    assert output is not None
    assert output.axis.distance(found.parts[3].com) < 1e-9
    assert abs(output.reach - 8e-3) < 1e-9


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("way", [-1.0, 1.0])
@pytest.mark.parametrize(("gap", "turns"), [(3.9, True), (4.1, False)])
def test_what_is_next_to_an_end_of_the_output_turns(gap: float, turns: bool, way: float, side: int) -> None:
    """A hub up to 4 mm from either end of the output, whichever way its axis is taken; of two the nearer one."""
    servo = cylinder(3, 30).at(0, 0, -15) + box(10, 40, 8).at(0, 20, 0)
    hubs = [part(name, cylinder(8, 6).at(0, 0, -3), z=side * (18 + off)) for name, off in (("far", 9), ("near", gap))]
    found = Survey(assembled(part("servo", servo), *hubs), ALL_SOURCES)
    axis, evidence = Axis(np.zeros(3), np.array([0.0, 0.0, way])), Evidence()
    hinge = NearOutput(found, Motor("servo", (1,), 1), axis, (1,), evidence).hinge(set())
    assert (hinge is not None) is turns
    assert [(one.a, one.b) for one in evidence.welds] == [(1, 3)] * turns


def test_what_is_on_the_shaft_of_a_servo_that_nothing_holds_turns() -> None:
    """A servo drawn half a millimetre above its base goes with the base; the lever on its thin shaft turns."""
    servo = box(23, 12, 22).at(-5.5, 0, 11) + cylinder(2.3, 3).at(0, 0, 22)
    lever = box(30, 6, 3).at(12, 0, 23.5) - cylinder(2.3, 3).at(0, 0, 22)
    found = inferred(part("base", box(100, 60, 5), z=-3), part("servo SG90", servo), part("lever", lever))
    assert joints(found) == [("revolute", "base", "lever")]
    assert links(found) == [{"base", "servo SG90"}, {"lever"}]
    assert "nothing else touches the motor" in found.arcs[0].evidence.review


def test_a_horn_in_a_bore_is_fastened_to_what_it_turns() -> None:
    """The horn of a servo, sunk with play in a leg that carries a foot, turns on the servo and not in the leg."""
    servo = box(23, 12, 22).at(-5.5, 0, 11) + cylinder(2.3, 3).at(0, 0, 22)
    horn = cylinder(3.5, 3.2).at(0, 0, 23.5) + box(30, 4, 1.5).at(0, 0, 26) - cylinder(2.3, 2).at(0, 0, 23.5)
    pocket = cylinder(3.6, 4).at(0, 0, 24.8) + box(30.4, 4.4, 2).at(0, 0, 26)
    leg = box(80, 16, 5).at(24, 0, 27.3) - pocket - cylinder(3, 6).at(48, 0, 24)
    foot = cylinder(2.95, 35).at(48, 0, -5) + box(20, 40, 4).at(48, 0, -5)
    found = inferred(
        *(part("base", box(100, 60, 5).at(-20, 0, -2.5)), part("servo SG90", servo)),
        *(part("horn", horn), part("leg", leg), part("foot", foot)),
    )
    assert {"horn", "leg"} in links(found)
    assert joints(found) == [("revolute", "base", "leg"), ("revolute", "foot", "leg")]
    assert "turns about the same axis as the motor" in found.guesses[3]


def test_a_case_between_horn_and_idler_turns() -> None:
    """A servo that touches only two discs at both ends of its axis, each bolted to a plate of one fork, turns in it."""
    case, ring = box(24, 36, 24).at(0, -9, 0), [(6, 0, 2), (-6, 0, 2), (0, 6, 2), (0, -6, 2)]
    horn, idler = (drilled(cylinder(r, 2), *ring, depth=8) for r in (9, 10))
    plate = drilled(box(18, 80, 2).at(0, 31, 0), *ring, depth=8)
    nodes = [part("horn", horn, z=12), part("idler", idler, z=-14), part("servo", case)]
    nodes += [part("left", plate, z=15), part("right", plate, z=-15), part("yoke", box(18, 10, 28), 0, 66)]
    found = inferred(*nodes)
    assert {"servo"} in links(found)
    assert {"horn", "idler", "left", "right", "yoke"} in links(found)


def test_horns_in_the_holes_of_a_board_are_of_the_board() -> None:
    """Two legs hang on their servos, whose horns are in wider holes of one board: a joint each, on the servo's case."""
    servo = box(23, 12, 22).at(-5.5, 0, -11) + cylinder(2.3, 3)
    horn = cylinder(3.3, 4).at(0, 0, 1) + box(30, 4, 1).at(0, 0, 5) - cylinder(2.3, 2).at(0, 0, 1)
    nodes = [part("board", drilled(box(100, 60, 1).at(20, 0, 3.5), (0, 0, 3.2), (60, 0, 3.2)))]
    for n, x in enumerate((0, 60)):
        nodes += [part(f"servo SG90 {n}", servo, x), part(f"horn {n}", horn, x)]
        nodes += [part(f"leg {n}", box(23, 12, 40), x, z=-42)]
    found = inferred(*nodes)
    assert joints(found) == [("revolute", "board", "leg 0"), ("revolute", "board", "leg 1")]
    assert {found.survey.parts[arc.evidence.a].path for arc in found.arcs} == {"servo SG90 0", "servo SG90 1"}


def test_a_pen_in_the_bore_of_the_last_link_is_none() -> None:
    """A rod of 6 % of all volume, in the bore of a lever, would only spin."""
    servo = box(23, 12, 22).at(-5.5, 0, 11) + cylinder(2.3, 3).at(0, 0, 22)
    lever = box(50, 14, 5).at(20, 0, 24.5) - cylinder(2.3, 3).at(0, 0, 22) - cylinder(3, 5).at(38, 0, 22)
    nodes = [part("base", box(60, 40, 5), z=-2.5), part("servo SG90", servo), part("lever", lever)]
    found = inferred(*nodes, part("pen", cylinder(3, 50), 38))
    assert links(found) == [{"base", "servo SG90"}, {"lever", "pen"}]


def test_what_holds_the_flange_of_a_motor_does_not_turn() -> None:
    """A plate around the wide spigot of a motor that nothing else touches is no output."""
    motor = box(42, 42, 40).at(0, 0, -20) + cylinder(11, 2)
    plate = box(100, 60, 2).at(20, 0, 1) - cylinder(11, 2)
    found = inferred(part("base", box(200, 60, 5), z=-60), part("motor NEMA17", motor), part("plate", plate))
    assert joints(found) == []


def test_a_plate_under_the_teeth_of_a_pinion_is_not_on_it() -> None:
    """A pinion on a motor reaches over the plate that its wheel is on: the plate does not turn with it."""
    motor = box(42, 42, 40).at(0, 0, -20) + cylinder(11, 2) + cylinder(2.5, 24)
    for x, y in ((15.5, 15.5), (15.5, -15.5), (-15.5, 15.5), (-15.5, -15.5)):
        motor = motor - cylinder(1.5, 5).at(x, y, -5)
    base = box(300, 80, 5).at(60, 0, 2.5) - cylinder(11.1, 5)
    for x, y in ((15.5, 15.5), (15.5, -15.5), (-15.5, 15.5), (-15.5, -15.5)):
        base = base - cylinder(1.6, 5).at(x, y, 0)
    base = base - cylinder(20.1, 5).at(94, 0, 0)
    table = cylinder(78, 4).at(94, 0, 8) + cylinder(20, 8).at(94, 0, 0) + box(60, 10, 60).at(94, 0, 42)
    pinion = cylinder(20, 8).at(0, 0, 12) - cylinder(2.5, 8).at(0, 0, 12)
    tree = group("base unit", part("base", base), part("Nema 17 motor", motor), part("motor pinion", pinion))
    found = inferred(tree, group("table unit", part("table", table)))
    assert not any("table unit/table" in link and "base unit/motor pinion" in link for link in links(found))


def test_a_horn_by_name_turns_and_screws_in_the_ears_of_a_servo_do_not() -> None:
    """Screws without a name are in the case and in the plate below it; the horn shares only the line of a bore."""
    case = box(23, 12, 22).at(-5.5, 0, -11) + box(33, 12, 2.5).at(-5.5, 0, -6) - cylinder(2.4, 3).at(0, 0, -3)
    plate = box(80, 40, 4).at(-5.5, 0, -9.25) - box(23.2, 12.2, 4).at(-5.5, 0, -9.25)
    for x in (-19.5, 8.5):
        case, plate = case - cylinder(1, 2.5).at(x, 0, -7.25), plate - cylinder(1, 4).at(x, 0, -11.25)
    horn = box(40, 6, 2).at(0, 0, 4) - cylinder(2.4, 2).at(0, 0, 3)
    bodies = [Node("case", case.shape), Node("shaft", cylinder(2.2, 6).at(0, 0, -2).shape)]
    screw = cylinder(1, 10).at(0, 0, -14.75) + cylinder(1.9, 1.5).at(0, 0, -4.75)
    screws = [part(f"x {x}", screw, x) for x in (-19.5, 8.5)]
    found = inferred(part("plate", plate), Node("SG90", children=bodies, has_bodies=True), *screws, part("Horn", horn))
    assert joints(found) == [("revolute", "Horn", "plate")]
    x, y, _ = found.arcs[0].evidence.axis.point
    assert max(abs(x), abs(y)) < 1e-9
