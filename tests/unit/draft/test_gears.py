"""Gears by name: which mesh, what they turn on, and the ratio of their joints."""

from dataclasses import replace

import pytest

from stepbot.draft.draft_robot import infer
from tests.assembled import Node, assembled, part
from tests.made.scored import drawn
from tests.solids import box, cylinder


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
