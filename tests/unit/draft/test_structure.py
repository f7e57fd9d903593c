"""Subassemblies as links."""

from math import pi, sqrt

import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.evidence.evidence import Evidence, Weld
from stepbot.draft.evidence.subassemblies import Structure, body_welds
from stepbot.geometry.spatial import Pose
from tests.assembled import Node, assembled, cut, group, inferred, joints, links, part, turned
from tests.solids import box, cylinder

BLOCK = box(40, 40, 10)


def structure(*nodes: Node, sources: Sources = ALL_SOURCES, moving: set[tuple[int, int]] | None = None) -> Structure:
    """The subassemblies that look like links."""
    return Structure(Survey(assembled(*nodes), sources), moving or set())


def two(name: str, x: float) -> Node:
    """A subassembly of two blocks in contact."""
    return group(name, part("lower", BLOCK, x), part("upper", BLOCK, x, 0, 10))


def test_parts_of_a_subassembly_are_together() -> None:
    """Parts of one subassembly are together, those of two are across; a loose part is in neither."""
    found = structure(two("a", 0), two("b", 100), part("loose", BLOCK, 200))
    assert found.are_together(2, 3)
    assert found.are_across(2, 5)
    assert found.are_across(2, 7)
    assert not found.are_together(2, 5)


def test_pieces_of_a_subassembly_that_do_not_touch_are_weakly_together() -> None:
    """What touches in a subassembly is one; what does not is held by others, whose joints come first."""
    found = Evidence()
    structure(group("a", *two("b", 0).children, part("far", BLOCK, 300)), part("loose", BLOCK, 100)).welds(found)
    assert {(w.a, w.b): w.score for w in found.welds} == {(2, 3): 0.75, (2, 4): 0.61}


def test_bodies_of_equal_parts_are_one_across_a_gap() -> None:
    """A part drawn in two bodies that do not touch, and used twice, is no list of what moves."""
    bodies = [part("foot", cylinder(14, 10)), part("tube", (cylinder(14, 90) - cylinder(9, 90)).at(0, 0, 27))]
    alone, twice = (
        body_evidence(
            *(
                Node(f"leg {n}", children=bodies, X=Pose.from_xyz_rpy((0.1 * n, 0, 0), (0, 0, 0)), has_bodies=True)
                for n in range(count)
            )
        )
        for count in (1, 2)
    )
    assert (len(alone), [w.score for w in twice]) == (0, [0.61, 0.61])


def body_evidence(*nodes: Node) -> list[Weld]:
    """The welds between bodies of one product."""
    found = Evidence()
    body_welds(Survey(assembled(part("base", BLOCK, -300), *nodes), ALL_SOURCES), [], found)
    return found.welds


def test_subassembly_with_a_joint_inside_is_no_link() -> None:
    """A joint between two parts of a subassembly divides it."""
    found = structure(two("a", 0), two("b", 100), moving={(2, 3)})
    assert not found.are_together(2, 3)
    assert found.are_together(5, 6)


def test_without_the_tree_there_are_no_groups() -> None:
    """If the tree does not count, no parts are together or across."""
    found = structure(two("a", 0), two("b", 100), sources=Sources(tree=False))
    assert (found.groups, found.link_of) == ([], {})
    assert not found.are_across(2, 5)


def module(x: float) -> Node:
    """A housing with a boss, and a wheel 3 mm beside it that touches nothing."""
    boss = turned(cylinder(12, 10), x, 45, 30, (pi / 2, 0, 0))
    tyre = turned(cylinder(30, 20), x, 32, 30, (pi / 2, 0, 0))
    return group(f"module {x:g}", part("housing", box(50, 20, 60).at(x, 55, 50) + boss), part("tyre", tyre))


@pytest.mark.parametrize("rpy", [(0, 0, 0), (0.5, -0.4, 0.9)])
def test_a_wheel_that_touches_nothing_is_not_held_by_its_subassembly(rpy: tuple[float, float, float]) -> None:
    """What the assembly rolls on turns about the boss beside it; a block in its place is one with the housing.

    The ground is that below its largest part, however the whole is turned.
    """
    top = part("top", box(300, 60, 10).at(0, 55, 85))
    whole = Node("robot", children=(module(-100), module(100), top), X=Pose.from_xyz_rpy((0, 0, 0), rpy))
    assert [kind for kind, *_ in joints(inferred(whole))] == ["revolute"] * 2
    blocks = [
        group(f"module {x}", module(x).children[0], part("foot", box(60, 20, 60).at(x, 22, 30))) for x in (-100, 100)
    ]
    assert joints(inferred(*blocks, top)) == []


@pytest.mark.parametrize("are_screwed", [True, False])
def test_bodies_of_one_part_on_different_links_are_no_single_part(are_screwed: bool) -> None:
    """Two bodies of one part that do not touch, each on another link, screwed or not, do not hold these together."""
    arm, base = box(200, 30, 10).at(90, 0, 5), box(200, 100, 10).at(0, 0, -5)
    arm, base = arm - cylinder(4, 10), base - cylinder(4, 10).at(0, 0, -10)
    covers = [box(30, 20, 4).at(150, 0, 12), box(30, 20, 4).at(-80, 0, 2)]
    for x in (142, 158) if are_screwed else ():
        arm, covers[0] = arm - cylinder(1, 10).at(x, 0, 0), covers[0] - cylinder(1, 4).at(x, 0, 10)
    for x in (-88, -72) if are_screwed else ():
        base, covers[1] = base - cylinder(1, 10).at(x, 0, -10), covers[1] - cylinder(1, 4).at(x, 0, 0)
    bodies = [part(f"body {n}", cover) for n, cover in enumerate(covers)]
    found = inferred(part("base", base), part("arm", arm), Node("covers", children=bodies, has_bodies=True))
    assert links(found) == [{"base", "covers/body 1"}, {"arm", "covers/body 0"}]


QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))


def actuator(name: str, x: float, z: float) -> Node:
    """A housing with a spigot's bore and a flange in it, each with holes for screws."""
    case, output = cylinder(32, 55) - cylinder(25, 12).at(0, 0, 45), cylinder(24.9, 16).at(0, 0, 45.1)
    for a, b in QUARTERS:
        case, output = case - cylinder(2, 10).at(26 * a, 26 * b, 0), output - cylinder(1.6, 30).at(15 * a, 15 * b, 40)
    return group(name, part("housing", case, x, z=z), part("flange", output, x, z=z))


def test_actuators_bought_as_a_whole_have_a_joint_each() -> None:
    """What turns in each other in one subassembly is two links if each side is fastened to a part of its own."""
    arm = box(220, 66, 8).at(70, 0, 65.1)
    for a, b in QUARTERS:
        arm = arm - cylinder(1.6, 30).at(15 * a, 15 * b, 50) - cylinder(2, 30).at(140 + 26 * a, 26 * b, 50)
    stand = box(100, 100, 20).at(0, 0, -10)
    parts = part("stand", stand), part("arm", arm), part("fore", arm, 140, z=69.1)
    found = inferred(*parts, actuator("one", 0, 0), actuator("two", 140, 69.1))
    assert len(joints(found)) == 2
    assert {"arm", "one/flange", "two/housing"} in links(found)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_three_equal_pieces_are_a_list(count: int) -> None:
    """A subassembly of feet that touch a frame each, and not each other, is no link; two may be plates of one."""
    foot = cylinder(15, 10) + cylinder(4, 20).at(0, 0, 10)
    places = [(x, y) for x in (-100, 100) for y in (-80, 80)][:count]
    frame = box(260, 200, 20).at(0, 0, 20)
    for x, y in places:
        frame = frame - cylinder(4, 60).at(x, y, 0)
    feet = group("feet", *(part(f"foot {n}", foot, x, y) for n, (x, y) in enumerate(places)))
    found = structure(group("machine", part("frame", frame), part("cabinet", box(200, 150, 300), z=180)), feet)
    assert found.are_together(5, 6) == (count == 2)


@pytest.mark.parametrize("rpy", [(0, 0, 0), (0.5, -0.4, 0.9)])
def test_a_part_beside_the_edge_of_an_open_frame_is_near(rpy: tuple[float, float, float]) -> None:
    """A cube of bars has planes with little in them: only their edges count, 2 and 14 mm from two blocks."""
    frame = box(100, 100, 100)
    for turn in ((0, 0, 0), (pi / 2, 0, 0), (0, pi / 2, 0)):
        frame = cut(frame, turned(box(80, 80, 120), rpy=turn))
    nodes = part("frame", frame), part("block", box(10, 10, 10), 57, 0, 55), part("inside", box(60, 60, 60))
    whole = replace(group("turned", *nodes), X=Pose.from_xyz_rpy((0, 0, 0), rpy))
    scene = Survey(assembled(whole), ALL_SOURCES).scene
    assert [scene.gap([2], other) for other in (3, 4)] == pytest.approx([2e-3, 10e-3 * sqrt(2.0)], abs=1e-9)
