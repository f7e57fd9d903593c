"""Joints between clusters: links in a row on one axis, the two sides of a fork, and bodies that only spin."""

from math import pi

from tests.assembled import Node, cut, group, inferred, joints, links, part, turned
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
    assert joints(found) == [
        ("revolute", "neck/mount", "torso/shell"),
        ("revolute", "stand/foot", "torso/shell"),
    ]


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
