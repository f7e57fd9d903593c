"""Gears and racks by teeth, gears by name: which mesh, what they move on, and the ratio of their joints."""

from collections.abc import Iterable
from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from robot_library.moments import pose
from robot_library.step_file import moved
from stepbot.draft.contacts import teeth
from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.draft_robot import infer
from stepbot.geometry.spatial import Array, Pose
from tests.assembled import BARE, Node, assembled, group, inferred, joints, links, part, turned
from tests.made.scored import drawn
from tests.solids import Solid, box, cylinder, joined


def spots(turned: float = 0.0) -> list[tuple[float, float, float]]:
    """Where three planets are around their sun, and their angles."""
    return [(15 * cos(a), 15 * sin(a), a) for a in (turned + k * 2 * pi / 3 for k in range(3))]


def planets(z: float, turned: float = 0.0) -> list[Node]:
    """Three planets of 18 teeth around a sun of 12, with play on their pins."""
    planet = fused(toothed(18, 1, 8), less=cylinder(2.05, 8).shape)
    return [part("planet gear", planet, x, y, z, (0, 0, angle)) for x, y, angle in spots(turned)]


def train(radii: tuple[float, float], *, belt: bool = False) -> list[Node]:
    """Two gears with shafts in a plate; their pitch circles touch, or a belt is around both pulleys."""
    a, b = radii
    away = 3 * (a + b) if belt else a + b - 2.0
    kind = "pulley" if belt else "gear"
    plate = (
        box(away + 60, 60, 10).at(away / 2, 0, -5) - cylinder(3, 10).at(0, 0, -10) - cylinder(3, 10).at(away, 0, -10)
    )
    crank = box(40, 6, 4).at(15, 0, 10)
    nodes = [part("base", plate)]
    for name, radius, x in ((f"big {kind}", a, 0.0), (f"small {kind}", b, away)):
        nodes.append(part(name, cylinder(radius, 8) + cylinder(2.9, 10).at(0, 0, -10) + crank, x, 0, 0.5))
    if belt:
        nodes.append(part("timing belt", box(away + a + b, 2 * a, 6) - box(away, 2 * a - 2, 6), away / 2, 0, 4.5))
    return nodes


def test_belt_turns_on_no_pulley() -> None:
    """A belt that is drawn around its pulleys, with half of a bore on each, moves with one of them."""
    belt = box(90, 40, 12) + cylinder(20, 12).at(-45, 0, -6) + cylinder(20, 12).at(45, 0, -6)
    belt = belt - box(90, 36, 12) - cylinder(18, 12).at(-45, 0, -6) - cylinder(18, 12).at(45, 0, -6)
    plate = box(160, 60, 10)
    nodes = [part("belt GT2", belt, z=17)]
    for name, x in (("one", -45.0), ("two", 45.0)):
        plate -= cylinder(4, 10).at(x, 0, -5)
        nodes.append(part(f"pulley {name}", cylinder(18, 14) + cylinder(4, 16).at(0, 0, -16), x, 0, 10))
    draft = infer(assembled(part("base", plate), *nodes), "belt")
    assert [(joint.parent, joint.child) for joint in draft.joints] == [("base", "pulley_one"), ("base", "pulley_two")]


@pytest.mark.parametrize(("radii", "belt", "ratio"), [((21.0, 11.0), False, -2.0), ((20.0, 10.0), True, 2.0)])
def test_meshing_gears_follow_each_other(radii: tuple[float, float], *, belt: bool, ratio: float) -> None:
    """The joint of one gear follows the other's by the pitch circles, against it; a belt turns both the same way."""
    draft = infer(assembled(*train(radii, belt=belt)), "train")
    (led,) = [joint for joint in draft.joints if joint.mimic is not None]
    assert led.mimic is not None
    assert led.mimic.multiplier == pytest.approx(ratio, abs=1e-3)
    assert "count the teeth" in led.review


def test_what_is_not_named_a_gear_follows_nothing() -> None:
    """Two disks that touch are no gears."""
    nodes = [replace(node, name=node.name.replace("gear", "disk")) for node in train((21.0, 11.0))]
    assert all(joint.mimic is None for joint in infer(assembled(*nodes), "disks").joints)


@pytest.mark.slow
def test_a_geared_gripper_closes_with_one_motor() -> None:
    """The gear beside that of the servo follows it, and none of both is a closure."""
    draft = infer(drawn("gear_gripper", 1).assembly()[0], "gripper")
    assert [joint.mimic.multiplier for joint in draft.joints if joint.mimic is not None] == [-1.0]


def test_a_gear_that_nothing_holds_is_kept_apart_and_jointed() -> None:
    """It is not one link with the gear that it meshes with; a placeholder connects it, so that the draft is a tree."""
    plate = box(120, 60, 10).at(40, 0, -5) + cylinder(21, 8)
    lever = part("lever", box(100, 10, 5).at(40, 0, 0), 80, 0, 60)
    draft = infer(assembled(part("big gear", plate), part("small gear", cylinder(11, 8), 30, 0, 0.2), lever), "loose")
    assert [(joint.parent, joint.child, joint.type) for joint in draft.joints] == [("big_gear", "small_gear", "fixed")]
    assert len(draft.links) == 2


def prism(corners: Iterable[tuple[float, float]], height: float) -> Any:
    """A polygon in x and y, extruded along +z."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in corners:
        polygon.Add(gp_Pnt(x, y, 0))
    polygon.Close()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, height)).Shape()


TOOTH = ((-0.36, -1.25), (-0.12, 1.0), (0.12, 1.0), (0.36, -1.25))
"""Corners of a tooth: place in pitches, height above the pitch line in modules."""


def toothed(teeth: int, module: float, height: float, drawn: Iterable[int] = (), turned: float = 0.0) -> Any:
    """A rim of trapezoidal teeth along +z, all around or only some of them, turned by a part of the pitch."""
    shown, corners = set(drawn) or set(range(teeth)), []
    for k in range(teeth):
        for at, above in TOOTH:
            angle, r = 2 * pi * (k + at + turned) / teeth, module * (teeth / 2 + (above if k in shown else -1.25))
            corners.append((r * cos(angle), r * sin(angle)))
    return prism(corners, height)


def rack(teeth: int, module: float, height: float) -> Any:
    """A rack along x with its pitch line on y = 0, its tips towards -y, and a finger at its end."""
    pitch = pi * module
    corners = [(pitch * (k + at), -module * above) for k in range(teeth) for at, above in TOOTH]
    end = pitch * teeth
    corners += [(end + 20, 1.25 * module), (end + 20, 50), (end + 12, 50), (end + 12, 1.25 * module + 6)]
    return prism([*corners, (-0.36 * pitch, 1.25 * module + 6)], height)


def fused(*shapes: Any, less: Any = None) -> Any:
    """Shapes as one, without the last."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse

    one = shapes[0]
    for other in shapes[1:]:
        one = BRepAlgoAPI_Fuse(one, other).Shape()
    return BRepAlgoAPI_Cut(one, less).Shape() if less is not None else one


def cranked(rim: Any) -> Any:
    """A gear with a bore and a crank, without which it only spins."""
    return fused(rim, box(6, 40, 4).at(0, 15, 8).shape, less=cylinder(3.05, 20).shape)


def on_pins(one: Any, two: Any, away: float) -> list[Node]:
    """Two parts without telling names on pins of a plate."""
    plate = box(2 * away + 40, 60, 10).at(away / 2, 0, -5) + cylinder(3, 9)
    return [
        part("a1", plate + cylinder(3, 9).at(away, 0, 0)),
        part("a2", one, 0, 0, 0.3),
        part("a3", two, away, 0, 0.3),
    ]


@pytest.mark.parametrize(("teeth", "module"), [((24, 12), 1.5), ((17, 17), 2.0), ((40, 16), 0.8)])
def test_teeth_that_mesh_are_gears_whatever_their_names(teeth: tuple[int, int], module: float) -> None:
    """The ratio is that of the numbers of teeth, exactly."""
    gears = [cranked(toothed(n, module, 6, turned=0.5 * k)) for k, n in enumerate(teeth)]
    draft = infer(assembled(*on_pins(*gears, away=module * sum(teeth) / 2)), "train")
    assert [joint.type for joint in draft.joints] == ["revolute", "revolute"]
    (led,) = [joint for joint in draft.joints if joint.mimic is not None]
    assert led.mimic is not None
    (leader,) = [joint for joint in draft.joints if joint.mimic is None]
    first, second = teeth if leader.child == "a2" else teeth[::-1]
    same = leader.direction == led.direction
    assert led.mimic.multiplier == pytest.approx(-first / second * (1 if same else -1), abs=1e-4)
    assert f"{first} to {second} teeth" in led.review


def test_fingers_with_sectors_of_teeth_close_together() -> None:
    """Each finger of a gripper is one part, with teeth on a part of its rim."""
    bore, finger = cylinder(3.05, 20).shape, box(10, 70, 6).at(0, 38, 3).shape
    one = fused(toothed(20, 2.0, 6, drawn=range(-5 % 20, 20), turned=0.0), finger, less=bore)
    other = fused(toothed(20, 2.0, 6, drawn=range(-5 % 20, 20), turned=0.0), finger, less=bore)
    two = part("a3", other, 40.0, 0, 6.3, (0, pi, 0))
    nodes = [*on_pins(one, one, away=40.0)[:2], replace(two, name="a3")]
    draft = infer(assembled(*nodes), "gripper")
    assert sorted(joint.mimic is not None for joint in draft.joints) == [False, True]


@pytest.mark.parametrize("away", [60.0, 38.0])
def test_toothed_parts_that_do_not_mesh_follow_nothing(away: float) -> None:
    """Too far apart, or of other modules at a distance at which round gears could mesh."""
    draft = infer(assembled(*on_pins(cranked(toothed(24, 1.5, 6)), cranked(toothed(24, 1.2, 6)), away)), "knobs")
    assert [joint.mimic for joint in draft.joints] == [None, None]


def test_a_gear_on_a_driven_shaft_turns_with_it() -> None:
    """It is fixed to the shaft, not hinged on it: the shaft turns in bearings."""
    case = box(60, 60, 40).at(0, 0, -20) - cylinder(6.5, 40).at(0, 0, -40)
    shaft = cylinder(2.5, 60).at(0, 0, -45)
    gear = fused(toothed(24, 1.5, 6), cylinder(8, 4).at(0, 0, 6).shape, box(6, 50, 4).at(0, 30, 8).shape)
    gear = fused(gear, less=cylinder(2.5, 20).shape)
    bearings = [(cylinder(6.5, 5) - cylinder(2.5, 5)).at(0, 0, z) for z in (-40, -5)]
    nodes = [part("case", case), part("shaft", shaft), part("b1 625ZZ", bearings[0]), part("b2 625ZZ", bearings[1])]
    draft = infer(assembled(*nodes, part("lever", gear, 0, 0, 1)), "spindle")
    assert len(draft.joints) == 1
    assert draft.joints[0].type == "revolute"


@pytest.mark.parametrize("teeth", [16, 24])
def test_racks_slide_along_their_teeth_and_follow_the_pinion(teeth: int) -> None:
    """The jaws of a parallel gripper move apart by the radius of the pitch circle per radian."""
    module, radius = 1.5, 1.5 * teeth / 2
    back = radius + 1.25 * module + 6
    plate = box(220, 140, 10).at(0, 0, -5) + cylinder(3, 9)
    for side in (1, -1):
        plate = plate + box(220, 5, 8).at(0, side * (back + 2.5), 4)
    jaw = rack(9, module, 6)
    nodes = [part("a1", plate), part("a2", cranked(toothed(teeth, module, 6)), z=0.3)]
    nodes += [part("a3", jaw, 4, radius, 0), part("a4", jaw, -4, -radius, 0, (0, 0, pi))]
    draft = infer(assembled(*nodes), "gripper")
    types = {joint.child: joint.type for joint in draft.joints}
    assert types == {"a2": "revolute", "a3": "prismatic", "a4": "prismatic"}
    (leader,) = [joint for joint in draft.joints if joint.mimic is None]
    axis = np.array(leader.direction)
    for joint, y in (next((j, y) for j in draft.joints if j.child == c) for c, y in (("a3", radius), ("a4", -radius))):
        assert joint.mimic is not None
        assert f"{teeth} teeth" in joint.review
        speed = np.cross(axis, [0, y / 1e3, 0]) @ np.array(joint.direction)
        assert joint.mimic.multiplier == pytest.approx(speed, abs=1e-6)


def test_a_rack_far_from_the_pinion_follows_nothing() -> None:
    """Teeth that do not reach each other move nothing."""
    plate = box(220, 140, 10).at(0, 0, -5) + cylinder(3, 9) + box(220, 5, 8).at(0, 34.875, 4)
    nodes = [
        part("a1", plate),
        part("a2", cranked(toothed(16, 1.5, 6)), z=0.3),
        part("a3", rack(9, 1.5, 6), 4, 24.5, 0),
    ]
    assert all(joint.mimic is None for joint in infer(assembled(*nodes), "gripper").joints)


def test_pulleys_with_drawn_teeth_share_a_belt() -> None:
    """The teeth of both are counted, although they do not mesh with each other."""
    plate = box(240, 60, 10).at(60, 0, -5) + cylinder(3, 9) + cylinder(3, 9).at(120, 0, 0)
    wheels = [
        part(f"pulley {name}", cranked(toothed(n, 0.8, 6)), x, 0, 0.3) for name, n, x in (("a", 40, 0), ("b", 16, 120))
    ]
    belt = part("timing belt", box(160, 34, 5) - box(150, 30, 5), 60, 0, 3.3)
    draft = infer(assembled(part("base", plate), *wheels, belt), "belt")
    (led,) = [joint for joint in draft.joints if joint.mimic is not None]
    assert led.mimic is not None
    assert abs(led.mimic.multiplier) == (2.5 if led.child == "pulley_b" else 0.4)
    assert "by the belt 'timing belt'" in led.review
    assert "teeth, as drawn" in led.review


def test_a_gear_drawn_round_with_a_splined_bore_has_its_outer_circle() -> None:
    """The teeth of a spline are not those that mesh."""
    bore = toothed(12, 1.0, 12)
    spline = fused(cylinder(4, 30).at(0, 0, -15).shape, toothed(12, 1.0, 8))
    one = fused(cylinder(30, 8).shape, box(6, 60, 4).at(0, 30, 10).shape, less=bore)
    two = fused(cylinder(15, 8).shape, box(6, 40, 4).at(0, 15, 10).shape, less=cylinder(3.05, 20).shape)
    plate = fused(
        box(160, 80, 10).at(20, 0, -10).shape,
        cylinder(3, 9).at(45, 0, -5).shape,
        less=cylinder(4, 40).at(0, 0, -20).shape,
    )
    nodes = [part("base", plate), part("shaft", spline), part("gear a", one), part("gear b", two, 45, 0, 0)]
    found = Survey(assembled(*nodes), ALL_SOURCES)
    (mesh,) = found.meshes
    assert mesh.ratio == 2.0
    assert not mesh.are_counted


@pytest.mark.slow
def test_equal_gears_are_searched_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which outlines may have teeth is looked up once for each definition; the teeth are found in each part."""
    searched: list[int] = []
    is_wavy = teeth._is_wavy

    def counted(outline: Array) -> bool:
        searched.append(len(outline))
        return is_wavy(outline)

    monkeypatch.setattr(teeth, "_is_wavy", counted)
    gears, counts = on_pins(cranked(toothed(20, 1.0, 6)), cranked(toothed(30, 1.0, 6)), 25.0), []
    for copies in (1, 3):
        searched.clear()
        nodes = [Node(f"copy {n}", children=gears, X=Pose.of(position=(0.2 * n, 0.0, 0.0))) for n in range(copies)]
        found = Survey(assembled(*nodes), ALL_SOURCES)
        assert sorted(rim.teeth for rims in found.rims.values() for rim in rims) == [20] * copies + [30] * copies
        assert not found.rack_meshes
        counts.append(len(searched))
    assert counts[0] > 0
    assert counts[1] == counts[0]


@pytest.mark.parametrize("clearance", [0.05, 0.3])
def test_a_rack_with_clearance_on_all_sides_slides_on_what_its_pinion_turns_in(clearance: float) -> None:
    """Two jaws whose racks touch nothing slide along their teeth; a pinion without a crank turns."""
    plate = box(220, 140, 10).at(0, 0, -5) - cylinder(4.1, 10).at(0, 0, -10)
    pinion = fused(toothed(16, 1.5, 6), less=cylinder(2.5, 20).shape)
    shaft = cylinder(4, 9.8).at(0, 0, -9.9) + cylinder(2.5, 8).at(0, 0, -0.1)
    jaw = rack(9, 1.5, 6)
    nodes = [part("a1", plate), part("a2", pinion, z=0.3), part("a3", shaft)]
    nodes += [part("a4", jaw, 4, 12, clearance), part("a5", jaw, -4, -12, clearance, (0, 0, pi))]
    draft = infer(assembled(*nodes), "gripper")
    kinds = sorted((joint.type.value, joint.parent) for joint in draft.joints)
    assert kinds[:2] == [("prismatic", "a1")] * 2
    assert kinds[2][0] == "revolute"
    assert all(abs(joint.direction[0]) == pytest.approx(1.0) for joint in draft.joints if joint.type == "prismatic")


def slot(radius: float) -> Solid:
    """A plate with two round ends, 6 mm thick."""
    return box(80, 2 * radius, 6).at(0, 0, 3) + cylinder(radius, 6).at(-40, 0, 0) + cylinder(radius, 6).at(40, 0, 0)


def test_a_band_around_two_discs_is_a_belt() -> None:
    """A thin band of one width around two discs is a belt without a name, and no link; a plate around them is none."""
    discs = [part(f"disc {x}", cylinder(12, 10), x, z=-2) for x in (-40, 40)]
    for outer, is_belt in ((13.4, True), (20.0, False)):
        survey = Survey(assembled(part("ring", slot(outer) - slot(12)), *discs), BARE)
        assert (1 in survey.small) == is_belt


@pytest.mark.parametrize("has_belt", [False, True])
def test_a_belt_turns_what_it_runs_around(*, has_belt: bool) -> None:
    """Idlers that screws clamp to a plate turn in a belt, without names."""
    idler = cylinder(11.6, 10) - cylinder(2.5, 30).at(0, 0, -10)
    plate = box(160, 60, 10) - cylinder(2.5, 20).at(-40, 0, -10) - cylinder(2.5, 20).at(40, 0, -10)
    screw = cylinder(2.5, 20) + cylinder(4.5, 5).at(0, 0, 20)
    nodes = [part("plate", plate, z=-5)]
    for x in (-40, 40):
        nodes += [part("idler", idler, x), part("m5 screw", screw, x, z=-10)]
    nodes += [part("band", slot(13.4) - slot(12), z=2)] if has_belt else []
    assert [{*joint} for joint in joints(inferred(*nodes))] == [{"revolute", "plate", "idler"}] * 2 * has_belt


def test_a_round_gear_that_drives_another_is_a_link() -> None:
    """A pinion and a wheel on pins both turn where their teeth mesh; apart, one is a ring on its pin."""
    rims = [fused(toothed(n, 1.0, 6, turned=0.5 * k), less=cylinder(3.05, 20).shape) for k, n in enumerate((14, 46))]
    assert [len(inferred(*on_pins(*rims, away=away), sources=BARE).arcs) for away in (30.0, 45.0)] == [2, 1]


@pytest.mark.parametrize("is_grouped", [False, True])
def test_the_sun_of_a_planetary_gear_is_not_its_carrier(*, is_grouped: bool) -> None:
    """Both turn about one axis of the housing; the planets, which the sun moves, turn on the carrier.

    So do those whose teeth mesh in one subassembly, which is no link.
    """
    sides = [box(10, 80, 60).at(x, 0, 25) for x in (-55, 55)]
    housing = joined(box(120, 80, 10), *sides, box(120, 80, 10).at(0, 0, 50)) - cylinder(3.05, 10).at(0, 0, -5)
    housing -= cylinder(10, 10).at(0, 0, 45)
    carrier = joined(cylinder(22, 6).at(0, 0, 24), cylinder(9.95, 41).at(0, 0, 24))
    sun = fused(toothed(12, 1, 8, turned=0.5), cylinder(3, 23).at(0, 0, -17).shape)
    for x, y, _ in spots():
        carrier += cylinder(2, 18).at(x, y, 10)
    gears = [part("sun gear", sun, z=12), part("carrier", carrier), *planets(12)]
    found = inferred(part("housing", housing), *([group("stage", *gears)] if is_grouped else gears))
    assert any(names <= {"sun gear", "stage/sun gear"} for names in links(found))
    assert sorted((kind, *sorted(side.split("/")[-1] for side in sides)) for kind, *sides in joints(found)) == sorted(
        [("revolute", "carrier", "housing"), ("revolute", "housing", "sun gear")]
        + [("revolute", "carrier", "planet gear")] * 3
    )


@pytest.mark.parametrize("is_grouped", [False, True])
def test_carriers_of_two_planetary_gears_in_a_row_move_apart(*, is_grouped: bool) -> None:
    """The first carrier, which nothing holds but its planets, has the sun of the second one, on which it turns."""
    teeth, stub = toothed(12, 1, 8, turned=0.5), cylinder(4, 14).at(0, 0, 3)
    first = fused(cylinder(19, 4).shape, stub.shape, cylinder(6, 3).at(0, 0, 4).shape, moved(teeth, pose((0, 0, 7))))
    second = joined(cylinder(19, 4), cylinder(9.95, 37), *(cylinder(2, 14).at(x, y, -10) for x, y, _ in spots()))
    for x, y, _ in spots():
        first = fused(first, less=cylinder(2, 4).at(x, y, 0).shape)
    pins = [part(f"pin {n}", cylinder(2, 13), x, y, 1) for n, (x, y, _) in enumerate(spots())]
    sun = fused(teeth, less=cylinder(2, 8).shape)
    housing = cylinder(40, 80).at(0, 0, -20) - cylinder(30, 48).at(0, 0, -3) - cylinder(10, 15).at(0, 0, 45)
    housing -= cylinder(3, 17).at(0, 0, -20)
    stages = [
        [part("sun", sun, z=1), part("first", first, z=10), *planets(1), *pins],
        [part("second", second, z=27, rpy=(0, 0, pi / 3)), *planets(17, pi / 3)],
    ]
    grouped = [group(f"stage {n}", *some) for n, some in enumerate(stages)]
    found = inferred(part("housing", housing), *(grouped if is_grouped else stages[0] + stages[1]))
    (first_link,) = (names for names in links(found) if any(name.endswith("first") for name in names))
    assert {name.split("/")[-1] for name in first_link} == {"first", "pin 0", "pin 1", "pin 2"}
    assert sum(names == {"planet gear"} for names in links(found)) == (0 if is_grouped else 6)


def test_a_rack_on_what_slides_along_it_is_fixed() -> None:
    """A jaw slides on two rods of a frame, and the rack that lies on it goes with it, along its teeth."""
    along = (0.0, pi / 2, 0.0)
    frame = joined(box(220, 140, 10).at(0, 0, -5), *(box(10, 140, 60).at(x, 0, 25) for x in (-105, 105)))
    frame -= cylinder(4.1, 10).at(0, 0, -10)
    jaw, bushes = box(50, 90, 20).at(30, 0, 40), []
    for y in (-30, 30):
        frame += turned(cylinder(4, 210), x=-105, y=y, z=40, rpy=along)
        jaw -= turned(cylinder(7.5, 60), x=0, y=y, z=40, rpy=along)
        bushes.append(part(f"LM8UU {y}", cylinder(7.5, 24) - cylinder(4, 24), 18, y, 40, along))
    pinion = fused(toothed(16, 1.5, 6), less=cylinder(2.5, 20).shape)
    shaft = cylinder(4, 30).at(0, 0, -9.9) + cylinder(2.5, 9.7).at(0, 0, 20.1)
    nodes = part("frame", frame), part("jaw", jaw), part("a2", pinion, z=24), part("a3", shaft)
    found = inferred(*nodes, part("a4", rack(9, 1.5, 6), 4, 12, 24), *bushes)
    assert [kind for kind, *_ in joints(found)].count("prismatic") == 1
    assert any({"jaw", "a4"} <= link for link in links(found))


def test_fingers_whose_teeth_mesh_turn_on_a_screw_each() -> None:
    """Two geared fingers on a plate, each on a screw, one of them in the hole of a servo that is not drawn."""
    plate, gear = box(90, 40, 4).at(0, 0, 2) - cylinder(1.5, 4).at(18, 0, 0) - cylinder(6.6, 4).at(-18, 0, 0), 36
    finger = fused(toothed(24, 1.5, 6), box(12, 60, 6).at(0, 0.5 * gear + 20, 3).shape, less=cylinder(1.5, 6).shape)
    screw = cylinder(1.5, 10) + cylinder(2.7, 3).at(0, 0, 10)
    tree = [part("plate", plate), part("screw M3", screw, 18), part("screw M3x", screw, -18)]
    tree += [part(name, finger, x, z=4, rpy=(0, 0, turn)) for name, x, turn in (("left", 18, 0), ("right", -18, 0.131))]
    assert len(joints(inferred(group("palm", part("block", box(90, 40, 60).at(0, 0, -30))), group("grip", *tree)))) == 2
