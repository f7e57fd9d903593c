"""Motors by name and by use: which parts are motors, what belongs to them, which axis is their output."""

from itertools import product
from math import cos, pi, sin

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.evidence.motor_outputs import apart_outputs
from stepbot.draft.evidence.motors import Motor, find_motors
from stepbot.draft.link_claims import LinkClaims
from stepbot.geometry.spatial import Pose
from tests.assembled import BARE, Node, assembled, cut, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder, joined

NAMELESS = Sources(names=False)
CORNERS = list(product((-16, 16), (-7, 7)))


def case() -> Solid:
    """A block with a bore for a screw in each corner of its top, which is at z = 0 [mm]."""
    block = box(40, 20, 30).at(0, 0, -15)
    for x, y in CORNERS:
        block -= cylinder(1.5, 8).at(x, y, -8)
    return block


CASE, HORN, SCREW = case(), cylinder(8, 3), cylinder(1.5, 8)
ARM, PLATE, BASE = box(100, 12, 4), box(40, 60, 5), box(400, 80, 10)


def servo(name: str, x: float, y: float, *, horn: bool = True) -> Node:
    """A servo of a case, a horn at (10, 0) and four plain screws, its top at z = 0."""
    screws = [part(f"s{n}", SCREW, x + u, y + v, -8) for n, (u, v) in enumerate(CORNERS)]
    horns = [part("disc", HORN, x + 10, y, 0)] if horn else []
    return group(name, part("block", CASE, x, y), *horns, *screws)


def two_servos(*, horn: bool = True, names: tuple[str, str] = ("a", "b")) -> list[Node]:
    """A plate below each of two servos, on one base, and an arm on each horn."""
    nodes = [part("base", box(400, 80, 10), z=-40)]
    for side, name, x in zip("ab", names, (-100.0, 100.0), strict=True):
        nodes += [part(f"plate {side}", PLATE, x, 0, -32.5), servo(name, x, 0, horn=horn)]
        if horn:
            nodes.append(part(f"arm {side}", ARM, x + 50, 0, 5))
    return nodes


def motors(nodes: list[Node], sources: Sources = ALL_SOURCES) -> list[Motor]:
    """The motors of an assembly."""
    return find_motors(Survey(assembled(*nodes), sources))


def test_equal_blocks_that_turn_something_are_motors() -> None:
    """Two equal cases, each held below and with a disc on one axis, are motors, without any name."""
    assert [motor.is_named for motor in motors(two_servos(), BARE)] == [False, False]


def test_equal_frames_that_turn_something_are_no_motors(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hollow frame of the same outside, held and with a disc alike, has no room for a motor."""
    monkeypatch.setattr("tests.unit.draft.test_motors.CASE", case() - box(34, 40, 24).at(-2, 0, -15))
    assert motors(two_servos(), BARE) == []


def test_equal_trifles_that_turn_something_are_no_motors() -> None:
    """Blocks of less than half a percent of the whole drive nothing."""
    assert motors([*two_servos(), part("table", box(600, 600, 100), z=-95)], BARE) == []


def test_screws_in_a_pattern_are_no_outputs() -> None:
    """Equal cases on which nothing but four equal screws turns are covers, not motors."""
    assert motors(two_servos(horn=False), BARE) == []


def test_motor_by_use_is_its_subassembly() -> None:
    """With the tree, the case's subassembly is the motor: case, horn and screws."""
    found = motors(two_servos(), NAMELESS)
    assert [len(motor.parts) for motor in found] == [6, 6]


@pytest.mark.parametrize(("length", "count"), [(60, 7), (110, 1)])
def test_a_subassembly_much_larger_than_the_case_is_more_than_a_motor(length: float, count: int) -> None:
    """A strip on the case, of one subassembly with the servo, is of the motor if it is hardly larger than the case."""
    base, *others = two_servos()
    strips = {"a": part("strip", box(length, 4, 2), -100, -8, 1), "b": part("strip", box(length, 4, 2), 100, -8, 1)}
    nodes = [replace(one, children=(*one.children, strips[one.name])) if one.children else one for one in others]
    assert [len(motor.parts) for motor in motors([base, *nodes], NAMELESS)] == [count, count]


def test_output_of_a_motor_by_use_is_the_widest() -> None:
    """The joint is about the disc, not about a screw, and is to be reviewed; both sides are right."""
    for sources in (BARE, NAMELESS):
        found = inferred(*two_servos(), sources=sources)
        assert joints(found) == [("revolute", "arm a", "base"), ("revolute", "arm b", "base")]
        for arc, x in zip(found.arcs, (-90.0, 110.0), strict=True):
            assert arc.evidence.axis.distance(np.array([x * 1e-3, 0.0, 0.0])) < 1e-9
            assert arc.evidence.review == "not named as a motor"


def test_named_motors_need_no_use() -> None:
    """One servo by name is a motor although nothing equals it; a motor's mount is not one."""
    nodes = two_servos(names=("SG90 servo", "b"))
    assert [motor.path for motor in motors(nodes)] == ["SG90 servo"]
    assert motors([part("motor mount", PLATE), part("bracket", ARM, z=4.5)]) == []


def test_numbered_pieces_of_one_servo_are_one_motor() -> None:
    """A case, a lid and an output that were imported as three products are one motor; two of each are two."""
    pieces = [("MG996R_2", CASE, 0.0), ("MG996R_1", box(40, 20, 4), 2.0), ("MG996R", HORN, 4.0)]
    nodes = [part("base", box(400, 80, 10), z=-40)]
    for x in (-100.0, 100.0):
        nodes += [part(name, solid, x, 0, z) for name, solid, z in pieces]
    assert [(motor.case, motor.parts) for motor in motors(nodes)] == [(2, (2, 3, 4)), (5, (5, 6, 7))]


def test_a_shaft_drawn_as_a_product_of_its_own_is_the_output() -> None:
    """A motor's shaft beside it in the tree, named after it, turns with the wheel on it in the one motor."""
    body = box(42, 42, 40).at(0, 0, -20) - cylinder(2.5, 30).at(0, 0, -30)
    wheel = cylinder(30, 10) - cylinder(2.5, 10)
    shaft = part("37D gearmotor shaft", cylinder(2.5, 50), z=-30)
    nodes = [part("chassis", box(200, 100, 6), z=-43), part("37D gearmotor", body), shaft, part("hub", wheel, z=5)]
    assert [len(motor.outputs) for motor in motors(nodes)] == [1]
    found = inferred(*nodes)
    assert joints(found) == [("revolute", "chassis", "hub")]
    assert {"37D gearmotor shaft", "hub"} in links(found)


def test_blocks_in_which_shafts_run_with_play_are_bearing_blocks() -> None:
    """Two equal blocks on a base, each with the shaft of an arm in its bore, are no motors; without play they are."""
    for radius, count in ((7.95, 0), (8.0, 2)):
        block = box(40, 20, 40) - cylinder(8, 40).at(0, 0, -20)
        crank = cylinder(radius, 45) + box(100, 16, 8).at(0, 0, 49)
        nodes = [part("base", box(400, 80, 10), z=-25)]
        for x in (-100.0, 100.0):
            nodes += [part(f"block {x}", block, x), part(f"arm {x}", crank, x, z=-22.0)]
        assert len(motors(nodes, BARE)) == count


@pytest.mark.parametrize("radius", [8.0, 7.95])
def test_blocks_with_a_boss_that_runs_in_what_they_turn_are_motors(radius: float) -> None:
    """Two equal blocks on a base, each with an arm on a boss of its own, are motors, with play and without."""
    block, arm = box(40, 30, 40) + cylinder(radius, 12).at(0, 0, 20), box(100, 24, 8).at(30, 0, 28.5)
    nodes = [part("base", box(400, 80, 10), z=-25)]
    for x in (-100.0, 100.0):
        nodes += [part(f"block {x}", block, x), part(f"arm {x}", arm - cylinder(8, 8).at(0, 0, 24.5), x)]
    assert len(motors(nodes, BARE)) == 2


def test_a_link_is_named_after_what_its_motor_sits_in() -> None:
    """A link of a bracket and a larger servo is called as the bracket; a servo alone gives its own name."""
    whole = assembled(part("SG90 servo", CASE), part("bracket", box(10, 10, 5), 100))
    found = Survey(whole, ALL_SOURCES).parts
    claims = LinkClaims(whole, [list(found)], 0)
    assert claims.name(list(found.values()))[0] == "bracket"
    assert claims.name([one for one in found.values() if one.name == "SG90 servo"]) == ("SG90_servo", "SG90 servo")


@pytest.mark.parametrize("size", [0.4, 1.0, 3.0])
@pytest.mark.parametrize("names", [("Getriebemotor", "Flansch"), ("motor", "body 2")])
@pytest.mark.parametrize("has_rings", [False, True])
def test_a_saddle_on_the_case_holds_the_motor(size: float, names: tuple[str, str], *, has_rings: bool) -> None:
    """A saddle on the round case of a motor holds it; what is on the flange turns, which is behind a bearing's gap."""
    s = size
    case = cylinder(45 * s, 64 * s) - cylinder(31.5 * s, 60 * s).at(0, 0, 4 * s)
    flange = cylinder(29.7 * s, 6 * s).at(0, 0, 62 * s) + cylinder(20.25 * s, 14 * s).at(0, 0, 48 * s)
    rings = [
        part("race outside", cylinder(31.5 * s, 10 * s) - cylinder(27 * s, 10 * s), z=50 * s),
        part("race inside", cylinder(26 * s, 10 * s) - cylinder(20.25 * s, 10 * s), z=50 * s),
    ]
    saddle = cut(
        box(70 * s, 40 * s, 30 * s).at(0, 0, -50 * s), turned(cylinder(45 * s, 90 * s), 0, 45 * s, 0, (pi / 2, 0, 0))
    )
    saddle += box(200 * s, 200 * s, 20 * s).at(0, 0, -75 * s)
    arm = box(60 * s, 20 * s, 8 * s).at(20 * s, 0, 72 * s)
    unit = group(names[0], part("shell", case), part(names[1], flange), *(rings if has_rings else []))
    lying = replace(unit, X=Pose.from_xyz_rpy((0, -0.03 * s, 0), (-pi / 2, 0, 0)))
    lever = replace(part("lever", arm), X=lying.X)
    found = inferred(part("stand", saddle), lying, lever)
    (arc,) = found.arcs
    assert {"stand", f"{names[0]}/shell"} <= links(found)[arc.parent]
    assert {"lever", f"{names[0]}/{names[1]}"} <= links(found)[arc.child]
    assert abs(arc.evidence.axis.d[1]) == pytest.approx(1.0)
    (motor,) = find_motors(found.survey)
    assert [found.survey.parts[i].name for i in apart_outputs(found.survey, motor)] == [names[1]]
    assert not apart_outputs(found.survey, replace(motor, is_named=False))


def test_a_tyre_turns_with_the_rotor_of_its_motor() -> None:
    """A hub motor is held by its axle, which what is largest, the tyre, is not on."""
    axle = cylinder(6, 90).at(0, 0, -45)
    stator, rotor = cylinder(40, 20) - cylinder(6, 20), cylinder(60, 32).at(0, 0, -3) - cylinder(52, 26)
    pieces = (
        axle,
        stator,
        rotor - cylinder(6.3, 60).at(0, 0, -30),
        cylinder(82, 36).at(0, 0, -5) - cylinder(60, 36).at(0, 0, -5),
    )
    hub = group("hub motor", *map(part, ("axle", "stator", "rotor", "tire"), pieces))
    clamp = box(600, 300, 30).at(0, 0, -25) - cylinder(6, 30).at(0, 0, -40)
    found = inferred(part("chassis", clamp), hub)
    assert {"hub motor/rotor", "hub motor/tire"} in links(found)
    assert {"chassis", "hub motor/axle", "hub motor/stator"} in links(found)


def test_ears_of_a_servo_are_no_flange_about_its_output() -> None:
    """Four screws at the corners of a rectangle hold a servo; its shaft, a product of its own, is where it turns."""
    servo = box(40, 20, 36).at(0, 0, -18) + box(7, 20, 3).at(23.5, 0, -9) + box(7, 20, 3).at(-23.5, 0, -9)
    wall = cut(box(70, 50, 4).at(0, 0, -12.5), box(41, 21, 4).at(0, 0, -12.5))
    for x, y in product((-24, 24), (-5, 5)):
        servo, wall = servo - cylinder(2, 3).at(x, y, -10.5), wall - cylinder(2, 4).at(x, y, -14.5)
    disc, lever = cylinder(12, 3).at(0, 0, 1), box(90, 24, 4).at(40, 0, 6)
    for x, y in ((8, 0), (0, 8), (-8, 0), (0, -8)):
        disc, lever = disc - cylinder(1, 3).at(x, y, 1), lever - cylinder(1, 4).at(x, y, 4)
    nodes = [part("wall", wall, z=-0.05), part("MG996R", servo), part("shaft", cylinder(2.95, 4), x=10)]
    found = inferred(*nodes, part("disc", disc - cylinder(3, 3).at(0, 0, 1), x=10), part("lever", lever, x=10))
    assert joints(found) == [("revolute", "MG996R", "lever")]
    assert found.arcs[0].evidence.axis.distance(found.survey.parts[3].com) < 1e-9


def test_equal_motors_in_a_folder_named_one_are_several() -> None:
    """Products with a number each are several motors if they are equal, whatever the folder is called."""
    blocks = [part(f"MG996R-{n}", case(), 100.0 * n) for n in range(3)]
    found = motors([part("base", box(400, 80, 10), z=-40), group("servos", *blocks)])
    assert [motor.path for motor in found] == [f"servos/MG996R-{n}" for n in range(3)]


def test_a_bracket_beside_a_motor_is_none() -> None:
    """What is named after a motor, and has rods in bores on two lines, is no motor; with one rod it may be one."""
    block, rod = box(60, 40, 30) - cylinder(4, 30).at(-20, 0, -15), cylinder(4, 300).at(0, 0, -15)
    rods = [part(f"rod {x}", rod, x) for x in (-20, 20)]
    two = block - cylinder(4, 30).at(20, 0, -15)
    assert len(motors([part("x_end_motor", block), rods[0], part("base", BASE, z=400)])) == 1
    assert motors([part("x_end_motor", two), *rods, part("base", BASE, z=400)]) == []


@pytest.mark.parametrize(("spacing", "is_motor"), [(31.0, True), (34.0, False)])
def test_a_block_with_the_flange_of_a_stepper_is_a_motor(spacing: float, is_motor: bool) -> None:
    """A single block with spigot and holes of NEMA 17 and no name turns the pinion on its shaft, to be reviewed."""
    corners = [(x * spacing / 2, y * spacing / 2) for x, y in product((-1, 1), (-1, 1))]
    block, plate = box(42.3, 42.3, 40).at(0, 0, -20) + cylinder(11, 2), box(200, 100, 6).at(0, 0, 3)
    for x, y in corners:
        block, plate = block - cylinder(1.5, 5).at(x, y, -5), plate - cylinder(1.6, 6).at(x, y, 0)
    plate -= cylinder(11.2, 6)
    pinion = cylinder(10, 10) - cylinder(2.5, 10)
    nodes = [part("a", plate), part("b", block + cylinder(2.5, 22)), part("c", pinion, z=10)]
    assert len(motors(nodes, BARE)) == is_motor
    evidence = [arc.evidence for arc in inferred(*nodes, sources=BARE).arcs]
    assert [(h.drives, h.review == "not named as a motor") for h in evidence] == [(is_motor, is_motor)]


def test_an_outrunner_is_held_by_its_stator() -> None:
    """What is on a rotor turns, though the rotor is wider than the mount that the stator stands on."""
    stator, mount = cylinder(12, 4) + cylinder(20, 8).at(0, 0, 4), box(120, 80, 6).at(0, 0, -3)
    for k in range(4):
        at = 8 * np.cos(k * pi / 2), 8 * np.sin(k * pi / 2)
        stator, mount = stator - cylinder(1.5, 3).at(*at, 0), mount - cylinder(1.6, 6).at(*at, -6)
    rotor = cylinder(27, 2).at(0, 0, 18) + (cylinder(27, 13).at(0, 0, 5) - cylinder(25, 13).at(0, 0, 5))
    motor = group("5010 BLDC", part("stator", stator), part("rotor", rotor))
    arm = part("arm", box(120, 24, 6).at(40, 0, 0), z=23)
    assert joints(inferred(part("mount", mount), motor, arm)) == [("revolute", "arm", "mount")]


def test_a_horn_that_is_a_body_of_its_servo_turns() -> None:
    """The horn of a servo that was imported as one product of two bodies turns with what is screwed to it."""
    shaft, horn = cylinder(2.3, 4).at(10, 0, 0), (box(30, 6, 2).at(20, 0, 2) + cylinder(4, 3).at(10, 0, 0.5))
    horn -= cylinder(2.3, 2.5).at(10, 0, 0.5)
    arm = box(60, 10, 4)
    for x in (20, 30):
        horn, arm = horn - cylinder(0.8, 3).at(x, 0, 1), arm - cylinder(0.8, 4).at(x - 40, 0, -2)
    bodies = [part(n, shape) for n, shape in (("1", CASE + shaft), ("2", horn))]
    plate = PLATE
    for x, y in CORNERS:
        plate -= cylinder(1.5, 5).at(x, y, -2.5)
    found = inferred(part("plate", BASE, z=-35), group("SG90", *bodies), part("arm", arm, 40, 0, 5))
    assert len(joints(found)) == 1


def test_holes_at_the_corners_of_a_rectangle_hold_unnamed_motors() -> None:
    """Blocks with discs on bosses are motors, though four holes to a bracket are on a wider circle than the boss."""
    block = box(28, 46, 32).at(0, -12, -16) + cylinder(10, 1)
    bracket = box(140, 4, 30).at(30, 13, -16)
    for x, z in product((-8, 8), (-22, -10)):
        block -= turned(cylinder(1.2, 8), x, 11, z, (pi / 2, 0, 0))
        for away in (0, 60):
            bracket -= turned(cylinder(1.3, 8), away + x, 17, z, (pi / 2, 0, 0))
    disc = cylinder(9.7, 3) - cylinder(3, 3)
    nodes = [part("a", bracket)]
    for x in (0, 60):
        nodes += [part(f"b{x}", block, x), part(f"c{x}", disc, x, 0, 1)]
    assert [motor.is_named for motor in motors(nodes, BARE)] == [False, False]


def test_what_touches_the_case_alone_holds_a_motor_with_a_drawn_output() -> None:
    """A round motor ends at the wall of its housing, with a gear on its shaft: the gear turns."""
    motor = cylinder(10, 30).at(0, 0, -30) + cylinder(1.5, 12)
    wall = box(60, 60, 2).at(0, 0, 1) - cylinder(9, 2)
    gear = cylinder(7, 8) - cylinder(1.5, 8)
    found = inferred(part("plate", wall), part("motor N20", motor), part("motor gear", gear, z=4))
    assert joints(found) == [("revolute", "motor N20", "motor gear")]
    assert {"plate", "motor N20"} in links(found)


@pytest.mark.parametrize(("beyond", "is_doubted"), [(60.0, True), (0.0, False)])
def test_a_rod_through_a_motor_may_be_the_screw_of_a_linear_one(beyond: float, *, is_doubted: bool) -> None:
    """A rod in the bore of a motor has a mark, unmarked as its shaft, if it is out of both ends of the case."""
    motor = box(35, 35, 36).at(0, 0, -18) - cylinder(2.5, 36).at(0, 0, -36)
    for x, y in product((-13, 13), (-13, 13)):
        motor -= cylinder(1.5, 8).at(x, y, -8)
    plate = box(60, 60, 8).at(0, 0, 4) - cylinder(5, 8)
    for x, y in product((-13, 13), (-13, 13)):
        plate -= cylinder(1.6, 8).at(x, y, 0)
    rod, block = cylinder(2.5, 66 + beyond), box(40, 20, 8).at(6, 0, 34) - cylinder(2.5, 8).at(0, 0, 30)
    nodes = [part("plate", plate), part("NEMA 14", motor), part("rod", rod, z=-26 - beyond), part("block", block)]
    (arc,) = inferred(*nodes).arcs
    assert arc.evidence.drives
    assert ("end to end" in arc.evidence.review) == is_doubted


def actuator() -> Solid:
    """A motor with a gearbox as one solid, its output flange above its face at z = 0, four holes in each [mm]."""
    solid = joined(box(56, 56, 70).at(0, 0, -85), cylinder(30, 50).at(0, 0, -50), cylinder(20, 8))
    around = [(cos(k * pi / 2 + pi / 4), sin(k * pi / 2 + pi / 4)) for k in range(4)]
    return cut(solid, *(cylinder(2.1, 20).at(r * u, r * v, z) for u, v in around for r, z in ((25, -12), (14, -2))))


def on_actuators(name: str) -> list[Node]:
    """A stand around two actuators, and an arm on the flange of each."""
    around = [(cos(k * pi / 2 + pi / 4), sin(k * pi / 2 + pi / 4)) for k in range(4)]
    arm = cut(box(200, 50, 20).at(60, 0, 18), *(cylinder(2.6, 20).at(14 * u, 14 * v, 8) for u, v in around))
    stand, nodes, solid = box(800, 100, 6).at(0, 0, 3), list[Node](), actuator()
    for n, x in enumerate((-200.0, 200.0)):
        stand = cut(
            stand, cylinder(20.5, 6).at(x, 0, 0), *(cylinder(2.6, 6).at(x + 25 * u, 25 * v, 0) for u, v in around)
        )
        nodes += [part(f"{name} {n}" if name else "", solid, x), part(f"arm {n}", arm, x)]
    return [part("stand", stand), *nodes]


def test_what_is_bolted_on_within_the_circle_that_holds_the_case_turns() -> None:
    """An output flange may be one solid with its actuator: of two circles of bolts about one axis it is the inner."""
    found = inferred(*on_actuators("NEMA23 motor"))
    assert sorted(kind for kind, *_ in joints(found)) == ["revolute", "revolute"]
    assert len(links(found)) == 3
    assert {"arm 0"} in links(found)


@pytest.mark.parametrize(
    "solid", [box(80, 64, 4), joined(box(60, 40, 4), box(4, 40, 60).at(-28, 0, 32))], ids=["plate", "bracket"]
)
def test_sheets_named_after_a_motor_are_none(solid: Solid) -> None:
    """A plate and a bent sheet may be named after the servo that they hold."""
    nodes = part("servo shelf", solid), part("servo MG996R", box(40, 20, 36), z=200)
    found = find_motors(Survey(assembled(*nodes), ALL_SOURCES))
    assert [motor.path for motor in found] == ["servo MG996R"]


def test_a_folder_with_the_motor_in_it_says_nothing_of_its_sides() -> None:
    """A motor's plate and the pulley on its shaft may be in one folder with it: the plate holds it."""
    holes = [(x, y) for x in (-15.5, 15.5) for y in (-15.5, 15.5)]
    motor = cut(box(42, 42, 40).at(0, 0, -20) + cylinder(2.5, 24), *(cylinder(1.5, 6).at(x, y, -6) for x, y in holes))
    plate = cut(box(120, 44, 6).at(30, 0, 3), cylinder(11.2, 6), *(cylinder(1.7, 6).at(x, y, 0) for x, y in holes))
    pulley = joined(cylinder(6, 10), cylinder(8, 1.2).at(0, 0, 10), cylinder(8, 1.2).at(0, 0, -1.2)) - cylinder(
        2.5, 20
    ).at(0, 0, -5)
    drive = group("drive", part("plate", plate), part("NEMA 17", motor), part("GT2 pulley", pulley, z=10))
    found = inferred(drive, part("frame", box(20, 44, 200), 80, 0, 106))
    assert {"drive/GT2 pulley"} in links(found)
    assert {"drive/plate", "drive/NEMA 17", "frame"} in links(found)


def test_a_plate_around_the_output_of_a_motor_does_not_turn() -> None:
    """A motor stands on a plate with a hole for its shaft: what it turns is the brush on it, not the plate."""
    plate = box(200, 80, 5).at(40, 0, -2.5) - cylinder(9.5, 5).at(0, 0, -5)
    pocket = cut(box(30, 20, 30).at(0, 0, 15), box(12.2, 10.2, 16).at(0, 0, 22), cylinder(4, 14))
    motor = box(12, 10, 24).at(0, 0, 26) + cylinder(1.5, 20).at(0, 0, -6)
    brush = joined(cylinder(8, 6), box(40, 3, 2).at(20, 0, 1)) - cylinder(1.5, 4.5).at(0, 0, 1.5)
    sides = group("sides", part("pocket", pocket), part("N20 motor", motor), part("brush", brush, z=-7.5))
    assert {"sides/brush"} in links(inferred(part("plate", plate), sides, part("post", box(8, 8, 90), 60, 0, 45)))
