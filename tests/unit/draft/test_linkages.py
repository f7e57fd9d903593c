"""Linkages: bodies on one pin, one screw or one pair of holes."""

from math import pi

import numpy as np
import pytest

from stepbot.draft.evidence.mobility import Hinge, mobility
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from tests.assembled import Node, cut, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder, joined


def bar(x: float, y: float, u: float, v: float, level: float, bore: float = 3.0) -> Solid:
    """A plate of 5 mm from (x, y) to (u, v) with a bore at either end, at a height."""
    low, high = (min(x, u) - 8, min(y, v) - 8), (max(x, u) + 8, max(y, v) + 8)
    size = high[0] - low[0], high[1] - low[1]
    plate = box(*size, 5).at(low[0] + size[0] / 2, low[1] + size[1] / 2, level)
    return plate - cylinder(bore, 30).at(x, y, level - 15) - cylinder(bore, 30).at(u, v, level - 15)


def bars(second: float = 3.0, gap: float = 0.0) -> dict[str, Solid]:
    """A crank, a coupler and a rocker on a ground plate, each pair with one pair of bare holes, a gap [mm] apart."""
    points = (0, 0), (0, 60), (130, 80), (120, 0)
    ends = list(zip(points, (*points[1:], points[0]), strict=True))
    names = "crank", "coupler", "rocker", "ground"
    levels = 5.0 + gap, 10.0 + 2.0 * gap, 5.0 + gap, 0.0
    return {
        name: bar(*a, *b, level, second if name == "coupler" else 3.0)
        for name, (a, b), level in zip(names, ends, levels, strict=True)
    }


def four_bar(second: float = 3.0, gap: float = 0.0) -> list[Node]:
    """The same as parts."""
    return [part(name, solid) for name, solid in bars(second, gap).items()]


FOUR_JOINTS = [
    ("revolute", "coupler", "crank"),
    ("revolute", "coupler", "rocker"),
    ("revolute", "crank", "ground"),
    ("revolute", "ground", "rocker"),
]


@pytest.mark.parametrize("gap", [0.0, 3.0, 5.0])
def test_bare_holes_of_a_four_bar_are_four_marked_joints(gap: float) -> None:
    """Three joints of the tree and one that closes the loop, each marked; spacers as thick as a bar may be undrawn."""
    found = inferred(*four_bar(gap=gap))
    assert sorted(joints(found)) == FOUR_JOINTS
    assert all(arc.evidence.review for arc in found.arcs)
    assert sum(arc.is_closure for arc in found.arcs) == 1


@pytest.mark.parametrize(("count", "gap"), [(3, 3.0), (4, 6.0)])
def test_holes_across_a_gap_are_no_joints_by_themselves(count: int, gap: float) -> None:
    """Holes of bars that close no loop may be in line by chance, and a pin is not guided across a longer gap."""
    assert not any(arc.evidence.of_linkage for arc in inferred(*four_bar(gap=gap)[:count]).arcs)


@pytest.mark.parametrize("is_loop", [False, True])
def test_a_stop_is_none_where_nothing_could_leave_it(is_loop: bool) -> None:
    """A block on the ground, on one side of the crank's pivot, is its stop in a loop that could move away from it."""
    stop, solids = box(40, 7, 5).at(28, 4.5, 5), bars()
    for x in (20, 40):
        stop = stop - cylinder(1, 9).at(x, 4.5, 1)
        solids["ground"] = solids["ground"] - cylinder(1, 9).at(x, 4.5, -4)
    names = [name for name in solids if is_loop or name in ("crank", "ground")]
    found = inferred(*(part(name, solids[name]) for name in names), part("stop", stop))
    assert sorted(joints(found)) == (FOUR_JOINTS if is_loop else [])


def test_bars_on_both_sides_of_a_linkage_are_one() -> None:
    """Two cranks on the same lines, and two rockers, turn together, although they are far apart."""
    near, far, parts = bars(), {name: solid.at(0, 0, 60) for name, solid in bars().items()}, []
    parts.append(part("ground", near["ground"] + box(10, 10, 55).at(60, 0, 30) + far["ground"]))
    parts.append(part("coupler", near["coupler"] + box(10, 10, 55).at(65, 70, 40) + far["coupler"]))
    for name in ("crank", "rocker"):
        parts += [part(name, near[name]), part(f"{name} 2", far[name])]
    found = inferred(*parts)
    assert links(found) == [{"ground"}, {"coupler"}, {"crank", "crank 2"}, {"rocker", "rocker 2"}]
    assert len(joints(found)) == 4


def test_plates_on_both_sides_of_a_chain_are_one() -> None:
    """Two plates that do not touch, on the axles of two legs, are one body: nothing could move them apart."""
    hole, axle = cylinder(2.05, 200), cylinder(2, 44)
    plate = box(120, 60, 2)
    for x in (-40, 40):
        plate = plate - hole.at(x, 0, -100)
    leg = axle.at(0, 0, -22) + box(10, 40, 8).at(0, 20, 0) + box(60, 10, 8).at(0, 40, 0)
    nodes = [part("bottom", plate, z=-20), part("top", plate, z=20)]
    nodes += [part("left", leg, x=-40), part("right", leg, x=40), part("foot", box(120, 60, 10), z=-26)]
    found = inferred(*nodes)
    assert [sorted(link) for link in links(found)] == [["bottom", "foot", "top"], ["left"], ["right"]]


@pytest.mark.parametrize("has_cover", [True, False])
def test_a_linkage_in_one_part_is_an_assembly(has_cover: bool) -> None:
    """A linkage drawn as bodies of one part, with a cover on two screw holes or not, moves as one of parts does."""
    cover, solids = box(60, 10, 5).at(60, 0, -5), bars()
    for x in (40, 80):
        cover = cover - cylinder(1, 9).at(x, 0, -9)
        solids["ground"] = solids["ground"] - cylinder(1, 9).at(x, 0, -4)
    bodies = [part(name, solid) for name, solid in {**solids, **({"cover": cover} if has_cover else {})}.items()]
    found = inferred(Node("robot", children=bodies, has_bodies=True), part("table", box(300, 300, 20).at(60, 0, -50)))
    assert len(joints(found)) == 4
    assert any({"robot/ground", "robot/cover"} <= link for link in links(found)) == has_cover


def test_a_truss_of_three_bars_does_not_move() -> None:
    """Bars that close a triangle have no mobility: none of their holes is a joint."""
    points = (0, 0), (100, 0), (50, 90)
    ends = zip(points, (*points[1:], points[0]), strict=True)
    levels = 0.0, 5.0, 10.0
    bars = [part(f"bar {n}", bar(*a, *b, levels[n])) for n, (a, b) in enumerate(ends)]
    pin = part("pin", cylinder(3, 20).at(0, 0, -4))
    assert joints(inferred(*bars, pin)) == []


@pytest.mark.parametrize("screws", [1, 2])
def test_two_screws_hold_what_one_lets_turn(screws: int) -> None:
    """A bracket on one screw is offered as a joint, and one on two is fixed."""
    at = [(0.0, 0.0), (20.0, 0.0)][:screws]
    base, bracket = box(200, 60, 10).at(0, 0, -5), box(30, 150, 8).at(10, 60, 4)
    parts = []
    for n, (x, y) in enumerate(at):
        hole = cylinder(2, 60).at(x, y, -30)
        base, bracket = base - hole, bracket - hole
        parts.append(part(f"M4x16 screw {n}", cylinder(2, 16).at(x, y, -8) + cylinder(4, 4).at(x, y, 8)))
    found = inferred(part("base", base), part("bracket", bracket), *parts)
    assert joints(found) == ([("revolute", "base", "bracket")] if screws == 1 else [])
    assert all(arc.evidence.review for arc in found.arcs)


@pytest.mark.parametrize("gland", [5.1, 8.0])
def test_a_rod_slides_in_its_barrel_between_two_pins_across_it(gland: float) -> None:
    """The fit of its head is short, and a gland may not be drawn: a bar would not be drawn in two parts."""
    y = (-pi / 2, 0.0, 0.0)
    barrel, rod = (
        turned(cylinder(11, 59), 0, 9, 0, y) + box(16, 17, 15).at(0, 0.5, 0),
        turned(cylinder(5, 66), 0, 30, 0, y),
    )
    barrel = cut(barrel, turned(cylinder(8, 45), 0, 15, 0, y), turned(cylinder(gland, 20), 0, 55, 0, y))
    rod = rod + turned(cylinder(7.9, 8), 0, 30, 0, y) + box(16, 16, 20).at(0, 100, 2.5)
    barrel, rod = barrel - cylinder(3, 40).at(0, 0, -20), rod - cylinder(3, 40).at(0, 100, -20)
    base, beam = bar(0, 0, 80, 0, 10), bar(0, 100, 80, 0, 15)
    found = inferred(part("base", base), part("barrel", barrel), part("rod", rod), part("beam", beam))
    assert [kind for kind, *_ in joints(found) if kind == "prismatic"] == ["prismatic"]


@pytest.mark.parametrize("play", [0.05, 0.0])
def test_a_rod_in_an_eye_of_its_own_slides_in_its_barrel(play: float) -> None:
    """A damper's rod fits exactly in the eye that it is pressed in; one that also fills the barrel holds both."""
    y = (-pi / 2, 0.0, 0.0)
    barrel = turned(cylinder(11, 59), 0, 9, 0, y) + box(16, 17, 15).at(0, 0.5, 0)
    barrel = cut(barrel, turned(cylinder(8, 30), 0, 15, 0, y), turned(cylinder(5 + play, 30), 0, 45, 0, y))
    eye = cut(box(16, 36, 20).at(0, 90, 2.5), turned(cylinder(5, 24), 0, 72, 0, y))
    barrel, eye = barrel - cylinder(3, 40).at(0, 0, -20), eye - cylinder(3, 40).at(0, 100, -20)
    rod = part("rod", turned(cylinder(5, 66), 0, 30, 0, y))
    base, beam = bar(0, 0, 80, 0, 10) + box(202, 120, 5).at(-107, 0, 10), bar(0, 100, 80, 0, 15)
    found = inferred(part("base", base), part("barrel", barrel), rod, part("eye", eye), part("beam", beam))
    assert ("prismatic" in {kind for kind, *_ in joints(found)}) == bool(play)
    assert any({"rod", "eye"} <= link for link in links(found))


@pytest.mark.parametrize(("land", "kind"), [(10, "prismatic"), (44, "revolute")])
def test_a_short_head_with_room_in_its_bore_slides(land: float, kind: str) -> None:
    """A piston, without a loop that needs it, is marked; a head that fills its bore turns in it."""
    barrel = cylinder(19, 60) - cylinder(14, 50).at(0, 0, 10)
    rod = cylinder(13.9, land).at(0, 0, 12) + cylinder(6, 80).at(0, 0, 12 + land)
    found = inferred(part("barrel", barrel), part("rod", rod))
    assert joints(found) == [(kind, "barrel", "rod")]
    assert ("room to travel" in found.arcs[0].evidence.review) == (kind == "prismatic")


@pytest.mark.parametrize("fit", ["loose", "exact", "bearings"])
def test_a_finger_that_a_block_on_two_rods_moves(fit: str) -> None:
    """A block on two rods of a frame slides in the loop of a link and a finger; the rods are no pins of a weld.

    It is loose on them, or fits as exactly as the frame but has them reach through it, or is on linear bearings.
    """
    bore = {"loose": 2.1, "exact": 2.0, "bearings": 4.0}[fit]
    frame = box(90, 110, 4).at(0, 40, 2) + box(90, 12, 22).at(0, -6, 15)
    frame = frame - cylinder(1.5, 4).at(30, 80, 0)
    block = box(40, 16, 14).at(0, 30, 15) - cylinder(1.5, 5).at(18, 30, 17)
    rods = []
    for n, x in enumerate((-12.0, 12.0)):
        frame = frame - turned(cylinder(2, 12), x, 0, 15, (pi / 2, 0, 0))
        block = block - turned(cylinder(bore, 16), x, 38, 15, (pi / 2, 0, 0))
        rods.append(part(f"rod {n}", turned(cylinder(2, 82), x, 70, 15, (pi / 2, 0, 0))))
        if fit == "bearings":
            ring = turned(cylinder(4, 16) - cylinder(2, 16), x, 38, 15, (pi / 2, 0, 0))
            rods.append(part(f"linear bearing LM4UU {n}", ring))
    bars = [part("link", bar(18, 30, 44, 60, 24.5, bore=1.55)), part("finger", bar(30, 80, 44, 60, 6.5, bore=1.55))]
    pins = [
        part(f"pin {n}", cylinder(1.5, high - low).at(x, y, low))
        for n, (x, y, low, high) in enumerate(((18, 30, 17, 27), (44, 60, 4, 27), (30, 80, 0, 9)))
    ]
    found = inferred(part("frame", frame), part("block", block), *bars, *rods, *pins)
    assert joints(found) == [
        ("prismatic", "block", "frame"),
        ("revolute", "block", "link"),
        ("revolute", "finger", "frame"),
        ("revolute", "finger", "link"),
    ]


def test_bodies_that_no_loop_connects_may_be_one() -> None:
    """Two loops, each of a frame and three bars, and a bar between them: the frames may stand on one plate."""
    corners = [(0.0, 0.0), (0.0, 0.1), (0.2, 0.1), (0.2, 0.0)]
    hinges = []
    for first, x in ((0, 0.0), (4, 0.5)):
        places = [Axis(np.array([x + u, v, 0.0]), np.array([0.0, 0.0, 1.0])) for u, v in corners]
        hinges += [Hinge(axis, first + n, first + (n + 1) % 4) for n, axis in enumerate(places)]
    up = np.array([0.0, 0.0, 1.0])
    hinges += [Hinge(Axis(np.array([x, 0.1, 0.0]), up), body, 8) for x, body in ((0.1, 2), (0.6, 6))]
    found = mobility(hinges, Clusters(range(9)))
    assert found is not None
    assert found.turning == set(range(10))
    assert {(a < 4, b < 4) for a, b in found.apart} == {(True, True), (False, False)}


def test_a_rod_is_guided_by_its_piston_and_the_gland_that_is_fitted_to_its_barrel() -> None:
    """A boom on a base, and a cylinder between both: its rod slides, though its fits have no play and are short."""
    across = (0.0, pi / 2, 0.0)
    eye, wide = cylinder(3, 30).at(0, 0, -15), cylinder(8, 5)
    base = bar(0, 0, 0, 200, -2.5)
    boom = joined(bar(0, 200, 200, 200, 7.5), wide.at(0, 200, 0)) - eye.at(0, 200, 0)
    tube = cut(turned(cylinder(12, 95), x=35, z=2.5, rpy=across), turned(cylinder(9, 90), x=45, z=2.5, rpy=across))
    barrel = joined(box(46, 16, 5).at(15, 0, 2.5), tube) - eye
    gland = turned(cylinder(9, 10) - cylinder(5, 10), x=120, z=2.5, rpy=across)
    far = 200 * 2**0.5
    shaft = turned(joined(cylinder(5, 196), cylinder(9, 8)), x=60, z=2.5, rpy=across)
    rod = joined(shaft, box(43, 10, 5).at(far - 11.5, 0, 2.5), wide.at(far, 0, 0)) - eye.at(far, 0, 0)
    turn = (0.0, 0.0, pi / 4)
    pieces = (part(name, solid, rpy=turn) for name, solid in (("barrel", barrel), ("gland", gland), ("rod", rod)))
    found = inferred(part("base", base), part("boom", boom), *pieces)
    assert ("prismatic", "barrel", "rod") in joints(found)
    assert sorted(kind for kind, *_ in joints(found)) == ["prismatic", "revolute", "revolute", "revolute"]
    assert {"barrel", "gland"} in links(found)


def test_a_rod_through_two_supports_slides_where_a_crank_could_not_turn_otherwise() -> None:
    """A servo's arm moves a block on a rod by a bar; the rod, a pin for its size, is in a hole of each of two walls."""
    along = (0.0, pi / 2, 0.0)
    bore = turned(cylinder(3.1, 400), x=-200, z=30, rpy=along)
    base = cut(joined(box(260, 90, 8), box(8, 90, 60).at(-110, 0, 30), box(8, 90, 60).at(110, 0, 30)), bore)
    rod = turned(cylinder(3, 300), x=-140, z=30, rpy=along)
    block = cut(joined(box(16, 12, 16).at(40, 0, 30), turned(cylinder(2, 14), x=40, y=20, z=35, rpy=(pi / 2, 0, 0))),
                turned(cylinder(3, 40), x=20, z=30, rpy=along))  # fmt: skip
    servo = box(40, 20, 36).at(-20, 40, 22) + turned(cylinder(3, 14), x=-30, y=30, z=30, rpy=(pi / 2, 0, 0))
    eye = turned(cylinder(2, 40), x=-30, y=40, z=60, rpy=(pi / 2, 0, 0))
    hub = turned(cylinder(3, 40), x=-30, y=40, z=30, rpy=(pi / 2, 0, 0))
    arm = cut(box(14, 5, 46).at(-30, 23.5, 45), eye, hub)
    pin = turned(cylinder(2, 13), x=-30, y=26, z=60, rpy=(pi / 2, 0, 0))
    ends = [turned(cylinder(2, 40), x=x, y=40, z=z, rpy=(pi / 2, 0, 0)) for x, z in ((-30, 60), (40, 35))]
    corner = box(82, 5, 12).at(5, 16, 60), box(12, 5, 38).at(40, 16, 47)
    bar = cut(joined(*corner), *ends)
    names = {"base": base, "rod": rod, "block": block, "MG996R": servo, "arm": arm, "pin": pin, "bar": bar}
    found = inferred(*(part(name, solid) for name, solid in names.items()))
    assert ("prismatic", "base", "rod") in joints(found)
    assert sorted(kind for kind, *_ in joints(found)) == ["prismatic", "revolute", "revolute", "revolute"]
