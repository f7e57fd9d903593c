"""Joints between clusters: links in a row on one axis, the two sides of a fork, and bodies that only spin."""

from math import pi

import pytest

from tests.assembled import BARE, Node, cut, group, inferred, joints, links, part, turned
from tests.made.kit import TO_X, across, at, circle, drilled
from tests.solids import box, cylinder, joined

ALONG_Y = (pi / 2, 0, 0)


def trunk() -> tuple[Node, Node, Node]:
    """A stand, a torso that turns on it, and a neck that turns on the torso, about one vertical axis."""
    stand = group("stand", part("foot", joined(cylinder(150, 20), cylinder(60, 100).at(0, 0, 20))))
    torso = group("torso", part("ring", cylinder(62, 20), z=122), part("shell", box(200, 300, 400), z=342))
    neck = group("neck", part("column", cylinder(35, 80), z=545), part("mount", box(90, 90, 40), z=645))
    return stand, torso, neck


def test_links_in_a_row_on_one_axis_are_not_one() -> None:
    """The neck above a torso and the stand below it turn about one axis, 500 mm apart: two joints, three links."""
    found = inferred(*trunk())
    assert links(found) == [{"stand/foot"}, {"torso/ring", "torso/shell"}, {"neck/column", "neck/mount"}]
    assert joints(found) == [("revolute", "neck/mount", "torso/shell"), ("revolute", "stand/foot", "torso/shell")]


def test_two_cheeks_on_one_pin_are_one_link() -> None:
    """Two cheeks on either side of an arm, on the pin through it, move as one."""
    bore = turned(cylinder(6.05, 200), y=100, rpy=ALONG_Y)
    arm = group("arm", part("arm", cut(box(40, 30, 300).at(0, 0, -130), bore)))
    pin = part("pin", turned(cylinder(6, 60), y=30, rpy=ALONG_Y))
    hole = turned(cylinder(6, 200), y=100, rpy=ALONG_Y)
    cheeks = [part(f"cheek {n}", cut(box(40, 10, 120).at(0, y, 50), hole)) for n, y in enumerate((-20.5, 20.5))]
    found = inferred(arm, group("fork", pin, *cheeks))
    assert links(found) == [{"arm/arm"}, {"fork/pin", "fork/cheek 0", "fork/cheek 1"}]
    assert [kind for kind, *_ in joints(found)] == ["revolute"]


def test_two_sides_with_the_same_hinges_are_one_link() -> None:
    """Two bars far apart, each on bearings on the same two lines of two others, move as one: a chain, no loop."""
    lines, ring = (0.0, 150.0), turned(cylinder(11, 7) - cylinder(4, 7), y=3.5, rpy=ALONG_Y)
    ends, bars = [], []
    for x, name in zip(lines, ("base", "tip"), strict=True):
        rod = turned(cylinder(4, 120), y=60, rpy=ALONG_Y).at(x, 0, 0)
        ends.append(part(name, rod + box(60, 80, 60 if x else 120).at(x, 0, 0)))
    for y in (-52, 52):
        bar = box(190, 7, 30).at(75, y, 0)
        for n, x in enumerate(lines):
            bar = cut(bar, turned(cylinder(11, 7), y=3.5, rpy=ALONG_Y).at(x, y, 0))
            bars.append(part(f"608ZZ {n} {y}", ring, x, y))
        bars.append(group(f"side {y}", part("bar", bar), part("lug", box(20, 7, 20).at(75, y, 25))))
    found = inferred(*ends, *bars)
    assert [kind for kind, *_ in joints(found)] == ["revolute", "revolute"]
    assert any({"side -52/bar", "side 52/bar"} <= link for link in links(found))


@pytest.mark.parametrize(("holes", "screws"), [(4, 0), (0, 0), (4, 4)])
def test_a_tool_flange_at_the_end_of_a_chain_turns(holes: int, screws: int) -> None:
    """A disc with a free circle of holes is where a tool goes; one without, or with its screws drawn, is a lid."""
    base = box(100, 100, 100).at(0, 0, -50) + cylinder(20, 25)
    arm = box(160, 60, 20).at(50, 0, 15) - cylinder(20, 20).at(0, 0, 5) - cylinder(12, 20).at(100, 0, 5)
    flange = cylinder(12, 22).at(100, 0, 3) + cylinder(22, 8).at(100, 0, 25)
    nodes = []
    for n in range(holes):
        x, y = ((16, 0), (0, 16), (-16, 0), (0, -16))[n]
        flange -= cylinder(2, 8).at(100 + x, y, 25)
        nodes += [part("DIN 912 M4", cylinder(2, 8), 100 + x, y, 25)] if n < screws else []
    found = inferred(part("a", base), part("b", arm), part("c", flange), *nodes)
    turning = [arc for arc in found.arcs if "c" in links(found)[arc.child] and len(links(found)) == 3]
    assert [bool(arc.evidence.review) for arc in turning] == ([True] if holes and not screws else [])


def castings(off: float) -> list[Node]:
    """Bodies that meet at round flanges, with a motor on the line of the second one; drawn off but for the first."""
    upper = across(50, 60) + box(80, 50, 240).at(0, 0, 120)
    lower = box(200, 200, 60).at(0, 60, -80) + box(60, 60, 60).at(0, 60, -30) + across(50, 60).at(0, 60, 0)
    fore = across(50, 60).at(0, 60, 240) + box(200, 50, 60).at(100, 60, 240)
    top = upper + across(50, 60).at(0, 0, 240)
    motor = across(20, 40).at(0, 110, 240) + box(20, 20, 20).at(0, 135, 250)
    neck = cylinder(20, 30).moved(at(200, 60, 240) @ TO_X)
    flange = drilled(cylinder(20, 8), *circle(6, 14, 2.0)).moved(at(230, 60, 240) @ TO_X)
    rest = part("upper", top, off, 0.7 * off, -off), part("fore", fore + neck, -off, off, 0.5 * off)
    return [part("lower", lower), *rest, part("motor", motor, -off, off, 0.5 * off), part("flange", flange)]


def test_a_chain_of_castings_with_a_motor_and_a_flange() -> None:
    """Bodies that meet at round flanges turn there, also with a motor on the same line, and so does a tool flange."""
    assert joints(inferred(*castings(0.0), sources=BARE)) == [
        ("revolute", "flange", "fore"),
        ("revolute", "fore", "upper"),
        ("revolute", "lower", "upper"),
    ]


def test_castings_drawn_off_turn_at_the_same_flanges() -> None:
    """Flanges of one radius that were drawn up to 0.1 mm off each other are moved to where they meet."""
    rows = joints(inferred(*castings(0.08), sources=BARE))
    assert {("revolute", "fore", "upper"), ("revolute", "lower", "upper")} <= set(rows)
