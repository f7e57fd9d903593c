"""Rollers of omnidirectional wheels, and round bodies around a hub that are none."""

from math import pi

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.evidence.evidence import Evidence
from stepbot.draft.evidence.rollers import roller_evidence
from stepbot.robot.model import JointKind
from tests.assembled import BARE, Node, assembled, cut, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cone, cylinder

COUNT = 6
BASE = part("base", box(200, 200, 60), z=-80)
"""Some way below the wheel."""


def wheel(inclination: float, *, radial: bool = False, count: int = COUNT) -> list[Node]:
    """A hub about z, and rollers of r 6 mm around it with gaps, inclined to z [rad] or along the radius."""
    roller = turned(cylinder(6, 30).at(0, 0, -15), rpy=(0, pi / 2, 0) if radial else (inclination, 0, 0))
    nodes = [part("hub", cylinder(22, 30).at(0, 0, -15))]
    for n in range(count):
        angle = 2 * pi * n / COUNT
        nodes.append(part(f"roller {n}", roller, 38 * np.cos(angle), 38 * np.sin(angle), rpy=(0, 0, angle)))
    return nodes


@pytest.mark.parametrize("inclination", [pi / 4, pi / 2])
def test_rollers_of_mecanum_and_omni_wheels_turn_about_their_own_axes(inclination: float) -> None:
    """Each roller turns on the hub, and the hub on the base; all are marked for review."""
    found = inferred(BASE, *wheel(inclination), sources=BARE)
    expected = [("revolute", "base", "hub"), *(("revolute", "hub", f"roller {n}") for n in range(COUNT))]
    assert joints(found) == expected
    for arc in found.arcs:
        assert arc.evidence.review == "guessed from its shape; no contact shows this joint"
        if arc.evidence.of_roller:
            assert abs(arc.evidence.axis.d[2]) == pytest.approx(np.cos(inclination), abs=1e-9)
        else:
            assert np.allclose(abs(arc.evidence.axis.d), (0, 0, 1))


@pytest.mark.parametrize(("name", "count"), [("barrel", COUNT), ("M12x30 screw", 0)])
def test_screws_around_a_hub_are_no_rollers(name: str, count: int) -> None:
    """What has the place and shape of rollers, and is named a screw, does not turn on the hub."""
    hub, *rollers = wheel(pi / 4)
    nodes = [replace(one, name=f"{name} {n}") for n, one in enumerate(rollers)]
    found = Evidence()
    roller_evidence(Survey(assembled(BASE, hub, *nodes), ALL_SOURCES), found)
    assert sum(joint.of_roller for joint in found.joints) == count


def test_rollers_are_around_the_hub_beside_a_larger_motor_and_their_pins_are_none() -> None:
    """The hub is what the rollers are around, not a longer motor on its axis; pins in rollers are no rollers."""
    nodes = wheel(pi / 4)
    pin = turned(cylinder(1.5, 34).at(0, 0, -17), rpy=(pi / 4, 0, 0))
    for n in range(COUNT):
        angle = 2 * pi * n / COUNT
        nodes.append(part(f"pin {n}", pin, 38 * np.cos(angle), 38 * np.sin(angle), rpy=(0, 0, angle)))
    found = inferred(BASE, part("block", cylinder(24, 60), z=16), *nodes, sources=BARE)
    rollers = [arc.evidence for arc in found.arcs if arc.evidence.of_roller]
    assert sorted(
        found.survey.parts[i].path for h in rollers for i in (h.a, h.b) if found.survey.parts[i].path != "hub"
    ) == [f"roller {n}" for n in range(COUNT)]


@pytest.mark.parametrize("sources", [BARE, ALL_SOURCES])
def test_rollers_on_pins_in_the_discs_of_their_hub_turn(sources: Sources) -> None:
    """What is held about its own axis alone, and repeated around a wheel, turns there; its pin is of the hub."""
    tilted = [turned(cylinder(1.5, 40).at(0, 0, -20), 38, 0, 0, (pi / 4, 0, 0))]
    roller = turned(cylinder(6, 24).at(0, 0, -12) - cylinder(1.55, 24).at(0, 0, -12), rpy=(pi / 4, 0, 0))
    pin = turned(cylinder(1.5, 40).at(0, 0, -20), rpy=(pi / 4, 0, 0))
    hub = cylinder(14, 30).at(0, 0, -15) + cylinder(46, 3).at(0, 0, -15) + cylinder(46, 3).at(0, 0, 12)
    nodes = []
    for n in range(COUNT):
        angle = 2 * pi * n / COUNT
        hub = cut(hub, *(turned(one, rpy=(0, 0, angle)) for one in tilted))
        at = (38 * np.cos(angle), 38 * np.sin(angle), 0, (0, 0, angle))
        nodes += [part(f"roller {n}", roller, *at), part(f"pin {n}", pin, *at)]
    found = inferred(BASE, group("wheel", part("hub", hub), *nodes), sources=sources)
    held = [arc.evidence for arc in found.arcs if arc.evidence.of_roller]
    assert len(held) == COUNT
    assert {h.review for h in held} == {"held about its own axis alone: it may be fastened there"}
    pins = {f"wheel/pin {n}" for n in range(COUNT)}
    assert any({"wheel/hub", *pins} <= link for link in links(found))


@pytest.mark.parametrize("nodes", [wheel(0.0), wheel(0.0, radial=True), wheel(pi / 4, count=4)])
def test_bearing_rollers_spokes_and_uneven_patterns_are_no_rollers(nodes: list[Node]) -> None:
    """Round bodies parallel to the hub, along its radius, or only on one side of it, are not taken for rollers."""
    found = inferred(BASE, *nodes, sources=BARE)
    assert not [arc for arc in found.arcs if arc.evidence.of_roller]
    assert {arc.evidence.type for arc in found.arcs if not arc.evidence.review} <= {JointKind.FIXED}


def cart(sides: tuple[int, ...], length: float = 300) -> list[Node]:
    """A plate with two wheels on each of some sides of an extrusion along x, their rims in its grooves."""
    profile = box(length, 20, 20)
    for side in (-1, 1):
        profile = profile - turned(box(length, 5, 5), y=10 * side, rpy=(pi / 4, 0, 0))
    wheel = cone(9, 12, 3).at(0, 0, -5) + cylinder(12, 4).at(0, 0, -2) + cone(12, 9, 3).at(0, 0, 2)
    wheel, plate, spots = wheel - cylinder(2.5, 40).at(0, 0, -20), box(90, 70, 5), []
    for side in sides:
        spots += [(x, side * 20.5) for x in (-25, 25)]
    for x, y in spots:
        plate = plate - cylinder(2.5, 40).at(x, y, -20)
    tube = cylinder(4, 12.5).at(0, 0, 5) - cylinder(2.5, 12.5).at(0, 0, 5)
    bolt = cylinder(2.5, 34).at(0, 0, -8) + cylinder(4.5, 3).at(0, 0, -11)
    nodes = [part("rail", profile), part("plate", plate, z=20)]
    for n, (x, y) in enumerate(spots):
        pieces = {"wheel": wheel, "spacer": tube, "M5x30 screw": bolt}
        nodes += [part(f"{name} {n}", solid, x, y) for name, solid in pieces.items()]
    return nodes


def test_a_carriage_with_wheels_on_both_sides_of_a_rail_slides_along_it() -> None:
    """The wheels touch nothing of the rail as drawn; the slide is marked."""
    slides = [arc for arc in inferred(*cart((-1, 1))).arcs if arc.evidence.type == JointKind.PRISMATIC]
    assert [arc.evidence.why for arc in slides] == ["4 wheels on both sides of a rail"]
    assert slides[0].evidence.review
    assert np.allclose(np.abs(slides[0].evidence.axis.d), (1, 0, 0))


@pytest.mark.parametrize("nodes", [cart((-1,)), cart((-1, 1), length=40)])
def test_wheels_on_one_side_or_beyond_a_body_do_not_hold_on_it(nodes: list[Node]) -> None:
    """Nothing slides where wheels on one side could fall off, or where the body is shorter than their row."""
    assert not [arc for arc in inferred(*nodes).arcs if arc.evidence.type == JointKind.PRISMATIC]


def test_the_wheel_of_a_caster_rolls_beside_larger_wheels() -> None:
    """Without names: two equal wheels and a smaller one stand on the ground; the fork of the smaller one swivels."""

    def across(radius: float, width: float) -> Solid:
        return turned(cylinder(radius, width).at(0, 0, -width / 2), rpy=(pi / 2, 0, 0))

    deck = box(260, 180, 6).at(0, 0, 3) - cylinder(5, 60).at(100, 0, -30)
    nodes = [part("1", deck)]
    for n, side in enumerate((-1, 1)):
        bracket = box(50, 8, 80).at(0, 0, -40) - across(6.1, 30).at(0, 0, -68)
        nodes += [part(f"{n}2", bracket, -80, side * 70), part(f"{n}3", across(6, 40), -80, side * 80, -68)]
        nodes.append(part(f"{n}4", across(40, 20) - across(6, 20), -80, side * 90, -68))
    fork = box(50, 44, 4).at(-8, 0, -2) - cylinder(5, 60).at(0, 0, -30)
    for side in (-1, 1):
        fork = fork + box(24, 3, 84).at(-25, side * 20.5, -46)
    nodes.append(part("5", fork - across(4.1, 80).at(-25, 0, -74), 100))
    pin = cylinder(5, 10).at(0, 0, -4) + cylinder(8, 2).at(0, 0, -6)
    nodes += [part("6", pin, 100), part("7", across(34, 30) - across(4.1, 30), 75, 0, -74)]
    nodes.append(part("8", across(4, 46), 75, 0, -74))
    found = inferred(*nodes, sources=BARE)
    assert {("revolute", "1", "5"), ("revolute", "5", "7")} <= set(joints(found))
